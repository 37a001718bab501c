"""Lambert and half-Lambert in GLSL."""

from __future__ import annotations

from meshdepict.shading import lambert
from meshdepict.shading.lambert import half_lambert
from meshdepict.viewer.live.live_method import UNHIDDEN, LiveMethod

__all__ = ["HALF_LAMBERT", "LAMBERT"]

LAMBERT = LiveMethod(
    lambert,
    """
vec3 shade() {
  return vec3(max(dot(n[0], light_direction(0)), 0.0));
}
""",
    only=UNHIDDEN,
)

HALF_LAMBERT = LiveMethod(
    half_lambert,
    """
vec3 shade() {
  return vec3(0.5 + 0.5 * dot(n[0], light_direction(0)));
}
""",
    only=UNHIDDEN,
)
