"""Phong, Light Warping and Radiance Scaling in GLSL: lights on a material, warped, scaled."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from meshdepict.curvature.frames import tangents
from meshdepict.drawing.shader import Uniforms
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import Phong
from meshdepict.scene.view import View
from meshdepict.shading import light_warping, phong, radiance_scaling
from meshdepict.shading.features import DEFAULT_GAIN, features
from meshdepict.shading.method import declaration
from meshdepict.shading.radiance_scaling import LEAST_INVARIANT
from meshdepict.viewer.live.live_method import (
    UNHIDDEN,
    Attributes,
    LiveMethod,
    Options,
    packed,
)
from meshdepict.viewer.live.materials import (
    GLSL,
    live_material,
    material_defines,
    material_uniforms,
)

__all__ = ["LIGHT_WARPING", "PHONG", "RADIANCE_SCALING"]

# With curvature the normals are n[0], u = n[1] and z = n[2], and `curvature` is (κ_u, κ_v).
_WARPING = """
float warp_scale(float kappa) {
  float t = tan(atan(clamp(warping * kappa, -1e18, 1e18)) / 6.0);
  return (1.0 + t) / (1.0 - t);
}

// W⁻¹(l) and its Jacobian; l in the frame (u, v, z).
vec4 unwarped(vec3 l, vec2 stretch) {
  float beyond = dot(l.xy, l.xy) / (1.0 - min(l.z, 0.0));
  float q = l.z < 0.0 ? beyond : 1.0 + l.z;
  vec2 p = l.xy / stretch;
  float t = 2.0 * q / max(q * q + dot(p, p), 1e-30);
  float jacobian = t > 0.0 ? t * t / (stretch.x * stretch.y) : 0.5 * dot(stretch, stretch);
  return vec4(t * p, t * q - 1.0, jacobian);
}
"""

_SCALING = """
float bounded_tanh(float x) {
  return tanh(clamp(x, -20.0, 20.0));
}

float scaling(float kappa, float delta, float gamma) {
  float e = exp(-clamp(gamma * kappa, -60.0, 60.0));
  float low = alpha * (1.0 - delta), high = (1.0 - alpha) * delta;
  return (low * e + high) / (low + high * e);
}
"""

_SHADE = """
vec3 shade() {
  vec3 normal = n[0];
  vec3 total = vec3(ambient);
#ifdef GLOSSY
  vec3 e = visible(normal, towards_eye());
#endif
#ifdef CURVED
  vec3 v = normalize(cross(n[2], n[1]));
  mat3 frame = mat3(cross(v, n[2]), v, n[2]);
  vec2 bend = clamp(gain * curvature, -1e30, 1e30);
#endif
#ifdef WARPED
  vec2 stretch = vec2(warp_scale(bend.x), warp_scale(bend.y));
#endif
#ifdef SCALED
  float mean = bend.x + bend.y, slant = anisotropy * (bend.x - bend.y);
  total *= scaling(-bounded_tanh(mean), 1.0, magnitudes.x);
#endif
  for (int k = 0; k < light_count; k++) {
    vec3 l = light_direction(k);
    float weight = 1.0;
#ifdef WARPED
    vec4 back = unwarped(l * frame, stretch);
    float before = dot(normal, l);
    l = frame * back.xyz;
    weight = min(before, dot(normal, l)) > 0.0 ? back.w : 0.0;
#endif
    float cosine = clamp(dot(normal, l), 0.0, 1.0);
    float value = diffuse * cosine;
#ifdef SCALED
    vec3 local = l * frame;
    float kappa = -bounded_tanh(mean + slant * (local.x * local.x - local.y * local.y));
    value *= scaling(kappa, cosine, magnitudes.y);
#endif
#ifdef GLOSSY
    float delta = highlight(normal, e, l);
#ifdef SCALED
    value += specular * delta * scaling(kappa, delta, magnitudes.z);
#else
    value += specular * delta;
#endif
#endif
    total += value * weight * light_color(k);
  }
#ifdef WARPED
  total *= pow(stretch.x * stretch.y, contrast);
#endif
  return total;
}
"""


def _frames(
    function: Callable[..., Any], space: ScaleSpace, view: View, options: Options
) -> tuple[int, Attributes]:
    """Return normals, frames and curvature at the default gain; any frame where nothing bends."""
    own = space.normals_at(0)
    if not declaration(function).reads(space.last, options).curvature:
        bend = np.zeros((len(own), 2), np.float32)
        return 3, packed((own, tangents(own.astype(np.float64)), own)) | {"curvature": bend}
    found = features(
        space, view, curvature=options["curvature"], scale=options["scale"], gain=None,
        foreshortening=options["foreshortening"],
    )  # fmt: skip
    bend = np.stack((found.ku, found.kv), axis=1)
    return 3, packed((own, found.u, found.z)) | {"curvature": bend}


def _frames_key(view: View, options: Options) -> tuple[Any, ...]:
    kind = options["curvature"]
    seen = (view, options["foreshortening"]) if kind == "view" else None
    return kind, options["scale"], seen


def _curved(options: Options) -> Uniforms:
    kind, gain = options["curvature"], options["gain"]
    return {
        **material_uniforms(live_material(options)),
        "gain": 1.0 if gain is None else gain / DEFAULT_GAIN[kind],
    }


def _warping_uniforms(space: ScaleSpace, options: Options) -> Uniforms:
    return _curved(options) | {"warping": options["magnitude"], "contrast": options["contrast"]}


def _scaling_uniforms(space: ScaleSpace, options: Options) -> Uniforms:
    magnitudes = (options[f"{term}_magnitude"] for term in ("ambient", "diffuse", "specular"))
    return _curved(options) | {
        "warping": options["warping"],
        "contrast": 0.0,
        "anisotropy": options["anisotropy"],
        "alpha": float(np.clip(options["invariant"], LEAST_INVARIANT, 1 - LEAST_INVARIANT)),
        "magnitudes": tuple(options["magnitude"] if m is None else m for m in magnitudes),
    }


def _scaling_defines(options: Options) -> dict[str, int]:
    warped = {"WARPED": 1} if options["warping"] else {}
    return {"CURVED": 1, "SCALED": 1} | warped | material_defines(live_material(options))


def _phong_material(options: Options) -> Phong:
    return Phong(*(options[name] for name in ("ambient", "diffuse", "specular", "shininess")))


PHONG = LiveMethod(
    phong,
    GLSL + _SHADE,
    uniforms=lambda space, options: material_uniforms(_phong_material(options)),
    defines=lambda options: material_defines(_phong_material(options)),
    only=UNHIDDEN,
    several=True,
)

LIGHT_WARPING = LiveMethod(
    light_warping,
    GLSL + _WARPING + _SHADE,
    attributes=functools.partial(_frames, light_warping),
    key=_frames_key,
    uniforms=_warping_uniforms,
    defines=lambda options: {"CURVED": 1, "WARPED": 1} | material_defines(live_material(options)),
    only={
        "quadrature": ("lights",),
        "illumination": ("lights",),
        "importance": (None,),
        **UNHIDDEN,
    },
    several=True,
)

RADIANCE_SCALING = LiveMethod(
    radiance_scaling,
    GLSL + _WARPING + _SCALING + _SHADE,
    attributes=functools.partial(_frames, radiance_scaling),
    key=_frames_key,
    uniforms=_scaling_uniforms,
    defines=_scaling_defines,
    only={"illumination": ("lights",), **UNHIDDEN},
    several=True,
)
