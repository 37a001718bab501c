"""How high a cell stands among those around it, in standard deviations (Lindsay et al. 2015).

Sums over windows are put together of sums that run from the windows' ends to places a window's
length apart: every number is added once, nothing is subtracted again, and the cost does not grow
with the window.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.heights.level import middle_height
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["deviations"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

_COLUMNS = 32  # whose sums are kept at a time
_ROUNDING = 1e-13  # of the mean square: below it heights differ by rounding alone


def deviations(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    radius: int,
    *,
    middle: float | None = None,
    origin: tuple[int, int] = (0, 0),
) -> Singles:
    """Return (h − mean)/deviation over the square of 2·radius + 1 cells round each cell.

    Parameters
    ----------
    z : (rows, cols) array of float32 or float64
    valid : (rows, cols) array of bool, optional
        Cells that hold a height; the others count for nothing, as those beyond the border.
    radius : int
        Of the window, in cells.
    middle : float, optional
        A height about which squares are taken; the middle of all unless given.
    origin : (row, column)
        Of a part of a raster in the whole: with ``middle`` and as many cells more around it as the
        window's radius, a part has the numbers of the whole, bit for bit.

    Returns
    -------
    (rows, cols) array of float32
        0 where all are as high, and where not valid.
    """
    if middle is None:
        middle = middle_height(z, valid)
    mask = np.empty((0, 0), np.bool_) if valid is None else valid
    rows, cols = z.shape
    span = 2 * int(radius) + 1
    sums, out = np.empty((3, rows, cols)), np.zeros(z.shape, np.float32)
    pieces = 4 * thread_count()
    each(lambda a, b: _along(z, mask, middle, span, origin[1], sums, a, b), spans(rows, pieces))
    each(
        lambda a, b: _down(z, mask, middle, span, origin[0], sums, out, a, b),
        spans(cols, max(pieces, cols // _COLUMNS)),
    )
    return out


@kernel("contracted")
def _along(z, mask, middle, span, origin, sums, begin, end):  # type: ignore[no-untyped-def]
    """Find numbers, heights and squares, summed over the cells in reach along each row."""
    cols, half = z.shape[1], span // 2
    line, ends = np.zeros((3, cols)), np.zeros((3, cols + 1))
    for r in range(begin, end):
        for c in range(cols):
            there = mask.size == 0 or mask[r, c]
            height = np.float64(z[r, c]) - middle if there else 0.0
            line[0, c], line[1, c], line[2, c] = 1.0 if there else 0.0, height, height * height
        for k in range(3):
            # ends[c]: from c to the end of the block of `span` that holds it.
            for c in range(cols - 1, -1, -1):
                last = (c + origin + 1) % span == 0
                ends[k, c] = line[k, c] if last or c == cols - 1 else line[k, c] + ends[k, c + 1]
            run = 0.0
            at = 0  # the next column to be added to the run, which began at a block's beginning
            for c in range(cols):
                first, stop = c - half, c + half + 1
                # The only boundary of blocks within [first, stop), if the window isn't one block.
                boundary = first + (-(first + origin)) % span
                if boundary == first:
                    boundary += span
                if at < boundary or at > stop:
                    at, run = max(boundary, 0), 0.0
                while at < min(stop, cols):
                    run += line[k, at]
                    at += 1
                low = max(first, 0)
                head = ends[k, low] if low < min(boundary, cols) else 0.0
                sums[k, r, c] = head + (run if boundary < stop else 0.0)


@kernel("contracted")
def _down(z, mask, middle, span, origin, sums, out, begin, end):  # type: ignore[no-untyped-def]
    """Sum the sums along rows down the columns, too, and find deviations."""
    rows, half = z.shape[0], span // 2
    wide = end - begin
    tall = min(span, rows)
    ends, run = np.zeros((tall + 1, 3, wide)), np.zeros((3, wide))
    block = (-half + origin) // span  # floor
    while block * span - origin + half < rows:
        start = block * span - origin  # of the block, in rows of this raster
        top, bottom = max(start, 0), min(start + span, rows)
        for i in range(3):
            for c in range(wide):
                run[i, c] = 0.0
        for r in range(bottom - 1, top - 1, -1):
            for i in range(3):
                for c in range(wide):
                    run[i, c] = sums[i, r, begin + c] + (run[i, c] if r < bottom - 1 else 0.0)
                    ends[r - top, i, c] = run[i, c]
        for i in range(3):
            for c in range(wide):
                run[i, c] = 0.0
        one = max(start, -half)  # where the first window begins whose centre is a row
        for added in range(max(start + span, 0), min(one + span - 1, rows)):
            for i in range(3):
                for c in range(wide):
                    run[i, c] += sums[i, added, begin + c]
        for first in range(one, min(start + span, rows - half)):
            centre, added = first + half, first + span - 1
            if first > start and 0 <= added < rows:
                for i in range(3):
                    for c in range(wide):
                        run[i, c] += sums[i, added, begin + c]
            low = max(first, 0)
            for c in range(wide):
                if mask.size > 0 and not mask[centre, begin + c]:
                    continue
                number, total, squares = run[0, c], run[1, c], run[2, c]
                if low < bottom:
                    number += ends[low - top, 0, c]
                    total += ends[low - top, 1, c]
                    squares += ends[low - top, 2, c]
                mean, square = total / number, squares / number
                variance = square - mean * mean
                if variance > _ROUNDING * square:
                    height = np.float64(z[centre, begin + c]) - middle
                    out[centre, begin + c] = (height - mean) / math.sqrt(variance)
        block += 1
