"""Every method by its name: one line each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.shading.accessibility import accessibility
from meshdepict.shading.ambient_occlusion import ambient_occlusion
from meshdepict.shading.aspect import aspect
from meshdepict.shading.cook_torrance import cook_torrance
from meshdepict.shading.exaggerated import exaggerated
from meshdepict.shading.gooch import gooch
from meshdepict.shading.lambert import half_lambert, lambert
from meshdepict.shading.light_alignment import light_alignment
from meshdepict.shading.light_warping import light_warping
from meshdepict.shading.lit_sphere import lit_sphere
from meshdepict.shading.mean_curvature import mean_curvature
from meshdepict.shading.normal_enhancement import normal_enhancement
from meshdepict.shading.phong import phong
from meshdepict.shading.radiance_scaling import radiance_scaling
from meshdepict.shading.sky_view import sky_view
from meshdepict.shading.toon import toon
from meshdepict.shading.unsharp_masking import unsharp_masking
from meshdepict.shading.view_curvature import view_curvature

__all__ = ["METHODS", "find_method"]

METHODS: dict[str, Callable[..., Any]] = {
    function.__name__: function
    for function in (
        exaggerated,
        light_warping,
        radiance_scaling,
        light_alignment,
        lambert,
        half_lambert,
        phong,
        cook_torrance,
        toon,
        lit_sphere,
        mean_curvature,
        gooch,
        aspect,
        normal_enhancement,
        unsharp_masking,
        accessibility,
        ambient_occlusion,
        sky_view,
        view_curvature,
    )
}
"""Every method by name."""


def find_method(name: str) -> Callable[..., Any]:
    """Return the shading function of a name; raise `MeshdepictError` naming the nearest."""
    if not isinstance(name, str) or name not in METHODS:
        raise MeshdepictError(
            f"no method is called {name!r}{nearest(name, METHODS)} (there are {', '.join(METHODS)})"
        )
    return METHODS[name]
