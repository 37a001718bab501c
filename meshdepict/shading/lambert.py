"""Lambertian shading: the cosine between normal and light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.light import Light
from meshdepict.scene.names import LightLike, as_light
from meshdepict.scene.vectors import cosines
from meshdepict.shading.first_light import added
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

__all__ = ["half_lambert", "lambert"]

Single = NDArray[np.float32]


def _reads(last: int, *, shadows: bool, bounces: int, rays: int | str, **_: Any) -> Reads:
    count = ray_count(shadows=shadows, bounces=bounces, rays=rays)
    return Reads(normals=frozenset((0,)), rays=count)


@method(linear=True, compared={}, reads=_reads, source="Lambert, Photometria, 1760")
def lambert(
    space: ScaleSpace,
    light: LightLike,
    *,
    shadows: Shadows = False,
    bounces: Bounces = 0,
    rays: LightRays = USUAL_RAYS,
    denoise: Denoise = 0.0,
    exposure: Exposure = 1.0,
) -> Single:
    """Shade by max(0, n·l): what every viewer shows, black on the side away from the light.

    With bounces the surface is white, and sends on all the light that it gets; where it has colours
    of its own that are kept, what of it has them.
    """

    def shown(arriving: NDArray[Any]) -> NDArray[Any]:
        return linear_to_srgb(exposed(arriving, exposure))

    cosine = _cosine(space, light)
    seen, around, _ = reached(
        space, [_white(light)], shadows=shadows, bounces=bounces, rays=rays, denoise=denoise,
        albedo=1.0,
        shown=shown,
    )  # fmt: skip
    return exposed(_arriving(cosine, seen[0], around), exposure)


@method(reads=_reads, source="Exaggerated Shading (Rusinkiewicz et al. 2006), eq. 1")
def half_lambert(
    space: ScaleSpace,
    light: LightLike,
    *,
    shadows: Shadows = False,
    bounces: Bounces = 0,
    rays: LightRays = USUAL_RAYS,
    denoise: Denoise = 0.0,
    exposure: Exposure = 1.0,
) -> Single:
    """Shade by ½ + ½ n·l, the unclamped cosine: no part is lost in black.

    Nor in a shadow, which takes the light's n·l and leaves the half; bounces add to n·l.
    """

    def shown(arriving: NDArray[Any]) -> NDArray[Any]:
        return exposed((1 + arriving) / 2, exposure)

    cosine = _cosine(space, light)
    seen, around, _ = reached(
        space, [_white(light)], shadows=shadows, bounces=bounces, rays=rays, denoise=denoise,
        albedo=1.0,
        shown=shown,
    )  # fmt: skip
    if seen[0] is not None or around is not None:
        cosine = added(np.minimum(cosine, 0), _arriving(cosine, seen[0], around))
    return exposed((1 + cosine) / 2, exposure)


def _cosine(space: ScaleSpace, light: LightLike) -> Single:
    return cosines(space.normals_at(0), as_light(light).direction)


def _white(light: LightLike) -> Light:
    """Return the light without a colour: here it has none."""
    given = as_light(light)
    return Light(given.direction, spread=given.spread)


def _arriving(cosine: Single, seen: Single | None, around: Single | None) -> Single:
    """Return ⟨n·l⟩ V, and what comes by other ways."""
    falls = np.maximum(cosine, 0)
    falls = falls if seen is None else falls * seen
    return falls if around is None else added(falls, around)
