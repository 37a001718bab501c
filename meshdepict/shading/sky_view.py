"""Sky view: soft light and soft shadows from a part of the sky."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.shading.ambient_occlusion import Rays
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.transport.occlusion import sky_openness

__all__ = ["sky_view"]


def _reads(last: int, *, rays: int, **_: Any) -> Reads:
    return Reads(normals=frozenset((0,)), rays=rays)


@method(
    local=False,
    needs=("rays", "surface"),
    reads=_reads,
    source="Sky-view factor (Zakšek, Oštir and Kokalj 2011); directional occlusion",
)
def sky_view(
    space: ScaleSpace,
    light: LightLike,
    *,
    spread: Annotated[
        float, Range(1, 90, unit="°", help="half the opening of the cap of sky round the light")
    ] = 90.0,
    rays: Rays = 256,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade under an evenly bright cap of sky round the light: soft shadows, no black but in caves.

    A spread of 90° is half the sky, the sky-view factor of relief maps where the light stands
    overhead; a small one is directional occlusion, a sun with soft shadows.

    Parameters
    ----------
    light : str, (3,) array_like, (azimuth, elevation) or Light
        The middle of the sky.

    Returns
    -------
    (n,) array of float32
        Display values in [0, 1]; 1 for an open surface that faces the light.
    """
    towards = as_light(light).direction
    at = space.points, space.normals_at(0)
    found = sky_openness(space.surface, towards, at=at, spread=spread, rays=rays)
    return exposed(found.values, exposure)
