"""Gaussians over rasters, of any width at a cost that doesn't grow with it.

A wide Gaussian is two: one that is evaluated at every m-th cell alone, and one that fills in all
cells from these, whose variances add. With both as wide as here what aliases is below 2e-7 of the
whole. Narrow ones are applied as they are. Borders mirror. All support is finite, and a cell's sum
runs in the same order wherever a window begins, as long as that is at a multiple of `alignment`: so
windows give the numbers of the whole, bit for bit.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count
from meshdepict.voxels.gaussian_gradient import dot

__all__ = ["alignment", "blurred", "halo", "reach_of"]

Floats = NDArray[np.float64]

# In coarse cells: the widths of the two Gaussians, the first at least.
_DOWN, _UP = 2.0, 1.0
_WIDEST = 2.0  # times the axis: from here up all that varies has decayed to 3e-9
_DOUBLE = 1e-5  # a tolerance below which single precision doesn't do


class _Steps(NamedTuple):
    """One pass along an axis: output j takes inputs start[j], start[j] + 1, … by weights[phase[j]].

    ``weights`` is (rows or 1, phases, taps): along rows they may differ from row to row.
    """

    start: NDArray[np.int64]
    phase: NDArray[np.int64]
    weights: Floats


def blurred(
    block: NDArray[Any],
    down: float,
    across: Floats,
    *,
    tolerance: float,
    narrowest: float | None = None,
) -> NDArray[Any]:
    """Return channels of a raster under a Gaussian.

    Parameters
    ----------
    block : (channels, rows, columns) array
    down : float
        Standard deviation in rows.
    across : (rows or 1,) array
        In columns, for all rows or each of them.
    tolerance : float
        Share of the Gaussian that may be left out.
    narrowest : float, optional
        In columns, of all rows of the raster that this is a window of; of these unless given.
    """
    reach = reach_of(tolerance)
    least = float(across.min()) if narrowest is None else narrowest
    values = np.ascontiguousarray(block, np.float32 if tolerance >= _DOUBLE else np.float64)
    rows, columns = values.shape[1:]
    first, second = _passes(rows, np.array([down]), reach, down)
    values = _vertical(values, first)
    middle = np.clip(_middles(first, rows), 0, rows - 1)
    for step in _passes(columns, across[middle] if len(across) > 1 else across, reach, least):
        if step is not None:
            values = _horizontal(values, step)
    return values if second is None else _vertical(values, second)


def reach_of(tolerance: float) -> float:
    """Return where a Gaussian is cut off, in widths."""
    return math.sqrt(2 * math.log(10 / tolerance))


def alignment(width: float) -> int:
    """Return the number of cells, a power of two, at whose multiples a window may begin."""
    return _coarser(width)


def halo(width: float, tolerance: float, least: float | None = None) -> int:
    """Return how many cells around a window its sums take.

    Parameters
    ----------
    width : float
        In cells; of rows that differ the widest.
    tolerance : float
    least : float, optional
        Of rows that differ the narrowest.
    """
    reach, m = reach_of(tolerance), _coarser(width if least is None else least)
    beyond = _radius(reach * width + 1) + 1
    return beyond if m == 1 else beyond + m * (math.ceil(reach * _UP) + 2)


def _coarser(width: float) -> int:
    """Return m: how many cells are one for a width in cells."""
    most = width / math.hypot(_DOWN, _UP)
    return 1 if most < 2 else 1 << math.floor(math.log2(most))


def _passes(count: int, widths: Floats, reach: float, least: float) -> tuple[_Steps, _Steps | None]:
    """Return the one pass, or the two, of Gaussians (rows or 1,) along an axis of `count` cells."""
    widths = np.minimum(widths, _WIDEST * count)
    m = _coarser(min(least, _WIDEST * count))
    if m == 1:
        radius = _radius(reach * float(widths.max()))
        start = np.arange(count, dtype=np.int64) - radius
        offsets = np.arange(-radius, radius + 1.0)[None]
        return _Steps(start, np.zeros(count, np.int64), _weights(offsets, widths, reach)), None
    spare = math.ceil(reach * _UP) + 1  # coarse cells beyond the border: mirrored, too
    coarse = np.arange(-spare, -(-count // m) + spare, dtype=np.int64)
    narrow = np.sqrt(widths**2 - (_UP * m) ** 2)
    radius = _radius(reach * float(narrow.max()) + 1)
    middle = (m - 1) / 2  # of a coarse cell, in fine ones
    offsets = np.arange(-radius, radius + 1.0)[None] + 0.5  # m is even
    begin = coarse * m + math.ceil(middle) - radius
    down = _Steps(begin, np.zeros(len(coarse), np.int64), _weights(offsets, narrow, reach))
    taps = np.arange(-spare + 1, spare)
    phases = np.arange(m)
    # The coarse cell that holds the fine one, and where its middle lies, in coarse cells.
    inside = (phases - middle) / m
    weights = _weights(taps[None] - inside[:, None], np.array([_UP]), reach)
    fine = np.arange(count, dtype=np.int64)
    return down, _Steps(fine // m + taps[0] + spare, fine % m, weights)


def _radius(reach: float) -> int:
    """Return how many cells either side are summed: a multiple of four, as sums run.

    A row whose Gaussian is narrower than others' has zeros there, and the same sum.
    """
    return max(4, 4 * math.ceil(reach / 4))


def _weights(offsets: Floats, widths: Floats, reach: float) -> Floats:
    """Return Gaussians (rows, phases, taps) at offsets (phases, taps), each of the sum 1."""
    widths = np.maximum(widths, 0.02)[:, None, None]
    scaled = offsets[None] / widths
    weights = np.where(np.abs(offsets) <= reach * widths + 1, np.exp(-0.5 * scaled**2), 0)
    found: Floats = weights / weights.sum(axis=2, keepdims=True)
    return found


def _middles(step: _Steps, rows: int) -> NDArray[np.int64]:
    """Return the row that each output of a pass lies at."""
    return step.start + step.weights.shape[2] // 2 if len(step.start) != rows else np.arange(rows)


def _mirrored(count: int, first: int, last: int) -> NDArray[np.int64]:
    """Return which of `count` cells stands at each of first … last: −1 is 0, −2 is 1, …."""
    index = np.arange(first, last + 1) % (2 * count)
    return np.where(index < count, index, 2 * count - 1 - index)


def _vertical(values: NDArray[Any], step: _Steps) -> NDArray[Any]:
    out = np.empty((len(values), len(step.start), values.shape[2]), values.dtype)
    weights = step.weights[0].astype(values.dtype)
    taps = weights.shape[1]
    low = int(step.start.min())
    place = _mirrored(values.shape[1], low, int(step.start.max()) + taps - 1)
    start = step.start - low
    pieces = 4 * thread_count() if out.size > 50_000 else 1
    each(
        lambda a, b: _sweep_rows(values, place, start, step.phase, weights, out, a, b),
        spans(len(start), pieces),
    )
    return out


def _horizontal(values: NDArray[Any], step: _Steps) -> NDArray[Any]:
    out = np.empty((*values.shape[:2], len(step.start)), values.dtype)
    weights = step.weights.astype(values.dtype)
    taps = weights.shape[2]
    low = int(step.start.min())
    place = _mirrored(values.shape[2], low, int(step.start.max()) + taps - 1)
    start = step.start - low
    work = _sweep_line if weights.shape[1] == 1 and (np.diff(start) == 1).all() else _dot_line
    pieces = 4 * thread_count() if out.size > 50_000 else 1
    each(
        lambda a, b: work(values, place, start, step.phase, weights, out, a, b),
        spans(values.shape[1], pieces),
    )
    return out


_CHUNK = 4096  # numbers whose running sums stay in the fastest cache


@kernel("contracted")
def _sweep_rows(values, place, start, phase, weights, out, begin, end):  # type: ignore[no-untyped-def]
    """out[c, j] = Σ_t weights[phase[j], t] · values[c, place[start[j] + t]]."""
    taps, columns = weights.shape[1], values.shape[2]
    for c in range(len(values)):
        for j in range(begin, end):
            w, at = weights[phase[j]], start[j]
            for low in range(0, columns, _CHUNK):
                high = min(low + _CHUNK, columns)
                target = out[c, j, low:high]
                target[:] = 0
                t = 0
                while t + 4 <= taps:
                    p, q = (
                        values[c, place[at + t], low:high],
                        values[c, place[at + t + 1], low:high],
                    )
                    r, s = (
                        values[c, place[at + t + 2], low:high],
                        values[c, place[at + t + 3], low:high],
                    )
                    a, b, d, e = w[t], w[t + 1], w[t + 2], w[t + 3]
                    for i in range(high - low):
                        target[i] += (a * p[i] + b * q[i]) + (d * r[i] + e * s[i])
                    t += 4
                while t < taps:
                    a, p = w[t], values[c, place[at + t], low:high]
                    for i in range(high - low):
                        target[i] += a * p[i]
                    t += 1


@kernel("contracted")
def _sweep_line(values, place, start, phase, weights, out, begin, end):  # type: ignore[no-untyped-def]
    """out[c, r, j] = Σ_t weights[r, 0, t] · line[j + t], line: a row with its mirrored ends."""
    taps, count = weights.shape[2], out.shape[2]
    line = np.empty(len(place), values.dtype)
    for c in range(len(values)):
        for r in range(begin, end):
            w = weights[min(r, len(weights) - 1), 0]
            for i in range(len(place)):
                line[i] = values[c, r, place[i]]
            for low in range(0, count, _CHUNK):
                high = min(low + _CHUNK, count)
                target = out[c, r, low:high]
                target[:] = 0
                t = 0
                while t + 4 <= taps:
                    p, q = line[low + t : high + t], line[low + t + 1 : high + t + 1]
                    u, v = line[low + t + 2 : high + t + 2], line[low + t + 3 : high + t + 3]
                    a, b, d, e = w[t], w[t + 1], w[t + 2], w[t + 3]
                    for i in range(high - low):
                        target[i] += (a * p[i] + b * q[i]) + (d * u[i] + e * v[i])
                    t += 4
                while t < taps:
                    a, p = w[t], line[low + t : high + t]
                    for i in range(high - low):
                        target[i] += a * p[i]
                    t += 1


@kernel("contracted")
def _dot_line(values, place, start, phase, weights, out, begin, end):  # type: ignore[no-untyped-def]
    """out[c, r, j] = Σ_t weights[r, phase[j], t] · line[start[j] + t]."""
    line = np.empty(len(place), values.dtype)
    for c in range(len(values)):
        for r in range(begin, end):
            for i in range(len(place)):
                line[i] = values[c, r, place[i]]
            row = weights[min(r, len(weights) - 1)]
            for j in range(len(start)):
                out[c, r, j] = dot(line, start[j], row[phase[j]])
