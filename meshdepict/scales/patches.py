"""Gaussian sums that stay on one patch of a surface: what lies beyond a sharp edge isn't added."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["patch_sums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SMALL = 64  # points: such patches are summed many at a time, each with all of its own points
_PAIRS = 1 << 21  # at a time


def patch_sums(
    patches: Ints | None,
    points: Floats,
    channels: NDArray[Any],
    width: float,
    *,
    error: float,
    targets: NDArray[np.bool_] | None = None,
    heaviest: float | None = None,
    done: Callable[[float], None] | None = None,
) -> NDArray[Any]:
    """Sum Gaussians as `gaussian_sums` does, over the points of each one's own patch alone.

    Parameters
    ----------
    patches : (n,) array of int, optional
        Of the points; all are one unless given.
    points, channels, width, error, targets, heaviest, done
        As for `gaussian_sums`.

    Returns
    -------
    (c, n) array
    """
    from meshdepict.sums.gaussian import gaussian_sums

    if patches is None:
        return gaussian_sums(
            points, channels, width, error=error, targets=targets, heaviest=heaviest, done=done
        )
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
            sums[:, own] = gaussian_sums(
                points[own], channels[:, own], width, error=error, targets=some
            )
    sums[:, ~wanted] = 0
    if done:
        done(1.0)
    return sums


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
