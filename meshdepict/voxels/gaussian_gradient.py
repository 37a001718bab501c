"""Banded matrices along the three axes of a grid, compiled: everything, or chosen voxels only.

The slow axes are swept in whole rows, so that their loops run along memory; the fast axis comes
last, and only where a voxel wants a number.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count
from meshdepict.voxels.gaussian_bands import Band

__all__ = ["at_voxels", "dot", "normalise", "resample"]

# No reordering of sums: a grid in slabs must give the numbers of a whole one.

_CHUNK = 2048  # outputs whose running sums stay in the fastest cache


@kernel("contracted")
def _sweep(rows, start, weights, out, begin, end):  # type: ignore[no-untyped-def]
    """out[i] = Σ_t weights[t] rows[start + t, i] for i in [begin, end)."""
    taps = len(weights)
    for low in range(begin, end, _CHUNK):
        high = min(low + _CHUNK, end)
        for i in range(low, high):
            out[i] = 0
        t = 0
        while t + 4 <= taps:
            a, b, c, d = weights[t], weights[t + 1], weights[t + 2], weights[t + 3]
            p, q, r, s = (
                rows[start + t],
                rows[start + t + 1],
                rows[start + t + 2],
                rows[start + t + 3],
            )
            for i in range(low, high):
                out[i] += (a * p[i] + b * q[i]) + (c * r[i] + d * s[i])
            t += 4
        while t < taps:
            a, p = weights[t], rows[start + t]
            for i in range(low, high):
                out[i] += a * p[i]
            t += 1


@kernel("contracted")
def dot(line, start, weights):  # type: ignore[no-untyped-def]
    """Σ_t weights[t] line[start + t], in four running sums."""
    taps = len(weights)
    a = b = c = d = weights[0] * 0  # zero of the right type; the line may be empty at its ends
    t = 0
    while t + 4 <= taps:
        a += weights[t] * line[start + t]
        b += weights[t + 1] * line[start + t + 1]
        c += weights[t + 2] * line[start + t + 2]
        d += weights[t + 3] * line[start + t + 3]
        t += 4
    while t < taps:
        a += weights[t] * line[start + t]
        t += 1
    return (a + b) + (c + d)


def resample(block: NDArray[Any], bands: tuple[Band, Band, Band], out: NDArray[Any]) -> None:
    """Apply smoothing matrices (z, y, x) to a block, into (nz, ny, nx) `out`."""
    z, y, x = bands
    arguments = (
        block, z.start, z.weights[0], y.start, y.weights[0], x.start, x.weights[0], out,
    )  # fmt: skip
    each(lambda a, b: _resample(*arguments, a, b), spans(len(out), 4 * thread_count()))


@kernel("contracted")
def _resample(block, zs, zw, ys, yw, xs, xw, out, begin, end):  # type: ignore[no-untyped-def]
    nz, ny, nx = block.shape
    flat = block.reshape(nz, ny * nx)
    swept, line = np.empty(ny * nx, block.dtype), np.empty(nx, block.dtype)
    rows = swept.reshape(ny, nx)
    for z in range(begin, end):
        _sweep(flat, zs[z], zw[z], swept, 0, ny * nx)
        for y in range(len(ys)):
            _sweep(rows, ys[y], yw[y], line, 0, nx)
            for x in range(len(xs)):
                out[z, y, x] = dot(line, xs[x], xw[x])


def at_voxels(
    block: NDArray[Any],
    bands: tuple[Band, Band, Band],
    derivatives: tuple[tuple[int, int, int], ...],
    rows: NDArray[np.int64],
    columns: NDArray[np.int32],
    out: NDArray[Any],
) -> None:
    """Find derivatives of a smoothed block at chosen voxels.

    Parameters
    ----------
    block : (z, y, x) array
    bands : three Band
        Along z, y, x, from the block to voxels.
    derivatives : tuple of (order in z, order in y, order in x)
    rows : (nz, ny + 1) array of int
        Where the voxels of a row are in `columns`: of row (z, y) from rows[z, y] to rows[z, y + 1].
    columns : (n,) array of int
        Voxels along x, rising within a row.
    out : (len(derivatives), n) array
    """
    z, y, x = bands
    pairs = sorted({(a, b) for a, b, _ in derivatives})
    triples = [(pairs.index((a, b)), c) for a, b, c in derivatives]
    arguments = (
        block, z.start, z.weights, y.start, y.weights, x.start, x.weights,
        np.array(pairs), np.array(triples), rows, columns, out,
    )  # fmt: skip
    each(lambda a, b: _at_voxels(*arguments, a, b), spans(len(rows), 4 * thread_count()))


@kernel("contracted")
def _at_voxels(block, zs, zw, ys, yw, xs, xw, pairs, triples, rows, columns, out, begin, end):  # type: ignore[no-untyped-def]
    nz, ny, nx = block.shape
    flat = block.reshape(nz, ny * nx)
    swept = np.empty((len(zw), ny * nx), block.dtype)
    lines = np.empty((len(pairs), nx), block.dtype)
    ytaps, xtaps = yw.shape[2], xw.shape[2]
    for z in range(begin, end):
        first, last = -1, -1
        for y in range(len(ys)):
            if rows[z, y + 1] > rows[z, y]:
                first = y if first < 0 else first
                last = y
        if first < 0:
            continue
        low, high = ys[first] * nx, (ys[last] + ytaps) * nx
        for order in range(len(zw)):
            _sweep(flat, zs[z], zw[order, z], swept[order], low, high)
        for y in range(first, last + 1):
            a, b = rows[z, y], rows[z, y + 1]
            if a == b:
                continue
            left, right = xs[columns[a]], xs[columns[b - 1]] + xtaps
            for p in range(len(pairs)):
                plane = swept[pairs[p, 0]].reshape(ny, nx)
                _sweep(plane, ys[y], yw[pairs[p, 1], y], lines[p], left, right)
            for k in range(len(triples)):
                line, weights = lines[triples[k, 0]], xw[triples[k, 1]]
                for i in range(a, b):
                    x = columns[i]
                    out[k, i] = dot(line, xs[x], weights[x])


def normalise(
    gradients: NDArray[np.float32],
    matrix: NDArray[np.float64],
    floor: float,
    finer: NDArray[np.float32] | None,
    magnitudes: NDArray[np.float64] | None = None,
) -> None:
    """Turn gradients along the grid's axes into unit normals −∇f/‖∇f‖ in the world, in place.

    Parameters
    ----------
    gradients : (3, n) array
        In voxels (d/dx, d/dy, d/dz).
    matrix : (3, 3) array
        From these to the world.
    floor : float
        Below this length the normal is that of the next finer scale.
    finer : (3, n) array, optional
        That scale's normals; zero without it.
    magnitudes : (n,) array, optional
        Filled with the lengths.
    """
    nothing = np.empty((0, 0), np.float32), np.empty(0)
    arguments = (
        gradients, matrix, floor, nothing[0] if finer is None else finer,
        nothing[1] if magnitudes is None else magnitudes,
    )  # fmt: skip
    count = gradients.shape[1]
    pieces = thread_count() if count > 20_000 else 1
    each(lambda a, b: _normalise(*arguments, a, b), spans(count, pieces))


@kernel("contracted")
def _normalise(gradients, matrix, floor, finer, magnitudes, begin, end):  # type: ignore[no-untyped-def]
    for i in range(begin, end):
        a, b, c = gradients[0, i], gradients[1, i], gradients[2, i]
        x = matrix[0, 0] * a + matrix[0, 1] * b + matrix[0, 2] * c
        y = matrix[1, 0] * a + matrix[1, 1] * b + matrix[1, 2] * c
        z = matrix[2, 0] * a + matrix[2, 1] * b + matrix[2, 2] * c
        length = math.sqrt(x * x + y * y + z * z)
        if len(magnitudes) > 0:
            magnitudes[i] = length
        if length > floor:
            gradients[0, i], gradients[1, i], gradients[2, i] = (
                -x / length,
                -y / length,
                -z / length,
            )
        elif len(finer) > 0:
            gradients[0, i], gradients[1, i], gradients[2, i] = (
                finer[0, i],
                finer[1, i],
                finer[2, i],
            )
        else:
            gradients[0, i], gradients[1, i], gradients[2, i] = 0, 0, 0
