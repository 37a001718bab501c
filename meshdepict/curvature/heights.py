"""Curvature of the ground at the cells of a height field, from how its normals change.

With slopes p = −n_x/n_z, q = −n_y/n_z the symmetric part of their differences is the Hessian of the
smoothed ground, and II = −Hessian·n_z its second fundamental form, positive where convex, over the
tangents that lie above steps to the east and north.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.tensor import _principal, tangent
from meshdepict.heights.gradients import inverse_steps
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["height_curvatures"]


def height_curvatures(
    index: NDArray[np.int32], normals: NDArray[np.float32], steps: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Return principal curvatures (2, n) in 1/m and directions (2, n, 3).

    Differences are those of the two neighbours, of one where the other is missing, none where both
    are.

    Parameters
    ----------
    index : (rows + 2, columns + 2) array
        The sample at each cell, negative where there is none; see `HeightField.index`.
    normals : (3, n) array of float32
        Unit, upward.
    steps : (rows or 1, 2, 2) array
        See `cells.metric_steps`.
    """
    count = normals.shape[1]
    k, d = np.empty((2, count)), np.empty((2, count, 3), np.float32)
    inverse = inverse_steps(steps)
    pieces = 4 * thread_count() if count > 10_000 else 1
    each(
        lambda a, b: _curvatures(index, normals, inverse, k, d, a + 1, b + 1),
        spans(len(index) - 2, pieces),
    )
    return k, d


@kernel("contracted")
def _turn(normals, before, here, after, axis):  # type: ignore[no-untyped-def]
    """Return the difference of a slope per step between neighbours."""
    low, high = before if before >= 0 else here, after if after >= 0 else here
    steps = (before >= 0) + (after >= 0)
    if steps == 0:
        return 0.0
    first = -np.float64(normals[axis, low]) / normals[2, low]
    second = -np.float64(normals[axis, high]) / normals[2, high]
    return (second - first) / steps


@kernel("contracted")
def _curvatures(index, normals, inverse, k, d, begin, end):  # type: ignore[no-untyped-def]
    sums = np.empty(4)
    for row in range(begin, end):
        m = inverse[min(row - 1, len(inverse) - 1)]
        for column in range(1, index.shape[1] - 1):
            i = index[row, column]
            if i < 0:
                continue
            left, right = index[row, column - 1], index[row, column + 1]
            up, down = index[row - 1, column], index[row + 1, column]
            px, py = _turn(normals, left, i, right, 0), _turn(normals, up, i, down, 0)
            qx, qy = _turn(normals, left, i, right, 1), _turn(normals, up, i, down, 1)
            xx, yy = m[0, 0] * px + m[0, 1] * py, m[1, 0] * qx + m[1, 1] * qy
            xy = 0.5 * ((m[1, 0] * px + m[1, 1] * py) + (m[0, 0] * qx + m[0, 1] * qy))
            x, y, z = (
                np.float64(normals[0, i]),
                np.float64(normals[1, i]),
                np.float64(normals[2, i]),
            )
            ux, uy, uz = tangent(x, y, z)
            vx, vy = y * uz - z * uy, z * ux - x * uz
            sums[0] = -z * (ux * ux * xx + 2 * ux * uy * xy + uy * uy * yy)
            sums[1] = -z * (ux * vx * xx + (ux * vy + uy * vx) * xy + uy * vy * yy)
            sums[2] = -z * (vx * vx * xx + 2 * vx * vy * xy + vy * vy * yy)
            sums[3] = 1.0
            _principal(x, y, z, sums, i, k, d)
