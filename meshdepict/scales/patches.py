"""Gaussian sums that stay on one patch of a surface: what lies beyond a sharp edge isn't added."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdepict.sums.gaussian import GaussianSums

__all__ = ["PatchSums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SMALL = 64  # points: such patches are summed many at a time, each with all of its own points
_PAIRS = 1 << 21  # at a time


class PatchSums:
    """Sums as `GaussianSums` has them, over the points of each one's own patch alone.

    Parameters
    ----------
    patches : (n,) array of int, optional
        Of the points; all are one unless given.
    points, channels, widths
        As for `GaussianSums`.
    """

    def __init__(
        self,
        patches: Ints | None,
        points: Floats,
        channels: NDArray[Any],
        widths: Iterable[float] = (),
    ) -> None:
        from meshdepict.sums.gaussian import GaussianSums

        self._patches, self._points, self._channels = patches, points, channels
        self._widths = tuple(widths)
        self._whole = None if patches is not None else GaussianSums(points, channels, self._widths)
        self._parts: dict[int, GaussianSums] = {}

    def at(
        self,
        width: float,
        *,
        error: float,
        targets: NDArray[np.bool_] | None = None,
        heaviest: float | None = None,
        done: Callable[[float], None] | None = None,
    ) -> NDArray[Any]:
        """Return sums (c, n) at one width; see `GaussianSums.at`."""
        if self._whole is not None:
            return self._whole.at(width, error=error, targets=targets, heaviest=heaviest, done=done)
        patches, points, channels = self._patches, self._points, self._channels
        assert patches is not None
        sums = np.zeros((len(channels), len(points)))
        order = np.argsort(patches, kind="stable")
        begin = np.flatnonzero(np.diff(patches[order], prepend=-1))
        count = np.diff(begin, append=len(order))
        wanted = np.ones(len(points), bool) if targets is None else targets
        for rows in _alike(order, begin, count):
            if wanted[rows].any():
                sums[:, rows] = _dense(points[rows] / width, channels[:, rows])
        for patch in np.flatnonzero(count > _SMALL):
            own = order[begin[patch] : begin[patch] + count[patch]]
            some = None if targets is None else targets[own]
            if some is None or some.any():
                sums[:, own] = self._part(int(patch), own).at(width, error=error, targets=some)
        sums[:, ~wanted] = 0
        if done:
            done(1.0)
        return sums

    def _part(self, patch: int, own: Ints) -> GaussianSums:
        from meshdepict.sums.gaussian import GaussianSums

        if patch not in self._parts:
            points, channels = self._points[own], self._channels[:, own]
            self._parts[patch] = GaussianSums(points, channels, self._widths)
        return self._parts[patch]


def _alike(order: Ints, begin: Ints, count: Ints) -> Iterator[Ints]:
    """Yield the points of small patches, (k, s) of k patches with s points each."""
    for size in np.unique(count[count <= _SMALL]):
        first = begin[count == size]
        step = max(1, _PAIRS // int(size) ** 2)
        for at in range(0, len(first), step):
            yield order[first[at : at + step, None] + np.arange(size)]


def _dense(points: Floats, channels: NDArray[Any]) -> Floats:
    """Return the sums (c, k, s) of patches with points (k, s, 3) in widths."""
    squared = sum((points[:, :, None, axis] - points[:, None, :, axis]) ** 2 for axis in range(3))
    # (Not a product of matrices: BLAS would wake all of its threads.)
    return np.einsum("kij,ckj->cki", np.exp(-0.5 * squared), channels.astype(np.float64))
