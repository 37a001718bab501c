"""Gaussian sums over points by adding up neighbours: exact but for what lies beyond a radius.

The points are sorted into cubic cells. For each cell the sources within reach are copied into
contiguous batches that the cache holds, with coordinates relative to the cell (so that float32
suffices), and every target of the cell runs over them. Both inner loops vectorise: the Gaussian
by a polynomial for 2^t, the sums five channels at a time.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["CHANNEL_BLOCK", "SINGLE_FLOOR", "direct_sums", "exact_sums"]

SINGLE_FLOOR = 2e-6  # relative error that single precision reaches safely in these sums
CHANNEL_BLOCK = 5  # channels added up together: as many as the registers hold

_BATCH = 1024  # sources at a time: their coordinates, channels and weights stay in the cache
_PER_CELL = 16  # targets that share one list of sources: what gathering the list is spread over
_FEW = 100  # targets that are quicker compared with every source than sorted into cells

# In these units of the width the Gaussian exp(−d²/2) is 2^(−d²).
_UNIT = math.sqrt(2 * math.log(2.0))
_TAYLOR = [math.log(2.0) ** k / math.factorial(k) for k in range(1, 7)]


def exact_sums(
    points: NDArray[np.float64], channels: NDArray[np.float64], width: float
) -> NDArray[np.float64]:
    """Return Σ_j channels_j exp(−‖x_i − x_j‖² / 2 width²) by its definition, in O(n²).

    The slow readable twin: the oracle of every fast way in the tests.

    Parameters
    ----------
    points : (n, 3) array
    channels : (c, n) array
    width : float

    Returns
    -------
    (c, n) array
    """
    sums = np.empty((len(channels), len(points)))
    for i, point in enumerate(points):
        squared = ((points - point) ** 2).sum(axis=1)
        sums[:, i] = channels @ np.exp(-0.5 * squared / width**2)
    return sums


def direct_sums(
    xyz: NDArray[np.float64],
    channels: NDArray[Any],
    radius: float,
    targets: NDArray[np.bool_] | None = None,
) -> NDArray[Any]:
    """Sum Gaussians of width one over all sources within ``radius`` (and some beyond).

    Parameters
    ----------
    xyz : (3, n) array
        Coordinates in units of the width.
    channels : (c, n) array, float32 or float64
        Its type is the precision; c must be a multiple of `CHANNEL_BLOCK`.
    radius : float
        In units of the width.
    targets : (n,) array of bool, optional
        Where the sums are wanted; elsewhere they come out as zero.

    Returns
    -------
    (c, n) array
    """
    count = xyz.shape[1]
    double = channels.dtype == np.float64
    constants = np.array([-1000.0 if double else -120.0, 0.5, 0.125, *_TAYLOR, 1.0], channels.dtype)
    bits, shift = (np.int64, 52) if double else (np.int32, 23)
    if targets is not None and (few := np.flatnonzero(targets)).size <= _FEW:
        sums = np.zeros_like(channels)
        scaled = xyz / _UNIT
        each(
            lambda a, b: _sum_few(scaled, channels, few[a:b], constants, bits, shift, sums),
            spans(len(few), thread_count()),
        )
        return sums
    low, high = xyz.min(axis=1), xyz.max(axis=1)
    side = _cell_side(high - low, count, radius)
    index = ((xyz - low[:, None]) / side).astype(np.int64)
    shape = index.max(axis=1) + 1
    keys = (index[2] * shape[1] + index[1]) * shape[0] + index[0]
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    starts = np.flatnonzero(np.concatenate(([True], keys[1:] != keys[:-1], [True])))
    cells = keys[starts[:-1]]
    scaled = (np.take(xyz, order, axis=1) - low[:, None]) / _UNIT
    values = np.take(channels, order, axis=1)
    wanted = np.ones(count, np.bool_) if targets is None else targets[order]
    sums = np.zeros_like(values)
    grid = (cells, starts, shape, side / _UNIT, radius / _UNIT)

    def some_cells(first: int, last: int) -> None:
        _sum_cells(scaled, values, wanted, *grid, constants, bits, shift, first, last, sums)

    each(some_cells, spans(len(cells), 16 * thread_count()))
    result = np.empty_like(sums)
    result[:, order] = sums
    return result


def _cell_side(extent: NDArray[np.float64], count: int, radius: float) -> float:
    """Return a cell size small against the radius, yet with a handful of points in a cell."""
    # Taking the points to lie on a surface about as large as the bounding box's.
    x, y, z = extent
    side = math.sqrt(2 * (x * y + y * z + z * x) / count * _PER_CELL)
    # Keys stay within 63 bits whatever the extent.
    return max(min(max(side, radius / 6), radius), float(extent.max()) / 2e6)


@kernel("free")
def _gaussians(x, y, z, sources, count, constants, bits, shift, weights):  # type: ignore[no-untyped-def]
    """Fill weights[j] with 2^(−‖source_j − (x, y, z)‖²).

    2^t = 2^k 2^f with k = round(t): k goes straight into the exponent's bits, and 2^f is
    (2^(f/8))^8 by a Taylor polynomial, whose error is below 1e-12.
    """
    lowest, half, eighth, one = constants[0], constants[1], constants[2], constants[9]
    c1, c2, c3, c4, c5, c6 = (
        constants[3], constants[4], constants[5], constants[6], constants[7], constants[8],
    )  # fmt: skip
    xs, ys, zs = sources[0], sources[1], sources[2]
    exponent = weights.view(bits)
    for j in range(count):
        dx, dy, dz = xs[j] - x, ys[j] - y, zs[j] - z
        t = max(-(dx * dx + dy * dy + dz * dz), lowest)
        k = np.int32(t - half)
        f = (t - weights.dtype.type(k)) * eighth
        p = (((((c6 * f + c5) * f + c4) * f + c3) * f + c2) * f + c1) * f + one
        p = p * p
        p = p * p
        weights[j] = p * p
        exponent[j] = exponent[j] + (bits(k) << bits(shift))


@kernel("free")
def _add_five(weights, values, first, count, sums, i):  # type: ignore[no-untyped-def]
    """Add Σ_j weights_j values_j to five channels of target i."""
    s0 = s1 = s2 = s3 = s4 = weights.dtype.type(0)
    v0, v1, v2, v3, v4 = (
        values[first],
        values[first + 1],
        values[first + 2],
        values[first + 3],
        values[first + 4],
    )
    for j in range(count):
        w = weights[j]
        s0 += w * v0[j]
        s1 += w * v1[j]
        s2 += w * v2[j]
        s3 += w * v3[j]
        s4 += w * v4[j]
    sums[first, i] += s0
    sums[first + 1, i] += s1
    sums[first + 2, i] += s2
    sums[first + 3, i] += s3
    sums[first + 4, i] += s4


@kernel("free")
def _sum_few(xyz, values, few, constants, bits, shift, sums):  # type: ignore[no-untyped-def]
    """Compute the sums of a few points over all sources."""
    channels, count = values.shape
    sources = np.empty((3, _BATCH), values.dtype)
    weights = np.empty(_BATCH, values.dtype)
    zero = values.dtype.type(0)
    for first in range(0, count, _BATCH):
        size = min(_BATCH, count - first)
        batch = values[:, first : first + size]
        for i in few:
            for axis in range(3):
                for j in range(size):
                    sources[axis, j] = xyz[axis, first + j] - xyz[axis, i]
            _gaussians(zero, zero, zero, sources, size, constants, bits, shift, weights)
            for k in range(0, channels, 5):
                _add_five(weights, batch, k, size, sums, i)


@kernel("free")
def _reach(cells, shape, side, radius, cell, rows):  # type: ignore[no-untyped-def]
    """List the runs of cells [first, last) within ``radius`` of a cell, one run per (y, z) row."""
    ix, iy, iz = cell % shape[0], (cell // shape[0]) % shape[1], cell // (shape[0] * shape[1])
    far = math.ceil(radius / side)
    found = 0
    for jz in range(max(iz - far, 0), min(iz + far + 1, shape[2])):
        dz = max(abs(jz - iz) - 1, 0) * side
        for jy in range(max(iy - far, 0), min(iy + far + 1, shape[1])):
            dy = max(abs(jy - iy) - 1, 0) * side
            rest = radius * radius - dy * dy - dz * dz
            if rest >= 0:
                wide = int(math.sqrt(rest) / side) + 1
                row = (jz * shape[1] + jy) * shape[0]
                first = np.searchsorted(cells, row + max(ix - wide, 0))
                last = np.searchsorted(cells, row + min(ix + wide + 1, shape[0]))
                if last > first:
                    rows[found, 0], rows[found, 1] = first, last
                    found += 1
    return found


@kernel("free")
def _ball(xyz, wanted, begin, end, ball):  # type: ignore[no-untyped-def]
    """Put centre and radius of a ball round the wanted points [begin, end) into ``ball``."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for axis in range(3):
        for i in range(begin, end):
            if wanted[i]:
                low[axis] = min(low[axis], xyz[axis, i])
                high[axis] = max(high[axis], xyz[axis, i])
        ball[axis] = (low[axis] + high[axis]) / 2
    ball[3] = 0.0
    for i in range(begin, end):
        if wanted[i]:
            x, y, z = xyz[0, i] - ball[0], xyz[1, i] - ball[1], xyz[2, i] - ball[2]
            ball[3] = max(ball[3], math.sqrt(x * x + y * y + z * z))


@kernel("free")
def _sum_cells(  # type: ignore[no-untyped-def]
    xyz,
    values,
    wanted,
    cells,
    starts,
    shape,
    side,
    radius,
    constants,
    bits,
    shift,
    begin,
    end,
    sums,
):
    """Compute the sums of all wanted points of the cells [begin, end)."""
    of = values.dtype.type
    channels = len(values)
    far = math.ceil(radius / side)
    rows = np.empty(((2 * far + 1) ** 2, 2), np.int64)
    ball = np.empty(4)
    near = np.empty(_BATCH, np.int64)
    batch = np.empty((channels, _BATCH), values.dtype)
    sources = np.empty((3, _BATCH), values.dtype)
    weights = np.empty(_BATCH, values.dtype)
    for c in range(begin, end):
        any_wanted = False
        for i in range(starts[c], starts[c + 1]):
            any_wanted |= wanted[i]
        if not any_wanted:
            continue
        _ball(xyz, wanted, starts[c], starts[c + 1], ball)
        x, y, z = ball[0], ball[1], ball[2]
        limit = (radius + ball[3]) ** 2
        found = _reach(cells, shape, side, radius, cells[c], rows)
        count = 0
        for r in range(found):
            first, last = starts[rows[r, 0]], starts[rows[r, 1]]
            for j in range(first, last):
                dx, dy, dz = xyz[0, j] - x, xyz[1, j] - y, xyz[2, j] - z
                if dx * dx + dy * dy + dz * dz <= limit:
                    sources[0, count], sources[1, count], sources[2, count] = of(dx), of(dy), of(dz)
                    near[count] = j
                    count += 1
                if count == _BATCH or (count > 0 and r == found - 1 and j == last - 1):
                    for k in range(channels):
                        for b in range(count):
                            batch[k, b] = values[k, near[b]]
                    for i in range(starts[c], starts[c + 1]):
                        if wanted[i]:
                            _gaussians(
                                of(xyz[0, i] - x), of(xyz[1, i] - y), of(xyz[2, i] - z),
                                sources, count, constants, bits, shift, weights,
                            )  # fmt: skip
                            for k in range(0, channels, 5):
                                _add_five(weights, batch, k, count, sums, i)
                    count = 0
