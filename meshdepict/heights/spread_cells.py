"""Cells that stand for a raster: few, spread evenly, and the same however it is cut in windows."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["typical_cells", "typical_places"]

_SAMPLES = 8_000
_SMALL = 4_000_000  # cells of a raster that may be looked at as a whole
_BLOCKS, _SIDE = 11, 8  # of larger ones 11 × 11 blocks of 8 × 8 cells: all else needn't be smoothed


def typical_cells(rows: int, columns: int) -> NDArray[np.bool_]:
    """Return which cells (rows, columns) stand for a raster."""
    found = np.zeros((rows, columns), bool)
    for down, across in typical_places(rows, columns):
        found[down, across] = True
    return found


def typical_places(rows: int, columns: int) -> Iterator[tuple[slice, slice]]:
    """Yield where the cells are that stand for a raster."""
    if rows * columns <= _SMALL:
        step = max(1, math.ceil(math.sqrt(rows * columns / _SAMPLES)))
        yield (
            slice(step // 2 if rows > step else 0, None, step),
            slice(step // 2 if columns > step else 0, None, step),
        )
        return
    for down in _blocks(rows):
        for across in _blocks(columns):
            yield down, across


def _blocks(count: int) -> Iterator[slice]:
    blocks = min(_BLOCKS, max(1, count // _SIDE))
    for number in range(blocks):
        start = max(0, (2 * number + 1) * count // (2 * blocks) - _SIDE // 2)
        yield slice(start, min(start + _SIDE, count))
