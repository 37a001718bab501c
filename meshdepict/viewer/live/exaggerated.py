"""Exaggerated Shading in GLSL (Rusinkiewicz, Burns and DeCarlo, SIGGRAPH 2006), eqs. 3–5."""

from __future__ import annotations

import numpy as np

from meshdepict.drawing.shader import Uniforms
from meshdepict.errors import MeshdepictError
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shading import exaggerated
from meshdepict.shading.attention import NEAR
from meshdepict.shading.bands import SINGULAR_LIGHT, band_weights
from meshdepict.shading.exaggerated import per_band, settle
from meshdepict.shading.method import require_smoothing
from meshdepict.viewer.live.live_method import Attributes, LiveMethod, Options, packed

__all__ = ["EXAGGERATED"]

_GLSL = f"""
#ifdef RELIEF
vec3 shade() {{
  vec3 l = light_direction(0);
  l -= vertical * dot(vertical, l);
  float level = length(l);
  l = level > {SINGULAR_LIGHT**2:g} ? l / level : vec3(0.0);
  float c = 0.0;
  for (int i = 0; i < SETS; i++) c += weights[i] * clamp(exaggeration[i] * dot(n[i], l), -1.0, 1.0);
  return vec3(0.5 + 0.5 * c);
}}
#else
vec3 shade() {{
  vec3 l = light_direction(0);
#ifdef ATTENTION
  vec3 away = (vertexMC.xyz - attention.xyz) / attention.w;
  float remoteness = 0.5 * dot(away, away);
#endif
  float c = weights[SETS - 1] * dot(n[SETS - 1], l);
  for (int i = 0; i < SETS - 1; i++) {{
    vec3 turned = l - n[i + 1] * dot(n[i + 1], l);                        // eq. 4
    turned *= inversesqrt(dot(turned, turned) + {SINGULAR_LIGHT**2:g});
    float detail = clamp(exaggeration[i] * dot(n[i], turned), -1.0, 1.0); // eq. 3
#ifdef ATTENTION
    detail *= exp(-remoteness / exp2(float(i)));                          // fig. 9
#endif
    c += weights[i] * detail;
  }}
  return vec3(0.5 + 0.5 * c);                                             // eq. 5
}}
#endif
"""


def _attributes(space: ScaleSpace, view: View, options: Options) -> tuple[int, Attributes]:
    require_smoothing(space, "exaggerated shading", scales=9)
    if options["contrast"] == 0:  # no set has any weight, and the shader wants two
        return 2, packed([space.normals_at(0)] * 2)
    return len(space.widths), packed(space.normals)


def _uniforms(space: ScaleSpace, options: Options) -> Uniforms:
    tones = settle(space, options)
    weights = band_weights(
        space.widths, space.ratio,
        emphasis=options["emphasis"], contrast=tones["contrast"], base=tones["base"],
    )  # fmt: skip
    relief = bool(options["one_light"])
    steep = per_band(space, tones["exaggeration"], len(weights) if relief else None)
    pairs = len(space.widths) if options["contrast"] != 0 else 2
    bands = pairs if relief else pairs - 1
    found: Uniforms = {"weights": list(weights[:pairs]), "exaggeration": list(steep[:bands])}
    if relief:
        found["vertical"] = tuple(map(float, space.vertical))
    if options["focus"] is not None and not relief:
        unit = space.shape.diagonal or 1.0
        reach = NEAR if options["radius"] is None else options["radius"] / unit
        # Held within what float32 can divide; an infinite distance is as good as a large one.
        focus = np.clip(space.shape.recentred(np.array(options["focus"])), -1e15, 1e15)
        found["attention"] = (*map(float, focus), float(np.clip(reach, 1e-15, 1e15)))
    return found


def _defines(options: Options) -> dict[str, int]:
    if options["one_light"]:
        if options["focus"] is not None:
            raise MeshdepictError(
                "exaggerated: one_light has no focus: leave it out, or set one_light=False"
            )
        return {"RELIEF": 1}
    return {} if options["focus"] is None else {"ATTENTION": 1}


EXAGGERATED = LiveMethod(
    exaggerated,
    _GLSL,
    attributes=_attributes,
    uniforms=_uniforms,
    defines=_defines,
    only={"principal_strength": (0.0,)},
)
