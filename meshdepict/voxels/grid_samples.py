"""Samples of a grid: which voxels are shaded, and where they are."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.voxels.grid import Triple

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction

__all__ = ["Samples", "grown", "shaded_voxels"]


class Valued(Protocol):
    """A volume as far as choosing voxels needs it."""

    @property
    def counts(self) -> Triple:
        """Voxels along z, y and x."""

    def slabs(self) -> Iterable[tuple[slice, NDArray[Any]]]:
        """Yield ``(slices, values)`` along z."""


class Samples(NamedTuple):
    """Chosen voxels of a grid, in its order.

    Attributes
    ----------
    low : (z, y, x)
        The first voxel of the box that they lie in.
    rows : (nz, ny + 1) array of int64
        Where the samples of a row are: of row (z, y) of the box from rows[z, y] to rows[z, y + 1].
    columns : (n,) array of int32
        Their place along x, in the box.
    """

    low: Triple
    rows: NDArray[np.int64]
    columns: NDArray[np.int32]

    @classmethod
    def of_mask(cls, mask: NDArray[np.bool_], corner: Triple = (0, 0, 0)) -> Samples:
        """Return the voxels where a mask that begins at a corner is true."""
        spans = [_ends(np.any(mask, axis=axes)) for axes in ((1, 2), (0, 2), (0, 1))]
        inner = mask[tuple(slice(*span) for span in spans)]
        ends = np.cumsum(np.count_nonzero(inner, axis=2).ravel(), dtype=np.int64)
        nz, ny = inner.shape[:2]
        rows = np.empty((nz, ny + 1), np.int64)
        rows[:, 1:] = ends.reshape(nz, ny)
        rows[:, 0] = np.concatenate(([0], rows[:-1, -1]))
        columns = np.empty(int(ends[-1]) if len(ends) else 0, np.int32)
        for z in range(nz):
            columns[rows[z, 0] : rows[z, -1]] = np.nonzero(inner[z])[1]
        z0, y0, x0 = (c + span[0] for c, span in zip(corner, spans, strict=True))
        return cls((z0, y0, x0), rows, columns)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.columns)

    @property
    def shape(self) -> Triple:
        """Size of the box: (nz, ny, nx)."""
        nx = int(self.columns.max()) + 1 if len(self.columns) else 0
        return self.rows.shape[0], self.rows.shape[1] - 1, nx

    @property
    def high(self) -> Triple:
        """The voxel behind the box."""
        (a, b, c), (nz, ny, nx) = self.low, self.shape
        return a + nz, b + ny, c + nx

    def flat(self, shape: Triple, corner: Triple = (0, 0, 0)) -> NDArray[np.int64]:
        """Return indices into a flat array of a shape that begins at a corner."""
        counts = np.diff(self.rows, axis=1)
        z0, y0, x0 = (a - c for a, c in zip(self.low, corner, strict=True))
        starts = (z0 + np.arange(counts.shape[0]))[:, None] * shape[1] + y0
        starts = (starts + np.arange(counts.shape[1])) * shape[2] + x0
        return np.repeat(starts.ravel(), counts.ravel()) + self.columns

    def indices(self) -> NDArray[np.int64]:
        """Return the voxels (n, 3) in the order x, y, z."""
        counts = np.diff(self.rows, axis=1).ravel()
        rows = np.arange(len(counts))
        ny = self.rows.shape[1] - 1
        found = np.empty((len(self), 3), np.int64)
        found[:, 0] = self.columns
        found[:, 1] = np.repeat(rows % ny if ny else rows, counts)
        found[:, 2] = np.repeat(rows // ny if ny else rows, counts)
        found += self.low[::-1]
        return found

    def beside(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return which samples are among the chosen ones or beside one, also across a corner."""
        box = np.zeros(self.shape, bool)
        at = self.flat(self.shape, self.low)
        box.reshape(-1)[at] = chosen
        return grown(box).reshape(-1)[at]

    def kept(self, keep: NDArray[np.bool_]) -> Samples:
        """Return some of the samples, in the same box."""
        before = np.concatenate(([0], np.cumsum(keep, dtype=np.int64)))
        return Samples(self.low, before[self.rows], self.columns[keep])


def shaded_voxels(
    volume: Valued, where: NDArray[np.bool_] | None, transfer: TransferFunction | None
) -> NDArray[np.bool_]:
    """Return the mask (nz, ny, nx) of voxels with opacity and those beside them.

    Gradient opacity is not yet regarded.

    Raises
    ------
    MeshdepictError
        For `where` of another shape.
    """
    shape = volume.counts
    if where is not None and (where := np.asarray(where)).shape != shape:
        raise MeshdepictError(f"where has shape {where.shape}, the volume {shape}")
    if transfer is None:
        return np.ones(shape, bool) if where is None else np.array(where, bool)
    mask = np.empty(shape, bool)
    for rows, slab in volume.slabs():
        np.greater(transfer.opacity(slab), 0, out=mask[rows])
    mask = grown(mask)
    return mask if where is None else mask & np.asarray(where, bool)


def grown(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a mask grown by one voxel to all sides, across edges and corners, too."""
    for axis in range(mask.ndim):
        wider, along = mask.copy(), np.moveaxis(mask, axis, 0)
        target = np.moveaxis(wider, axis, 0)
        target[1:] |= along[:-1]
        target[:-1] |= along[1:]
        mask = wider
    return mask


def _ends(some: NDArray[np.bool_]) -> tuple[int, int]:
    """Return the range from the first to the last true value."""
    where = np.flatnonzero(some)
    return (int(where[0]), int(where[-1]) + 1) if len(where) else (0, 0)
