"""Lambertian shading: the cosine between normal and light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.scene.vectors import cosines
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["half_lambert", "lambert"]


@method(linear=True, compared={}, source="Lambert, Photometria, 1760")
def lambert(
    space: ScaleSpace, light: LightLike, *, exposure: Exposure = 1.0
) -> NDArray[np.float32]:
    """Shade by max(0, n·l): what every viewer shows, black on the side away from the light."""
    return exposed(np.maximum(_cosine(space, light), 0), exposure)


@method(source="Exaggerated Shading (Rusinkiewicz et al. 2006), eq. 1")
def half_lambert(
    space: ScaleSpace, light: LightLike, *, exposure: Exposure = 1.0
) -> NDArray[np.float32]:
    """Shade by ½ + ½ n·l, the unclamped cosine: no part is lost in black."""
    return exposed((1 + _cosine(space, light)) / 2, exposure)


def _cosine(space: ScaleSpace, light: LightLike) -> NDArray[np.float32]:
    return cosines(space.normals_at(0), as_light(light).direction)
