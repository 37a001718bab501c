"""Curvature in a grid: how the surfaces of equal values bend, and how normals turn.

At a voxel with gradient g, Hessian ∇∇f and normal n = −g/‖g‖ the surface of its value has the
shape operator S = −P ∇∇f P/‖g‖, P = 1 − n nᵀ: positive where the dense side is convex, 1/r on a
ball of radius r that is brighter than what is around it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.principal import PrincipalCurvatures
from meshdepict.curvature.tensor import _principal, tangent
from meshdepict.threads import each, kernel, spans, thread_count
from meshdepict.voxels.grid_samples import Samples

__all__ = ["HESSIAN", "grid_neighbour_cosines", "isosurface_curvatures"]

# Orders along z, y, x of xx, yy, zz, xy, xz, yz.
HESSIAN = ((0, 0, 2), (0, 2, 0), (2, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 0))


_SHARPEST = 1.0  # per voxel: a grid shows no ball smaller than its voxels


def isosurface_curvatures(
    derivatives: NDArray[np.float32],
    normals: NDArray[np.float32],
    matrix: NDArray[np.float64],
    floor: float,
    voxel: float,
) -> PrincipalCurvatures:
    """Return principal curvatures at samples from the first and second derivatives there.

    Bounded by one over the voxel's size, since with the gradient's length they grow without end
    where it vanishes; 0 where there is no gradient.

    Parameters
    ----------
    derivatives : (9, n) array
        Gradient x, y, z and `HESSIAN`, per voxel.
    normals : (3, n) array
        Unit normals; the directions are perpendicular to them.
    matrix : (3, 3) array
        From derivatives per voxel to the world's, in voxel sizes.
    floor : float
        Length of the gradient, in these, below which there is none.
    voxel : float
        The size of a voxel in world units.
    """
    count = derivatives.shape[1]
    k, d = np.empty((2, count)), np.empty((2, count, 3), np.float32)
    pieces = thread_count() if count > 10_000 else 1
    each(lambda a, b: _bend(derivatives, normals, matrix, floor, a, b, k, d), spans(count, pieces))
    k /= voxel
    arrays = (k[0], k[1], d[0], d[1])
    for array in arrays:
        array.setflags(write=False)
    return PrincipalCurvatures(*arrays)


@kernel("contracted")
def _bend(derivatives, normals, matrix, floor, begin, end, k, d):  # type: ignore[no-untyped-def]
    sums, frame = np.empty(4), np.empty((2, 3))
    for i in range(begin, end):
        x, y, z = normals[0, i], normals[1, i], normals[2, i]
        frame[0, 0], frame[0, 1], frame[0, 2] = tangent(x, y, z)
        frame[1, 0] = y * frame[0, 2] - z * frame[0, 1]
        frame[1, 1] = z * frame[0, 0] - x * frame[0, 2]
        frame[1, 2] = x * frame[0, 1] - y * frame[0, 0]
        local = frame @ matrix  # the tangents in voxels
        squared = 0.0
        for a in range(3):
            part = 0.0
            for b in range(3):
                part += matrix[a, b] * derivatives[b, i]
            squared += part * part
        length = math.sqrt(squared)
        at = 0
        for a in range(2):
            for b in range(a, 2):
                p, q = local[a], local[b]
                sums[at] = (
                    p[0] * q[0] * derivatives[3, i]
                    + p[1] * q[1] * derivatives[4, i]
                    + p[2] * q[2] * derivatives[5, i]
                    + (p[0] * q[1] + p[1] * q[0]) * derivatives[6, i]
                    + (p[0] * q[2] + p[2] * q[0]) * derivatives[7, i]
                    + (p[1] * q[2] + p[2] * q[1]) * derivatives[8, i]
                )
                sums[at] = -sums[at] / length if length > floor else 0.0
                at += 1
        sums[3] = 1.0
        _principal(x, y, z, sums, i, k, d)
        k[0, i] = max(-_SHARPEST, min(_SHARPEST, k[0, i]))
        k[1, i] = max(-_SHARPEST, min(_SHARPEST, k[1, i]))


def grid_neighbour_cosines(samples: Samples, normals: NDArray[Any]) -> NDArray[np.float32]:
    """Return for each sample the least cosine between its normal and a neighbour's: (n,), ≤ 1.

    Neighbours are those of the six voxels around that are samples.

    Parameters
    ----------
    samples : Samples
    normals : (3, n) array
        Unit vectors.
    """
    least = np.ones(len(samples), np.float32)
    arguments = samples.rows, samples.columns, normals, least
    each(lambda a, b: _least(*arguments, a, b), spans(len(samples.rows), 4 * thread_count()))
    return least


@kernel("contracted")
def _least(rows, columns, normals, least, begin, end):  # type: ignore[no-untyped-def]
    ny = rows.shape[1] - 1
    for z in range(begin, end):
        for y in range(ny):
            a, b = rows[z, y], rows[z, y + 1]
            for i in range(a, b):
                if i > a and columns[i - 1] == columns[i] - 1:
                    least[i] = min(least[i], _cosine(normals, i, i - 1))
                if i + 1 < b and columns[i + 1] == columns[i] + 1:
                    least[i] = min(least[i], _cosine(normals, i, i + 1))
            for dz, dy in ((-1, 0), (1, 0), (0, -1), (0, 1)):
                if 0 <= z + dz < len(rows) and 0 <= y + dy < ny:
                    j, last = rows[z + dz, y + dy], rows[z + dz, y + dy + 1]
                    for i in range(a, b):
                        while j < last and columns[j] < columns[i]:
                            j += 1
                        if j < last and columns[j] == columns[i]:
                            least[i] = min(least[i], _cosine(normals, i, j))


@kernel("contracted")
def _cosine(normals, i, j):  # type: ignore[no-untyped-def]
    return (
        normals[0, i] * normals[0, j]
        + normals[1, i] * normals[1, j]
        + normals[2, i] * normals[2, j]
    )
