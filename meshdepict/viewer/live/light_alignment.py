"""Local Light Alignment in GLSL (Mestres, Vergne, Noûs and Thollot, Eurographics 2021)."""

from __future__ import annotations

import math

import numpy as np

from meshdepict.drawing.shader import Uniforms
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shading import light_alignment
from meshdepict.shading.light_alignment import per_scale, strengths_between
from meshdepict.shading.method import declaration, require_smoothing
from meshdepict.viewer.live.live_method import UNHIDDEN, Attributes, LiveMethod, Options, packed
from meshdepict.viewer.live.materials import (
    GLSL,
    live_material,
    material_defines,
    material_uniforms,
)

__all__ = ["LIGHT_ALIGNMENT"]

# A narrow transition magnifies errors of normals e^γ times: with 16 bits and γ = 6 highlights were
# off by 10 grey levels at one pixel in a thousand.
_BITS = 24

# The card computes in single precision: at γ = 6 and strength 1 one vertex in 2,000 is off by more
# than a grey level, at 8 one in 300, and by as much as there is.

# The arguments of atan are kept off (0, 0), where it is undefined.
_GLSL = (
    GLSL
    + """
vec3 aligned(vec3 l, vec3 normal, vec3 z, float strength) {
  float c = dot(normal, z);
  vec3 across = cross(z, normal);                       // n_x y
  float along_x = dot(l, normal) - dot(l, z) * c;       // n_x l·x
  float along_y = dot(l, across);                       // n_x l·y
  bool bright = along_x >= 0.0;
  vec3 guide = bright ? normal : z - c * normal;        // n, or n_x (−n_z x + n_x z)
  guide *= inversesqrt(max(dot(guide, guide), 1e-30));
  vec3 level = cross(l, z);
  float first = atan(abs(along_x), max(abs(along_y), 1e-20)) / 1.57079633;
  first *= sqrt(dot(level, level) / (dot(level, level) + 1e-6));
  first = bright || c > 0.0 ? first : 0.0;
  float confidence = clamp(first * length(across), 0.0, 1.0);
  float weight = confidence / max(fade * (1.0 - confidence) + confidence, 1e-30);
  float cosine = dot(guide, l);
  vec3 t = guide - cosine * l;
  float sine = length(t);
  float theta = strength * weight * atan(max(sine, 1e-20), cosine);
  return cos(theta) * l + sin(theta) / max(sine, 1e-20) * t;
}

vec3 shade() {
  vec3 normal = n[0];
  vec3 total = vec3(ambient);
#ifdef GLOSSY
  vec3 e = visible(normal, towards_eye());
#endif
  for (int k = 0; k < light_count; k++) {
    vec3 l = light_direction(k);
    for (int i = SETS - 2; i >= 0; i--)
      l = aligned(l, n[i], n[i + 1], strengths[i]);
    float shaded = diffuse * max(dot(normal, l), 0.0);
#ifdef GLOSSY
    l = light_direction(k);
    vec3 z = 2.0 * dot(n[SETS - 1], e) * n[SETS - 1] - e;
    for (int i = SETS - 2; i >= 0; i--) {
      vec3 r = 2.0 * dot(n[i], e) * n[i] - e;
      l = aligned(l, r, z, specular_strengths[i]);
      z = r;
    }
    if (dot(normal, l) > 0.0) shaded += specular * highlight(normal, e, l);
#endif
    total += shaded * light_color(k);
  }
  return total;
}
"""
)


def _attributes(space: ScaleSpace, view: View, options: Options) -> tuple[int, Attributes]:
    require_smoothing(space, "Local Light Alignment", scales=5)
    planes = space.planes_of(_scales(space, options))
    return len(planes), packed(np.moveaxis(planes, 1, 2), bits=_BITS)


def _scales(space: ScaleSpace, options: Options) -> list[int]:
    """Return the scales that are read, two at least: the shader wants a pair."""
    read = sorted(declaration(light_alignment).reads(space.last, options).normals)
    return read if len(read) > 1 else read * 2


def _uniforms(space: ScaleSpace, options: Options) -> Uniforms:
    scales = _scales(space, options)

    def strengths(name: str) -> list[float]:
        return list(strengths_between(scales, per_scale(space.last, options[name], name)))

    return {
        **material_uniforms(live_material(options)),
        "strengths": strengths("strength"),
        "specular_strengths": strengths("specular_strength"),
        "fade": math.exp(-options["sharpness"]),
    }


LIGHT_ALIGNMENT = LiveMethod(
    light_alignment,
    _GLSL,
    attributes=_attributes,
    bits=_BITS,
    uniforms=_uniforms,
    defines=lambda options: material_defines(live_material(options)),
    only={"transmitted": (0.0,), "background": (0.0,), **UNHIDDEN},
    most={"sharpness": 6.0},
    several=True,
)
