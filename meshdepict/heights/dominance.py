"""Local dominance (Hesse 2016): how far down an observer at a cell looks on the land around."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["dominances"]

Singles = NDArray[np.float32]

_SUMMIT = 1e30  # stands where there is no height: nobody looks down on it
_ROWS = 16  # rows of a piece of work
_CHUNK = 1024  # cells whose sums stay in the fastest cache


def dominances(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    *,
    nearest: int = 10,
    farthest: int = 20,
    directions: int = 24,
    observer: float = 1.7,
) -> Singles:
    """Return Σ max(0, h + observer − h_j)(2d_j + 1)/d_j over rings, relative to level land.

    (2d + 1)/d is the slope at which an observer looks on a cell times the area that it stands for.
    The same as the Relief Visualization Toolbox's where all cells hold a height; others count for
    nothing.

    Parameters
    ----------
    z, valid
        As for `horn.horn_slopes`.
    nearest, farthest : int
        The rings, in cells.
    directions : int
        Cells on each ring.
    observer : float
        Height of the eye above the ground, in the heights' unit.

    Returns
    -------
    (rows, cols) array of float32
        1 on a level plane; 1 where no height is known, and where nothing is seen around.
    """
    rings = np.arange(nearest, farthest + 1, dtype=np.float64)
    turn = np.radians(np.arange(directions) * (360 / directions))
    down = np.rint(np.outer(np.sin(turn), rings)).astype(np.int64).ravel()
    across = np.rint(np.outer(np.cos(turn), rings)).astype(np.int64).ravel()
    weights = np.tile((2 * rings + 1) / rings, directions).astype(z.dtype)
    rows, cols = z.shape
    ground = np.full((rows + 2 * farthest, cols + 2 * farthest), _SUMMIT, z.dtype)
    inner = ground[farthest : farthest + rows, farthest : farthest + cols]
    inner[...] = z
    if valid is not None:
        inner[~valid] = _SUMMIT
    out = np.ones(z.shape, np.float32)
    eye = z.dtype.type(observer)
    each(
        lambda a, b: _seen(ground, farthest, -down, -across, weights, eye, out, a, b),
        spans(rows, max(thread_count(), rows // _ROWS)),
    )
    if valid is not None:
        out[~valid] = 1
    return out


@kernel("contracted")
def _seen(ground, reach, down, across, weights, eye, out, begin, end):  # type: ignore[no-untyped-def]
    sums, norms = np.empty((2, _CHUNK), ground.dtype)
    zero, none, cols = eye - eye, _SUMMIT / 2, out.shape[1]
    for row in range(begin, end):
        for low in range(0, cols, _CHUNK):
            count = min(_CHUNK, cols - low)
            here = ground[row + reach, reach + low : reach + low + count]
            for i in range(count):
                sums[i] = norms[i] = zero
            for t in range(len(weights)):
                w = weights[t]
                at = reach + low + across[t]
                there = ground[row + reach + down[t], at : at + count]
                for i in range(count):
                    above = (here[i] - there[i]) + eye
                    sums[i] += w * (above if above > zero else zero)
                    norms[i] += w if there[i] < none else zero
            for i in range(count):
                if norms[i] > zero:
                    out[row, low + i] = sums[i] / (norms[i] * eye)
