"""Hillshade: the shaded relief of every map, from Horn's slopes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["hillshade"]


@method(source="Horn 1981, Hill shading and the reflectance map")
def hillshade(
    space: ScaleSpace, light: LightLike, *, exposure: Exposure = 1.0
) -> NDArray[np.float32]:
    """Shade relief by cos z cos s + sin z sin s cos(azimuth − aspect), z the light's zenith angle.

    That is the cosine between light and ground, as `lambert`'s, but a display value, and of
    terrain from slopes over three cells by three (Horn 1981): GDAL's, within a grey level.
    """
    return exposed(np.maximum(space.relief(as_light(light).direction), 0), exposure)
