"""Which cell of a raster lies at a place on the map."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.heights.cells import METRES_PER_DEGREE, Transform

__all__ = ["cells_at"]

Floats = NDArray[np.float64]


def cells_at(
    transform: Transform,
    east: Floats,
    north: Floats,
    *,
    degrees: bool,
    unit: float,
    middle: float,
) -> tuple[Floats, Floats]:
    """Return rows and columns, counted from the first cell's corner, at places in metres.

    What `cells.place_of` does, the other way round: a cell's centre is at half a row and half a
    column. In degrees a row is as wide as its middle is, over all of its height.

    Parameters
    ----------
    transform : six numbers
    east, north : arrays of one shape
    degrees, unit, middle
        As for `place_of`.
    """
    a, b, c, d, e, f = transform
    if degrees:
        rows = (north / METRES_PER_DEGREE - f) / e
        latitude = f + e * (np.floor(rows) + 0.5)
        parallel = METRES_PER_DEGREE * np.maximum(np.cos(np.radians(latitude)), 1e-9)
        return rows, (east / parallel + middle - c) / a
    x, y = east / unit - c, north / unit - f
    determinant = a * e - b * d
    return (a * y - d * x) / determinant, (e * x - b * y) / determinant
