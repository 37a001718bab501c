"""Normals of the ground from sums of its gradient, for the cells that hold a height."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["upward_normals"]

# Of the Gaussian's whole weight: what is missing in its last tail. A cell far from every gap then
# has the very normal that it has where there is no gap at all.
_WHOLE = 1 - 1e-5
_NOTHING = 1e-6  # of it: next to no neighbour in reach, and the sums are rounding
_STEEPEST = 1e15  # rise per metre, whose square is a number in single precision, and vertical


def upward_normals(
    sums: NDArray[Any],
    mass: NDArray[Any] | None,
    valid: NDArray[np.bool_],
    out: NDArray[np.float32],
    finer: NDArray[np.float32] | None = None,
) -> None:
    """Fill (3, n) with the directions of (−sums, mass) at the valid cells, row by row.

    Parameters
    ----------
    sums : (2, rows, columns) array
        Of the gradient, east and north.
    mass : (rows, columns) array, optional
        Of the weights; 1 everywhere unless given.
    valid : (rows, columns) array of bool
    out : (3, n) array
    finer : (3, n) array, optional
        Taken where there is next to no mass.
    """
    counts = np.count_nonzero(valid, axis=1)
    first = np.concatenate([[0], np.cumsum(counts)])
    everywhere = np.empty((0, 0), sums.dtype) if mass is None else mass
    usual = np.empty((0, 0), np.float32) if finer is None else finer
    pieces = 4 * thread_count() if valid.size > 20_000 else 1
    each(
        lambda a, b: _normals(sums, everywhere, valid, first, usual, out, a, b),
        spans(len(valid), pieces),
    )


@kernel("contracted")
def _normals(sums, mass, valid, first, finer, out, begin, end):  # type: ignore[no-untyped-def]
    columns = valid.shape[1]
    line = np.empty((4, columns), np.float32)
    one, most = np.float32(1), np.float32(_STEEPEST)
    for row in range(begin, end):
        x, y, z = line[0], line[1], line[2]
        east, north = sums[0, row], sums[1, row]
        if len(mass) > 0:
            here = mass[row]
            for i in range(columns):
                m = np.float32(here[i])
                z[i] = one if m > _WHOLE else m
        else:
            z[:] = one
        for i in range(columns):
            a = np.float32(max(-most, min(most, east[i])))
            b = np.float32(max(-most, min(most, north[i])))
            length = math.sqrt(a * a + b * b + z[i] * z[i])
            x[i], y[i] = -a, -b
            line[3, i] = one / np.float32(max(length, 1e-30))
        k, last = first[row], first[row + 1]
        if last - k == columns and len(mass) == 0:
            ox, oy, oz = out[0, k:last], out[1, k:last], out[2, k:last]
            for i in range(columns):
                ox[i], oy[i], oz[i] = x[i] * line[3, i], y[i] * line[3, i], z[i] * line[3, i]
            continue
        for i in range(columns):
            if not valid[row, i]:
                continue
            if z[i] < _NOTHING:
                if len(finer) > 0:
                    for axis in range(3):
                        out[axis, k] = finer[axis, k]
                else:
                    out[0, k], out[1, k], out[2, k] = 0, 0, 1
            else:
                for axis in range(3):
                    out[axis, k] = line[axis, i] * line[3, i]
            k += 1
