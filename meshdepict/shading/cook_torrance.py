"""Cook–Torrance shading: microfacets over a diffuse base."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import CookTorrance
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.direct import direct
from meshdepict.shading.features import LightCount, eyes, sight
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["cook_torrance"]


@method(
    linear=True,
    lights="several",
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
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by Beckmann's microfacets over a diffuse base: highlights of rough metal or glaze.

    Points that face away from the eye are shaded for the eye mirrored in their tangent plane.

    Parameters
    ----------
    diffuse, reflectance, roughness : float
        As in `meshdepict.scene.material.CookTorrance`.
    """
    eye = sight(view, space, fitted=False)
    material = CookTorrance(diffuse, reflectance, roughness)
    lamps, environments = parted(light, eye)
    shaded = direct(
        space, lamps, eyes(space, eye), material, environments=environments, count=lights
    )
    return exposed(shaded, exposure)
