"""Phong shading: ambient, diffuse and a highlight."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import Phong
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.direct import direct
from meshdepict.shading.features import LightCount, eyes, sight
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["phong"]


@method(
    linear=True,
    lights="several",
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
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by ambient + diffuse · n·l + specular · (r·l)^shininess, r the reflected view.

    Points that face away from the eye are shaded for the eye mirrored in their tangent plane.
    """
    eye = sight(view, space, fitted=False)
    material = Phong(ambient, diffuse, specular, shininess)
    lamps, environments = parted(light, eye)
    shaded = direct(
        space, lamps, eyes(space, eye), material, environments=environments, count=lights
    )
    return exposed(shaded + np.float32(ambient), exposure)
