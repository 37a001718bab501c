"""Where a volume is empty: blocks of voxels that rays may leap over, and how far.

Neither the block nor those around it, up to a distance, have a level with opacity anywhere between
their voxels: rays lose nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.voxels.grid_samples import grown

__all__ = ["BLOCK", "clearance"]

BLOCK = 8
"""Voxels along a block's side."""

_FARTHEST = 32  # blocks: rays that leap 256 voxels at a time leap far enough


def clearance(levels: NDArray[Any], opacity: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return how many blocks away the next matter is, (bz, by, bx); 0 in blocks that have some.

    Parameters
    ----------
    levels : (nz, ny, nx) array
        Unsigned bytes, or floats in [0, 1].
    opacity : (k,) array
        Of levels from the first to the last.
    """
    low, high = _ends(levels, np.minimum), _ends(levels, np.maximum)
    top = 255 if levels.dtype == np.uint8 else 1
    first = np.floor(low * ((len(opacity) - 1) / top)).astype(np.intp)
    last = np.ceil(high * ((len(opacity) - 1) / top)).astype(np.intp)
    opaque_until = np.concatenate(([0], np.cumsum(opacity > 0)))
    near = opaque_until[last + 1] > opaque_until[first]
    away = np.zeros(near.shape, np.float32)
    for _ in range(_FARTHEST):
        away += ~near
        near = grown(near)
    return away


def _ends(levels: NDArray[Any], extreme: np.ufunc) -> NDArray[np.float64]:
    """Return the smallest or largest level of each block of cells, its far corners among them."""
    found = levels
    for axis in range(3):
        count = found.shape[axis]
        starts = np.arange(0, max(count - 1, 1), BLOCK)
        beyond = np.take(found, np.minimum(starts + BLOCK, count - 1), axis=axis)
        found = extreme(extreme.reduceat(found, starts, axis=axis), beyond)
    return found.astype(np.float64)
