"""Slope: how steep the ground is, white where it is level; no light makes it."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["slope", "slope_angles"]


@method(
    lights="none",
    source="Slope gradient: Kokalj and Somrak, Remote Sensing 11, 2019, Why not a single image?",
)
def slope(
    space: ScaleSpace,
    light: object,
    *,
    view: View | str = "front",
    steepest: Annotated[
        float, Range(0.1, 90, unit="°", help="slope from which on it is black", soft=(5, 90))
    ] = 50.0,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by steepness alone: 1 where level, 0 from the steepest slope on.

    The slope is that of the ground where the shape has some: height fields, and meshes of sheets.
    Of others it is measured against the picture plane, so that white faces the eye.

    Returns
    -------
    (n,) array of float32
        Display values in [0, 1], 1 − slope / steepest before exposure.
    """
    try:
        up = space.vertical
    except MeshdepictError:  # there is no ground
        up = as_view(view, space.shape).frame[2]
    angles = slope_angles(space.normals_at(0), up)
    return exposed(np.maximum(1 - angles / np.float32(steepest), np.float32(0)), exposure)


def slope_angles(normals: NDArray[np.float32], up: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the angles in degrees between normals (n, 3) and a unit vector: 90 and more on walls.

    By both sides of the right triangle: the cosine alone tells no gentle slope from level ground.
    """
    axis = up.astype(np.float32)
    rise = normals @ axis
    level = np.linalg.norm(normals - rise[:, None] * axis, axis=1)
    return np.degrees(np.arctan2(level, rise))
