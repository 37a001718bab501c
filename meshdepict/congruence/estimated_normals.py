"""Normals that a depth image has, where no others are known."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.congruence.contours import mean_slopes

__all__ = ["estimated_normals"]

Floats = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]

_USUAL_SLOPE = 0.8  # root mean square, of whole objects: see `Judge`


def estimated_normals(depth: Floats, across: Mask, down: Mask, counted: Mask) -> Floats:
    """Return unit normals (h, w, 3) of a depth image in a unit that gives it the usual slope.

    Parameters
    ----------
    depth : (h, w) array
        In any unit: it is taken such that the root mean square slope of the pixels that count is
        0.8. All normals look at the eye where the depth is flat there.
    across, down : arrays of bool
        Which neighbours are `connected`; the slope of a pixel is the mean of those to them.
    counted : (h, w) array of bool
    """
    x, y = mean_slopes(depth, across, down)
    squared = np.square(x) + np.square(y)
    mean = float(squared[counted].mean()) if counted.any() else 0.0
    normals = np.zeros((*depth.shape, 3))
    if not mean:
        normals[..., 2] = 1
        return normals
    normals[..., 2] = 1 / np.sqrt(1 + squared * (_USUAL_SLOPE**2 / mean))
    steepness = _USUAL_SLOPE / mean**0.5
    normals[..., 0] = -x * steepness * normals[..., 2]
    normals[..., 1] = -y * steepness * normals[..., 2]
    return normals
