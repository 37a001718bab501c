"""Horizons of height fields: how high the land around stands, and what of the sky it leaves.

Heights are read along rays that are the same for every cell of a row, so whole rows are compared at
once with the rows that lie a step further.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.heights.map_rules import HORIZONS
from meshdepict.options import nearest
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["horizon_reach", "horizons", "open_angles", "sky_shares"]

Singles = NDArray[np.float32]
Floats = NDArray[np.float64]

_FINER = 3  # places a cell at which the toolbox looks which cell a ray is in
_ABYSS = -1e30  # stands where there is no height: never a horizon, and told by its slope
_UNSEEN = -1e12
_DEEPEST = math.atan(-1000.0)  # the toolbox's horizon where there is none
_ROWS = 16  # rows of a piece of work
_CHUNK = 1024  # cells whose horizons stay in the fastest cache
_SNAP = 1e-9  # of a cell: rounding of sines


class _Rays(NamedTuple):
    """What rays read: at each tap two cells, in proportion.

    ``first[d]`` … ``first[d + 1]`` are the taps of ray d; ``cells`` is (rows or 1, taps, 2, row and
    column) from the cell that looks; ``weights`` (rows or 1, taps, 2) is divided by the distance.
    """

    first: NDArray[np.int64]
    cells: NDArray[np.int64]
    weights: Floats


def sky_shares(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    steps: Floats,
    *,
    directions: int = 16,
    radius: float = 10.0,
    horizon: str = "lines",
) -> Singles:
    """Return the sky-view factor 1 − mean sin max(γ, 0), γ the horizon's height (Zakšek 2011).

    Parameters
    ----------
    z, valid, steps
        As for `horn.horn_slopes`.
    directions : int
        Number of rays, evenly round, the first to the east.
    radius : float
        How far they look, in cells, of the smaller step; at least to the next one.
    horizon : {"lines", "cells"}
        "lines": heights along straight lines, between cells in proportion. "cells": the cells that
        a line passes, where their centres are, as the Relief Visualization Toolbox has it; the
        border mirrors.

    Returns
    -------
    (rows, cols) array of float32
        In [0, 1]; 1 where nothing stands above, and where no height is known.

    Raises
    ------
    MeshdepictError
        For another horizon.
    """
    out = np.ones(z.shape, np.float32)
    _looked(_sky, z, valid, steps, directions, radius, horizon, 1.0, out)
    return out


def open_angles(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    steps: Floats,
    *,
    directions: int = 16,
    radius: float = 10.0,
    horizon: str = "lines",
    negative: bool = False,
) -> Singles:
    """Return the openness mean(90° − γ) in degrees, γ with its sign (Yokoyama et al. 2002).

    Parameters
    ----------
    z, valid, steps, directions, radius, horizon
        As for `sky_shares`.
    negative : bool
        Whether of −z: how open the ground is, seen from below.

    Returns
    -------
    (rows, cols) array of float32
        90 on a plane; 90 where no height is known. A ray on which there is no height counts as
        level.
    """
    out = np.full(z.shape, 90, np.float32)
    _looked(_open, z, valid, steps, directions, radius, horizon, -1.0 if negative else 1.0, out)
    return out


def horizons(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    steps: Floats,
    *,
    directions: int = 16,
    radius: float = 10.0,
    horizon: str = "lines",
) -> Singles:
    """Return tan γ of every ray, (directions, rows, cols); −1000 where it meets no height."""
    out = np.full((directions, *z.shape), -1000, np.float32)
    _looked(_all, z, valid, steps, directions, radius, horizon, 1.0, out)
    return out


def horizon_reach(radius: float) -> int:
    """Return how many rows and columns beyond a window its horizons need."""
    return max(1, math.ceil(radius))


def _looked(
    look: Any, z: NDArray[Any], valid: NDArray[np.bool_] | None, steps: Floats,
    directions: int, radius: float, horizon: str, sign: float, out: Singles,
) -> None:  # fmt: skip
    """Run a kernel over all rows, in the precision of the heights."""
    if horizon not in HORIZONS:
        raise MeshdepictError(
            f"horizon={horizon!r} is not one of {', '.join(HORIZONS)}{nearest(horizon, HORIZONS)}"
        )
    rays_of = _cell_rays if horizon == "cells" else _line_rays
    same = rays_of(steps, directions, radius) if len(steps) == 1 else None
    reach = horizon_reach(radius)
    ground = _padded(z, valid, reach, sign, mirror=horizon == "cells")
    deepest = np.float32(_DEEPEST if horizon == "cells" else 0)

    def work(begin: int, end: int) -> None:
        first, cells, weights = same or rays_of(steps[begin:end], directions, radius)
        best = np.empty(_CHUNK, ground.dtype)
        look(
            ground[begin : end + 2 * reach], reach, first, cells, weights.astype(ground.dtype),
            deepest, best, out[..., begin:end, :],
        )  # fmt: skip

    each(work, spans(len(z), max(thread_count(), len(z) // _ROWS)))
    if valid is not None:
        out[..., ~valid] = {_sky: 1, _open: 90, _all: -1000}[look]


def _padded(
    z: NDArray[Any], valid: NDArray[np.bool_] | None, reach: int, sign: float, *, mirror: bool
) -> NDArray[Any]:
    """Return heights ± with a rim as wide as rays reach."""
    rows, cols = z.shape
    ground = np.full((rows + 2 * reach, cols + 2 * reach), _ABYSS, z.dtype)
    inner = ground[reach : reach + rows, reach : reach + cols]
    np.multiply(z, z.dtype.type(sign), out=inner)
    if valid is not None:
        inner[~valid] = _ABYSS
    if mirror:
        down, across = (_reflected(count, reach) for count in (rows, cols))
        ground = inner[np.ix_(down, across)]
    return ground


def _reflected(count: int, reach: int) -> NDArray[np.int64]:
    """Return which cell stands at −reach … count + reach − 1: −1 is 1, −2 is 2, …."""
    if count == 1:
        return np.zeros(2 * reach + 1, np.int64)
    index = np.abs(np.arange(-reach, count + reach)) % (2 * count - 2)
    return np.minimum(index, 2 * count - 2 - index)


# --- rays ----------------------------------------------------------------------------------------


def _line_rays(steps: Floats, directions: int, radius: float) -> _Rays:
    """Return taps where straight lines cross rows (or columns, whichever they cross more often)."""
    turn = 2 * np.pi * np.arange(directions) / directions
    towards = np.stack([np.cos(turn), np.sin(turn)])  # (2, directions): east, north
    sizes = np.linalg.norm(steps, axis=1)  # (rows or 1, 2)
    # In cells (rows or 1, 2: column and row, directions), scaled so that the larger is one.
    course = np.linalg.inv(steps) @ towards
    course[np.abs(course) < _SNAP * np.abs(course).max(axis=1, keepdims=True)] = 0
    course /= np.abs(course).max(axis=1, keepdims=True)
    length = np.linalg.norm(steps @ course, axis=1)  # metres a tap
    far = radius * sizes.min(axis=1)[:, None]
    counts = np.maximum(1, np.floor(far / length * (1 + _SNAP))).astype(np.int64)
    most = counts.max(axis=0)
    first = np.concatenate(([0], np.cumsum(most)))
    cells = np.zeros((len(steps), first[-1], 2, 2), np.int64)
    weights = np.zeros((len(steps), first[-1], 2))
    for d in range(directions):
        taps = slice(first[d], first[d + 1])
        # Rows of cells that are wider look less often; the rest of their taps repeats the last.
        tap = np.minimum(np.arange(1, most[d] + 1), counts[:, d, None])
        place = course[:, None, ::-1, d] * tap[..., None]  # row, column
        place = np.where(np.abs(place - np.rint(place)) < _SNAP, np.rint(place), place)
        low = np.floor(place)
        share = (place - low).sum(axis=2)  # one of the two is whole
        cells[:, taps, 0] = low
        cells[:, taps, 1] = np.ceil(place)
        distance = tap * length[:, d, None]
        weights[:, taps, 0], weights[:, taps, 1] = (1 - share) / distance, share / distance
    return _Rays(first, cells, weights)


def _cell_rays(steps: Floats, directions: int, radius: float) -> _Rays:
    """Return the cells that lines pass, as the toolbox finds them: sorted, each once."""
    far = max(1, round(radius))
    along = 1 + np.arange((far - 1) * _FINER + 1) / _FINER
    first, offsets = [0], []
    for d in range(directions):
        angle = 2 * np.pi / directions * d
        places = np.rint(np.outer(along, [math.cos(angle), math.sin(angle)])).astype(np.int64)
        places = np.unique(places, axis=0)
        offsets.append(-places)
        first.append(first[-1] + len(places))
    cells = np.concatenate(offsets)
    metres = np.linalg.norm(
        np.einsum("rij,tj->rti", steps, cells[:, ::-1].astype(np.float64)), axis=2
    )
    weights = np.stack([1 / metres, np.zeros_like(metres)], axis=2)
    both = np.repeat(cells[None, :, None], 2, axis=2)
    return _Rays(np.array(first), np.broadcast_to(both, (len(steps), *both.shape[1:])), weights)


# --- kernels -------------------------------------------------------------------------------------


@kernel("contracted")
def _raise(best, ground, row, low, high, reach, cells, weights, begin, end):  # type: ignore[no-untyped-def]
    """Find the largest slopes from the cells low … high of a row to the taps of a ray."""
    here = ground[row + reach, reach + low : reach + high]
    count = high - low
    for i in range(count):
        best[i] = _ABYSS
    for t in range(begin, end):
        a, b = weights[t, 0], weights[t, 1]
        r, c = row + reach + cells[t, 0, 0], reach + low + cells[t, 0, 1]
        p = ground[r, c : c + count]
        if b == 0:
            for i in range(count):
                slope = a * (p[i] - here[i])
                best[i] = slope if slope > best[i] else best[i]
            continue
        r, c = row + reach + cells[t, 1, 0], reach + low + cells[t, 1, 1]
        q = ground[r, c : c + count]
        for i in range(count):
            slope = a * (p[i] - here[i]) + b * (q[i] - here[i])
            best[i] = slope if slope > best[i] else best[i]


@kernel("contracted")
def _sky(ground, reach, first, cells, weights, deepest, best, out):  # type: ignore[no-untyped-def]
    rays, columns, zero, one = len(first) - 1, out.shape[1], np.float32(0), np.float32(1)
    share = one / np.float32(rays)
    for row in range(out.shape[-2]):
        line = min(row, len(weights) - 1)
        for low in range(0, columns, _CHUNK):
            high = min(low + _CHUNK, columns)
            target = out[row, low:high]
            for ray in range(rays):
                a, b = first[ray], first[ray + 1]
                _raise(best, ground, row, low, high, reach, cells[line], weights[line], a, b)
                for i in range(high - low):
                    slope = np.float32(best[i]) if best[i] > zero else zero
                    target[i] -= share * slope / np.float32(math.sqrt(one + slope * slope))


@kernel("contracted")
def _open(ground, reach, first, cells, weights, deepest, best, out):  # type: ignore[no-untyped-def]
    rays, columns = len(first) - 1, out.shape[1]
    share = np.float32(180 / math.pi / rays)
    for row in range(out.shape[-2]):
        line = min(row, len(weights) - 1)
        for low in range(0, columns, _CHUNK):
            high = min(low + _CHUNK, columns)
            target = out[row, low:high]
            for ray in range(rays):
                a, b = first[ray], first[ray + 1]
                _raise(best, ground, row, low, high, reach, cells[line], weights[line], a, b)
                for i in range(high - low):
                    angle = _arctangent(np.float32(best[i]))
                    target[i] -= share * (angle if best[i] > np.float32(_UNSEEN) else deepest)


@kernel("contracted")
def _all(ground, reach, first, cells, weights, deepest, best, out):  # type: ignore[no-untyped-def]
    rays, columns = len(first) - 1, out.shape[2]
    for row in range(out.shape[-2]):
        line = min(row, len(weights) - 1)
        for low in range(0, columns, _CHUNK):
            high = min(low + _CHUNK, columns)
            for ray in range(rays):
                a, b = first[ray], first[ray + 1]
                _raise(best, ground, row, low, high, reach, cells[line], weights[line], a, b)
                for i in range(high - low):
                    if best[i] > np.float32(_UNSEEN):
                        out[ray, row, low + i] = best[i]


@kernel("contracted", inline=True)
def _arctangent(x):  # type: ignore[no-untyped-def]
    """Arctangent by a polynomial of x² in [0, 1], where the compiler can keep eight in a row."""
    one = np.float32(1)
    size = abs(x)
    small = size if size < one else one / size
    t = small * small
    p = np.float32(-0.004559791986139317)
    p = p * t + np.float32(0.02378051859662378)
    p = p * t + np.float32(-0.0588297531413815)
    p = p * t + np.float32(0.09868865457940856)
    p = p * t + np.float32(-0.14003290184552686)
    p = p * t + np.float32(0.19966961829568286)
    p = p * t + np.float32(-0.3333181265562583)
    p = (p * t + np.float32(0.9999998819964927)) * small
    p = p if size < one else np.float32(math.pi / 2) - p
    return p if x > np.float32(0) else -p
