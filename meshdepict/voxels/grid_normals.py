"""Normals of a grid: where there are none, and the ways between voxels and the world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from meshdepict.voxels.grid import Triple
from meshdepict.voxels.grid_samples import Samples

if TYPE_CHECKING:
    from meshdepict.voxels.grid import Grid

__all__ = ["Scattered", "gradients_to_world", "in_voxels", "least_gradient", "packed"]

# Where the values change by less than this share of their range within a width (a voxel, if that is
# more), the gradient is none: what is left of 1 − 1 in single precision is a tenth of it.
_NONE = 1e-6

_WIDEST = 4.0  # lengths of an axis
_NARROWEST = 1e-6  # voxels


def packed(
    planes: NDArray[np.float32], keep: NDArray[np.bool_], scales: Sequence[int]
) -> NDArray[np.float32]:
    """Return planes (scales + 1, 3, k) of the samples to keep; some sets, packed in place."""
    count, values = int(np.count_nonzero(keep)), planes.reshape(-1)
    for row in (3 * scale + axis for scale in scales for axis in range(3)):
        values[row * count : (row + 1) * count] = planes[row // 3, row % 3][keep]
    return values[: len(planes) * 3 * count].reshape(len(planes), 3, count)


def in_voxels(width: float, grid: Grid) -> NDArray[np.float64]:
    """Return a width along z, y and x in voxels, at most a few lengths of the axes.

    There everything has decayed, and the smallest gradient that counts must not do so, too. A
    Gaussian of next to no width is a point, of the width 0.
    """
    most = _WIDEST * np.array(grid.counts)
    with np.errstate(over="ignore"):
        found = np.minimum(width / grid.spacing[::-1], most)
    return np.where(found < _NARROWEST, 0.0, found)


def least_gradient(width: float, grid: Grid) -> float:
    """Return the least length of a gradient of values in −1 … 1, per smallest spacing."""
    return 2 * _NONE / max(float(in_voxels(width, grid).max()), 1.0)


def gradients_to_world(grid: Grid) -> NDArray[np.float64]:
    """Return the matrix from d/dx, d/dy, d/dz per voxel to the world, per smallest spacing."""
    return np.ascontiguousarray(grid.direction * (grid.spacing.min() / grid.spacing))


class Scattered:
    """A grid that is zero but at samples, to be read like a `Piece`."""

    def __init__(self, samples: Samples, values: NDArray[Any], shape: Triple) -> None:
        self.samples, self.values, self.shape = samples, values, shape

    def read(self, low: Triple, high: Triple, kind: DTypeLike) -> NDArray[Any]:
        """Return a box that holds all samples of its slices."""
        block = np.zeros([b - a for a, b in zip(low, high, strict=True)], kind)
        rows = self.samples.rows
        begin, end = (
            int(np.clip(z - self.samples.low[0], 0, len(rows))) for z in (low[0], high[0])
        )
        if end > begin:
            a, b = rows[begin, 0], rows[end - 1, -1]
            part = Samples(
                (self.samples.low[0] + begin, *self.samples.low[1:]),
                rows[begin:end] - a,
                self.samples.columns[a:b],
            )
            block.reshape(-1)[part.flat(block.shape, low)] = self.values[a:b]
        return block
