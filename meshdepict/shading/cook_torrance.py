"""Cook–Torrance shading: microfacets over a diffuse base."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import CookTorrance
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.features import LightCount, eyes, sight
from meshdepict.shading.hidden_light import albedo, hidden_direct
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.reached import (
    USUAL_RAYS,
    Bounces,
    Denoise,
    LightRays,
    Shadows,
    ray_count,
    reached,
)
from meshdepict.shading.sampled import used_rays

__all__ = ["cook_torrance"]


def _reads(last: int, *, shadows: bool, bounces: int, rays: int | str, **_: Any) -> Reads:
    count = ray_count(shadows=shadows, bounces=bounces, rays=rays)
    return Reads(normals=frozenset((0,)), rays=count)


@method(
    linear=True,
    lights="several",
    reads=_reads,
    source="Cook and Torrance, ACM Transactions on Graphics 1(1), 1982",
)
def cook_torrance(
    space: ScaleSpace,
    light: LightsLike,
    *,
    view: View | str = "front",
    diffuse: Annotated[float, Range(0, 1, help="albedo of the base")] = 0.6,
    reflectance: Annotated[float, Range(0, 1, help="of the facets, seen head-on")] = 0.2,
    roughness: Annotated[float, Range(0.02, 1, help="slope m of the facets")] = 0.3,
    lights: LightCount = 54,
    shadows: Shadows = False,
    bounces: Bounces = 0,
    rays: LightRays = USUAL_RAYS,
    denoise: Denoise = 0.0,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by Beckmann's microfacets over a diffuse base: highlights of rough metal or glaze.

    Points that face away from the eye are shaded for the eye mirrored in their tangent plane.
    Shadows hide both terms of a light, and of an environment. What bounces is the base's light; it
    has highlights where the eye sees it.

    Parameters
    ----------
    diffuse, reflectance, roughness : float
        As in `meshdepict.scene.material.CookTorrance`.
    """
    eye = sight(view, space, fitted=False)
    material = CookTorrance(diffuse, reflectance, roughness)
    lamps, environments = parted(light, eye)
    base = albedo(material)

    def shown(arriving: NDArray[Any]) -> NDArray[Any]:
        return linear_to_srgb(exposed(base * arriving, exposure))

    reach = reached(
        space, lamps, environments, shadows=shadows, bounces=bounces, rays=rays, denoise=denoise,
        albedo=base,
        shown=shown,
    )  # fmt: skip
    shaded = hidden_direct(
        space,
        lamps,
        eyes(space, eye),
        material,
        reach,
        environments=environments,
        count=lights,
        rays=used_rays(space, rays),
    )
    return exposed(shaded, exposure)
