"""Phong shading: ambient, diffuse and a highlight."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import Phong
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.features import LightCount, eyes, sight
from meshdepict.shading.hidden_light import hidden_direct
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

__all__ = ["phong"]


def _reads(last: int, *, shadows: bool, bounces: int, rays: int | str, **_: Any) -> Reads:
    count = ray_count(shadows=shadows, bounces=bounces, rays=rays)
    return Reads(normals=frozenset((0,)), rays=count)


@method(
    linear=True,
    lights="several",
    reads=_reads,
    source="Phong, Illumination for Computer Generated Pictures, 1975",
)
def phong(
    space: ScaleSpace,
    light: LightsLike,
    *,
    view: View | str = "front",
    ambient: Annotated[float, Range(0, 1, help="light that comes from everywhere")] = 0.1,
    diffuse: Annotated[float, Range(0, 1, help="weight of n·l")] = 0.7,
    specular: Annotated[float, Range(0, 1, help="weight of the highlights")] = 0.3,
    shininess: Annotated[
        float, Range(0, 1e6, help="exponent of the highlights", soft=(1, 100))
    ] = 20.0,
    lights: LightCount = 54,
    shadows: Shadows = False,
    bounces: Bounces = 0,
    rays: LightRays = USUAL_RAYS,
    denoise: Denoise = 0.0,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by ambient + diffuse · n·l + specular · (r·l)^shininess, r the reflected view.

    Points that face away from the eye are shaded for the eye mirrored in their tangent plane.
    Shadows hide both terms of a light, and of an environment. What bounces is the matt part, which
    has highlights where the eye sees it; the ambient term does not.
    """
    eye = sight(view, space, fitted=False)
    material = Phong(ambient, diffuse, specular, shininess)
    lamps, environments = parted(light, eye)

    def shown(arriving: NDArray[Any]) -> NDArray[Any]:
        return linear_to_srgb(exposed(ambient + diffuse * arriving, exposure))

    reach = reached(
        space, lamps, environments, shadows=shadows, bounces=bounces, rays=rays, denoise=denoise,
        albedo=diffuse,
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
    return exposed(shaded + np.float32(ambient), exposure)
