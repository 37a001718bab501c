"""Cells that stand for a raster: few, spread evenly, and the same however it is cut in windows."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["is_large", "typical_cells", "typical_places"]

_SAMPLES = 8_000
_SMALL = 4_000_000  # cells of a raster that may be looked at as a whole
_BLOCKS, _SIDE = 11, 8  # of larger ones 11 × 11 blocks of 8 × 8 cells: all else needn't be smoothed


def is_large(rows: int, columns: int) -> bool:
    """Whether blocks of cells stand for a raster, so that the rest needn't be looked at."""
    return rows * columns > _SMALL


def typical_cells(
    rows: int, columns: int, down: slice = slice(None), across: slice = slice(None)
) -> NDArray[np.bool_]:
    """Return which cells of a window stand for a raster: all of the raster unless given."""
    (top, bottom, _), (left, right, _) = down.indices(rows), across.indices(columns)
    found = np.zeros((bottom - top, right - left), bool)
    for row, column in typical_places(rows, columns):
        found[_moved(row, top, rows), _moved(column, left, columns)] = True
    return found


def typical_places(rows: int, columns: int) -> Iterator[tuple[slice, slice]]:
    """Yield where the cells are that stand for a raster."""
    if not is_large(rows, columns):
        step = max(1, math.ceil(math.sqrt(rows * columns / _SAMPLES)))
        first = (step // 2 if count > step else 0 for count in (rows, columns))
        yield slice(next(first), rows, step), slice(next(first), columns, step)
        return
    for down in _blocks(rows):
        for across in _blocks(columns):
            yield down, across


def _blocks(count: int) -> Iterator[slice]:
    blocks = min(_BLOCKS, max(1, count // _SIDE))
    for number in range(blocks):
        start = max(0, (2 * number + 1) * count // (2 * blocks) - _SIDE // 2)
        yield slice(start, min(start + _SIDE, count))


def _moved(place: slice, begin: int, count: int) -> slice:
    """Return a slice of a raster in a window of it that begins later."""
    start, stop, step = place.indices(count)
    first = start - begin if start >= begin else (start - begin) % step if step > 1 else 0
    return slice(first, max(stop - begin, 0), step)
