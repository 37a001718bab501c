"""How high a cell stands among those around it, in standard deviations (Lindsay et al. 2015).

Sums over windows are put together of sums over 1, 2, 4, … cells from each cell on: the cost grows
with the logarithm of the window, nothing that was added is subtracted again, and a cell's sum runs
in the same order wherever a raster begins.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["deviations"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

_COLUMNS = 16  # whose sums are kept at a time
_ROUNDING = 1e-13  # of the mean square: below it heights differ by rounding alone
_STAGE = 32_768.0  # metres: squares are of heights above a multiple of this, on earth above the sea


def deviations(z: NDArray[Any], valid: NDArray[np.bool_] | None, radius: int) -> Singles:
    """Return (h − mean)/deviation over the square of 2·radius + 1 cells round each cell.

    A part of a raster with as many cells more around it as the window's radius has the numbers of
    the whole, bit for bit where both are about as high.

    Parameters
    ----------
    z : (rows, cols) array of float32 or float64
    valid : (rows, cols) array of bool, optional
        Cells that hold a height; the others count for nothing, as those beyond the border.
    radius : int
        Of the window, in cells.

    Returns
    -------
    (rows, cols) array of float32
        0 where all are as high, and where not valid.
    """
    known = z if valid is None else z[valid]
    middle = (float(known.min()) + float(known.max())) / 2 if known.size else 0.0
    level = round(middle / _STAGE) * _STAGE
    mask = np.empty((0, 0), np.bool_) if valid is None else valid
    rows, cols = z.shape
    down, across = (min(int(radius), count) for count in z.shape)
    sums, out = np.empty((3, rows, cols)), np.zeros(z.shape, np.float32)
    each(
        lambda a, b: _along(z, mask, level, across, sums, a, b),
        spans(rows, 4 * thread_count()),
    )
    each(
        lambda a, b: _down(z, mask, level, down, sums, out, a, b),
        spans(cols, max(4 * thread_count(), cols // _COLUMNS)),
    )
    return out


@kernel("contracted")
def _windows(line, radius, count, out):  # type: ignore[no-untyped-def]
    """Sum windows of 2·radius + 1 rows of `line`, which begin at each of `count` rows; spoil it.

    ``line`` (count + 2·radius, wide) holds sums over 2^k rows from each one on, for k = 0, 1, ….
    """
    span, wide = 2 * radius + 1, line.shape[1]
    out[:] = 0.0
    size, begin = 1, 0
    while True:
        if span & size:
            for r in range(count):
                for c in range(wide):
                    out[r, c] += line[r + begin, c]
            begin += size
        if begin == span:
            break
        for r in range(len(line) - size):
            for c in range(wide):
                line[r, c] += line[r + size, c]
        size *= 2


@kernel("contracted")
def _along(z, mask, level, radius, sums, begin, end):  # type: ignore[no-untyped-def]
    """Find numbers, heights and squares, summed over the cells in reach along each row."""
    cols = z.shape[1]
    line, found = np.empty((cols + 2 * radius, 3)), np.empty((cols, 3))
    for r in range(begin, end):
        line[:] = 0.0
        for c in range(cols):
            if mask.size == 0 or mask[r, c]:
                height = np.float64(z[r, c]) - level
                line[radius + c, 0] = 1.0
                line[radius + c, 1] = height
                line[radius + c, 2] = height * height
        _windows(line, radius, cols, found)
        for k in range(3):
            for c in range(cols):
                sums[k, r, c] = found[c, k]


@kernel("contracted")
def _down(z, mask, level, radius, sums, out, begin, end):  # type: ignore[no-untyped-def]
    """Sum the sums along rows down the columns, too, and find deviations."""
    rows, wide = z.shape[0], end - begin
    line, found = np.empty((rows + 2 * radius, wide)), np.empty((3, rows, wide))
    for k in range(3):
        line[:] = 0.0
        line[radius : radius + rows] = sums[k, :, begin:end]
        _windows(line, radius, rows, found[k])
    for r in range(rows):
        for c in range(wide):
            if mask.size > 0 and not mask[r, begin + c]:
                continue
            number, total, squares = found[0, r, c], found[1, r, c], found[2, r, c]
            mean, square = total / number, squares / number
            variance = square - mean * mean
            if variance > _ROUNDING * square:
                height = np.float64(z[r, begin + c]) - level
                out[r, begin + c] = (height - mean) / math.sqrt(variance)
