"""Multidirectional hillshade (Mark 1992): relief under four lights that graze it."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.heights.map_rules import MARK_ELEVATION
from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["multidirectional_hillshade"]


@method(
    lights="none",
    source="Mark 1992, A multidirectional, oblique-weighted, shaded-relief image",
)
def multidirectional_hillshade(
    space: ScaleSpace,
    light: Any,
    *,
    view: View | str = "front",
    elevation: Annotated[
        float, Range(0, 90, unit="°", help="how high the four lights stand", soft=(10, 80))
    ] = MARK_ELEVATION,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade relief under lights from 225°, 270°, 315° and 360°, most by what grazes a slope.

    Each weighs ½ sin²(aspect − azimuth), so that no direction of ridges is lost. Azimuths are those
    of the map, and the view's for other shapes. (GDAL's option of this name weighs by cos².)
    """
    del light
    frame = as_view(view, space.shape).frame
    return exposed(space.grazing_relief(frame, elevation), exposure)
