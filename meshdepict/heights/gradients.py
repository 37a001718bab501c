"""Gradients of heights, cell by cell: how far the ground rises per metre to the east and north."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["gradients", "inverse_steps"]

Single = NDArray[np.float32]


def inverse_steps(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (rows or 1, 2, 2): per metre [east, north] from per step [along the row, down]."""
    return np.ascontiguousarray(np.linalg.inv(steps).transpose(0, 2, 1))


def gradients(
    z: NDArray[np.floating], valid: NDArray[np.bool_], steps: NDArray[np.float64]
) -> tuple[Single, NDArray[np.bool_]]:
    """Return ∂h/∂east and ∂h/∂north, and which cells have one.

    Differences of the two neighbours along each axis; with the cell itself where one of them is
    missing or beyond the border, so that a plane has one gradient everywhere. A cell without a
    neighbour along an axis has no gradient, but in a raster that is one cell wide.

    Parameters
    ----------
    z, valid : (rows, columns) array
    steps : (rows or 1, 2, 2) array
        See `cells.metric_steps`.

    Returns
    -------
    (2, rows, columns) array of float32
        0 where there is none, along an axis too.
    (rows, columns) array of bool
    """
    found, known = np.empty((2, *z.shape), np.float32), np.empty(z.shape, bool)
    inverse = inverse_steps(steps)
    whole = valid.all(axis=1)
    pieces = 4 * thread_count() if z.size > 20_000 else 1
    each(
        lambda a, b: _gradients(z, valid, whole, inverse, found, known, a, b),
        spans(len(z), pieces),
    )
    return found, known


@kernel("contracted")
def _slope(before, here, after, known_before, known_after):  # type: ignore[no-untyped-def]
    """Return the difference per step between two neighbours, of which some may be missing."""
    if known_before and known_after:
        return 0.5 * (after - before)
    if known_after:
        return after - here
    if known_before:
        return here - before
    return 0.0


@kernel("contracted")
def _gradients(z, valid, whole, inverse, found, known, begin, end):  # type: ignore[no-untyped-def]
    rows, columns = z.shape
    for row in range(begin, end):
        m = inverse[min(row, len(inverse) - 1)]
        up, down = max(row - 1, 0), min(row + 1, rows - 1)
        step = 1.0 / max(down - up, 1)
        full = whole[up] and whole[row] and whole[down] and columns > 2
        if full:  # but for the ends
            above, here, below = z[up], z[row], z[down]
            east, north = found[0, row], found[1, row]
            for i in range(1, columns - 1):
                along = 0.5 * (np.float64(here[i + 1]) - np.float64(here[i - 1]))
                across = step * (np.float64(below[i]) - np.float64(above[i]))
                east[i] = m[0, 0] * along + m[0, 1] * across
                north[i] = m[1, 0] * along + m[1, 1] * across
                known[row, i] = True
        for column in range(0, columns, columns - 1 if full else 1):
            if not valid[row, column]:
                found[0, row, column] = found[1, row, column] = 0
                known[row, column] = False
                continue
            left, right = max(column - 1, 0), min(column + 1, columns - 1)
            west, east_ = left < column and valid[row, left], right > column and valid[row, right]
            north_, south = up < row and valid[up, column], down > row and valid[down, column]
            value = np.float64(z[row, column])
            along = _slope(np.float64(z[row, left]), value, np.float64(z[row, right]), west, east_)
            across = _slope(
                np.float64(z[up, column]), value, np.float64(z[down, column]), north_, south
            )
            found[0, row, column] = m[0, 0] * along + m[0, 1] * across
            found[1, row, column] = m[1, 0] * along + m[1, 1] * across
            known[row, column] = (west or east_ or columns == 1) and (north_ or south or rows == 1)
