"""Where the cells of a raster are: steps in metres from cell to cell, from six numbers of a file.

``transform`` is (a, b, c, d, e, f) as GDAL and rasterio have it: the corner of the cell (row,
column) lies at x = a·column + b·row + c, y = d·column + e·row + f, its centre half a step further.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scene.vectors import numbers_of

__all__ = [
    "METRES_PER_DEGREE", "Transform", "check_heights", "checked_transform", "metric_steps",
    "place_of",
]  # fmt: skip

Floats = NDArray[np.float64]
Transform = tuple[float, float, float, float, float, float]

METRES_PER_DEGREE = 111_320.0
"""Of latitude, and of longitude at the equator."""

_SHORTEST, _LONGEST = 1e-12, 1e12  # metres from cell to cell: a nanometre and a world lie within
_FARTHEST = 1e15  # distances of cells: so far away double precision knows few places within one
_HIGHEST = 1e32  # metres, and Laplacian of heights per metre: a number in single precision
_SHEAR = 1e-3  # of the product of the two steps: rounded numbers of a rotation have less


def checked_transform(transform: ArrayLike) -> Transform:
    """Return six numbers of a transform whose axes are at right angles.

    Raises
    ------
    MeshdepictError
        For other than six finite numbers, cells without an area, and sheared ones.
    """
    numbers = numbers_of(transform)
    if numbers.shape == (9,):  # as rasterio's Affine: its last row is 0, 0, 1
        numbers = numbers[:6]
    if numbers.shape != (6,):
        raise MeshdepictError(
            f"transform={transform!r:.80} is not six finite numbers: a, b, c, d, e, f with "
            "x = a·column + b·row + c, y = d·column + e·row + f"
        )
    a, b, _, d, e, _ = numbers
    across, down = math.hypot(a, d), math.hypot(b, e)
    if not 0 < across * down < math.inf:
        raise MeshdepictError(f"transform={transform!r:.80} gives its cells no area")
    if abs((a / across) * (b / down) + (d / across) * (e / down)) > _SHEAR:
        raise MeshdepictError(
            "the raster is sheared: its columns don't stand at right angles on its rows; warp it "
            "to a grid of squares first (gdalwarp)"
        )
    a, b, c, d, e, f = (float(number) for number in numbers)
    return a, b, c, d, e, f


def metric_steps(transform: Transform, rows: int, *, degrees: bool, unit: float) -> Floats:
    """Return metres east and north of a step to the next column and the next row.

    Parameters
    ----------
    transform : six numbers
    rows : int
    degrees : bool
        Whether they are degrees of longitude and latitude; a degree of longitude shrinks with the
        cosine of the latitude, row by row.
    unit : float
        Metres in one of the transform's, where it isn't in degrees.

    Returns
    -------
    (rows or 1, 2, 2) array
        ``[r, axis, step]``: axis 0 east and 1 north, step 0 along a row and 1 down a column.
    """
    a, b, c, d, e, f = transform
    step = np.array([[[a, b], [d, e]]])
    shortest, longest = _distances(transform, degrees=degrees, unit=unit)
    if not _SHORTEST <= shortest <= longest <= _LONGEST:
        raise MeshdepictError(
            f"cells of {longest:g} x {shortest:g} m are not between {_SHORTEST:g} and "
            f"{_LONGEST:g} m: is their unit right?"
        )
    if max(abs(c), abs(f)) > _FARTHEST * min(math.hypot(a, d), math.hypot(b, e)):
        raise MeshdepictError(
            f"the raster begins at ({c:g}, {f:g}), so far away that its cells can't be told "
            "apart: move it nearer to the origin"
        )
    if not degrees:
        return step * unit
    if b or d:
        raise MeshdepictError(
            "a raster in degrees is turned against north: warp it first, best to metres (gdalwarp)"
        )
    latitude = f + e * (np.arange(rows) + 0.5)
    if not (np.abs(latitude) <= 90 + 1e-9).all():
        raise MeshdepictError(
            f"rows at latitudes from {latitude.min():.6g} to {latitude.max():.6g} degrees: degrees "
            "beyond the poles, or no degrees at all; say what the unit is"
        )
    steps = np.repeat(step * METRES_PER_DEGREE, rows, axis=0)
    # A row at a pole has the steps of a quarter of a cell beside it: none would be no steps at all.
    least = math.cos(math.radians(max(0.0, 90 - abs(e) / 4)))
    steps[:, 0] *= np.maximum(np.cos(np.radians(latitude)), least)[:, None]
    return steps


def check_heights(
    z: NDArray[np.floating], transform: Transform, *, degrees: bool, unit: float
) -> None:
    """Refuse heights (rows, columns) too great to compute with: mostly numbers that stand for none.

    Raises
    ------
    MeshdepictError
        For heights beyond 1e32 metres, on cells shorter than a metre times its square.
    """
    shortest, _ = _distances(transform, degrees=degrees, unit=unit)
    low, high = float(z.min()), float(z.max())
    if max(-low, high) > _HIGHEST * min(shortest, 1.0) ** 2:
        raise MeshdepictError(
            f"heights reach from {low:g} to {high:g} m on cells of {shortest:g} m: mark the cells "
            "that hold none (valid=, NaN, nodata in the file), or check the unit"
        )


def _distances(transform: Transform, *, degrees: bool, unit: float) -> tuple[float, float]:
    """Return the shorter and the longer distance of cells in metres, at the equator."""
    a, b, _, d, e, _ = transform
    metres = METRES_PER_DEGREE if degrees else unit
    across, down = math.hypot(a, d) * metres, math.hypot(b, e) * metres
    return min(across, down), max(across, down)


def place_of(
    transform: Transform,
    rows: Floats,
    columns: Floats,
    *,
    degrees: bool,
    unit: float,
    middle: float,
) -> tuple[Floats, Floats]:
    """Return east and north in metres of cells' centres.

    In degrees from the equator, and from the meridian `middle` along each row.
    """
    a, b, c, d, e, f = transform
    x = a * (columns + 0.5) + b * (rows + 0.5) + c
    y = d * (columns + 0.5) + e * (rows + 0.5) + f
    if not degrees:
        return x * unit, y * unit
    east = (x - middle) * METRES_PER_DEGREE * np.cos(np.radians(y))
    return east, y * METRES_PER_DEGREE
