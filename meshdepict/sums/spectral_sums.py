"""Gaussian sums over points in frequency space: the cost does not grow with the width.

A Gaussian is nearly band-limited. So: the points' Fourier coefficients up to the cut-off (a
non-uniform FFT of type 1), times the Gaussian's transform, evaluated at the targets (type 2).
Real channels travel in pairs, one as the real and one as the imaginary part: the Gaussian is real
and even and keeps them apart. A surface that is large against the width is cut into tiles, each
with the sources of a margin round it, wherever the smaller transforms cost less than the margins.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, spans, thread_count

__all__ = ["SINGLE_FLOOR", "Tile", "least_cost", "plan_tiles", "planned_seconds", "spectral_sums"]

SINGLE_FLOOR = 5e-6  # error, relative to the largest mass, that single precision reaches here

# Seconds of one core, measured with finufft 2.5 in single precision by scripts/cost_constants.py:
# a point and transform, for each node of the fine grid that it is spread to; a cell of the fine
# grid and transform, as long as the cache holds the grid and beyond. Double precision costs more.
_SPREAD_SECONDS = 0.3e-9
_FFT_SECONDS = 10e-9
_CACHED_CELLS = 3e6
_UNCACHED = 4
_DOUBLE = 1.5
# The fine grid is 2 or 1.25 times finer than the frequencies ask for: the second has a quarter of
# the cells, but spreads points wider, and reaches no smaller errors than this.
_COARSE_ERROR = 1e-8
_SAMPLE = 50_000  # points that planning looks at


@dataclass(frozen=True)
class Tile:
    """Targets and the sources that matter to them, as indices into the points."""

    targets: NDArray[np.int64]
    sources: NDArray[np.int64]


def spectral_sums(
    xyz: NDArray[np.float64],
    channels: NDArray[Any],
    error: float,
    tiles: list[Tile],
    done: Callable[[float], None] | None = None,
) -> NDArray[Any]:
    """Sum Gaussians of width one at the targets of all tiles.

    Parameters
    ----------
    xyz : (3, n) array
        Coordinates in units of the width.
    channels : (c, n) array, float32 or float64
        c even. Channel 0 is the mass. Its type is the precision.
    error : float
        Largest error of a sum, relative to the largest sum of channel 0 anywhere.
    tiles : list of Tile
        From `plan_tiles` with the same coordinates and error.
    done : callable, optional
        Called with shares of the work that are finished.

    Returns
    -------
    (c, n) array
        Zero where no tile has a target.
    """
    sums = np.zeros_like(channels)
    pairs = len(channels) // 2
    # finufft's own threads gain little on grids this small: few tiles are cut by channels instead.
    cuts = spans(pairs, 1 if len(tiles) >= 4 * thread_count() else thread_count())

    def one(tile: Tile, first: int, last: int) -> None:
        rows = slice(2 * first, 2 * last)
        sums[rows, tile.targets] = _tile_sums(xyz, channels[rows], error, tile)

    pieces = [(tile, *cut) for tile in tiles for cut in cuts]
    each(one, pieces, done and (lambda _: done(1 / len(pieces))))
    return sums


def plan_tiles(
    xyz: NDArray[np.float64],
    error: float,
    pairs: int,
    targets: NDArray[np.bool_] | None = None,
) -> tuple[list[Tile], float]:
    """Halve the targets' box along its longest side wherever that is expected to save time.

    Parameters
    ----------
    xyz : (3, n) array
        Coordinates in units of the width.
    error : float
        As for `spectral_sums`.
    pairs : int
        Complex transforms at each point: half the number of channels.
    targets : (n,) array of bool, optional
        All points unless given.

    Returns
    -------
    list of Tile
    float
        The estimated core-seconds of `spectral_sums` with them.
    """
    everything = np.arange(xyz.shape[1])
    wanted = everything if targets is None else np.flatnonzero(targets)
    if len(wanted) == 0:
        return [], 0.0
    cuts, cost = _cuts(xyz, error, pairs, wanted)
    return _dealt(xyz, error, cuts, Tile(wanted, everything)), cost


def planned_seconds(xyz: NDArray[np.float64], error: float, pairs: int) -> float:
    """Return the core-seconds of the tiles that `plan_tiles` would make for all points."""
    return _cuts(xyz, error, pairs, np.arange(xyz.shape[1]))[1]


def _cuts(
    xyz: NDArray[np.float64], error: float, pairs: int, wanted: NDArray[np.intp]
) -> tuple[_Cut | None, float]:
    """Return the cheapest cuts of the points wanted, and their cost."""
    # A sample tells where to cut; the points themselves are then dealt out along those cuts.
    t, s = max(1, len(wanted) // _SAMPLE), max(1, xyz.shape[1] // _SAMPLE)
    planning = _Planning(error, pairs, t, s)
    return planning.best(np.take(xyz, wanted[::t], axis=1), xyz[:, ::s])


def least_cost(count: int, error: float, pairs: int) -> float:
    """Return core-seconds that no plan for ``count`` targets can undercut.

    Where neighbours are nearly as cheap as the points' part alone, the grids cost more than that.
    """
    return 2.5 * pairs * count * _point_seconds(error, 2.0)


def _radius(error: float) -> float:
    """Distance, and frequency, at which exp(−r²/2) has fallen to half the error."""
    return math.sqrt(2 * math.log(2 / error))


@dataclass(frozen=True)
class _Cut:
    """A plane across an axis, and the cuts of what lies below and above it."""

    axis: int
    at: float
    below: _Cut | None
    above: _Cut | None


@dataclass(frozen=True)
class _Planning:
    """The search for the cheapest cuts, on samples that stand for so many points each."""

    error: float
    pairs: int
    per_target: int
    per_source: int

    def best(
        self, targets: NDArray[np.float64], sources: NDArray[np.float64]
    ) -> tuple[_Cut | None, float]:
        """Return the cuts of a tile, None if it stays whole, and its cost."""
        count = targets.shape[1] * self.per_target + sources.shape[1] * self.per_source
        whole = _seconds(targets, sources, count, self.error, self.pairs)
        low, high = targets.min(axis=1), targets.max(axis=1)
        axis = int(np.argmax(high - low))
        # One cut alone may cost more than it saves, and the next ones pay: so go on to the
        # margin's size, below which nothing can be gained.
        if high[axis] - low[axis] <= 2 * _radius(self.error):
            return None, whole
        at = float(low[axis] + high[axis]) / 2
        parts, cost = [], 0.0
        for side in (targets[axis] <= at, targets[axis] > at):
            half = np.compress(side, targets, axis=1)
            near = _within_margin(half, sources, self.error)
            part, seconds = self.best(half, np.compress(near, sources, axis=1))
            parts.append(part)
            cost += seconds
        return (_Cut(axis, at, *parts), cost) if cost < whole else (None, whole)


def _dealt(xyz: NDArray[np.float64], error: float, cut: _Cut | None, tile: Tile) -> list[Tile]:
    """Cut a tile as planned, each part with the sources of its margin."""
    if cut is None:
        return [tile]
    below = xyz[cut.axis, tile.targets] <= cut.at
    tiles = []
    for side, part in ((below, cut.below), (~below, cut.above)):
        targets = tile.targets[side]
        if len(targets):
            sources = np.take(xyz, tile.sources, axis=1)
            near = _within_margin(np.take(xyz, targets, axis=1), sources, error)
            tiles += _dealt(xyz, error, part, Tile(targets, tile.sources[near]))
    return tiles


def _within_margin(
    targets: NDArray[np.float64], sources: NDArray[np.float64], error: float
) -> NDArray[np.bool_]:
    """Say which sources are near enough to the targets' box to matter."""
    near = np.ones(sources.shape[1], bool)
    margin = _radius(error)
    for t, s in zip(targets, sources, strict=True):
        near &= s >= t.min() - margin
        near &= s <= t.max() + margin
    return near


def _torus(
    targets: NDArray[np.float64], sources: NDArray[np.float64], error: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Return centre and period of a tile's torus, and its number of frequencies per axis.

    On the torus the nearest false image of a source is at least the cut-off radius away from
    every target.
    """
    low, high = targets.min(axis=1), targets.max(axis=1)
    if sources.shape[1] == 0:  # a sample's
        sources = targets
    span = np.maximum(sources.max(axis=1) - low, high - sources.min(axis=1))
    period = span + _radius(error)
    modes = 2 * np.floor(_radius(error) * period / (2 * math.pi)).astype(np.int64) + 1
    return (low + high) / 2, period, modes


def _refinement(modes: NDArray[np.int64], count: int, error: float) -> tuple[float, float]:
    """Return how much finer the fine grid is best, and the core-seconds of a transform with it."""
    best = (2.0, math.inf)
    for refinement in (2.0, 1.25) if error > _COARSE_ERROR else (2.0,):
        cells = float(np.prod(np.maximum(refinement * modes, 16.0)))
        grid = 2 * cells * _FFT_SECONDS * (1 if cells < _CACHED_CELLS else _UNCACHED)
        seconds = count * _point_seconds(error, refinement) + grid
        if seconds < best[1]:
            best = (refinement, seconds)
    return best


def _point_seconds(error: float, refinement: float) -> float:
    digits = math.log10(1 / error)
    across = digits + 2 if refinement == 2 else 1.64 * digits + 1  # nodes along an axis
    return (across**3 + 200) * _SPREAD_SECONDS


def _seconds(
    targets: NDArray[np.float64],
    sources: NDArray[np.float64],
    count: int,
    error: float,
    pairs: int,
) -> float:
    """Return the core-seconds of a tile of so many targets and sources, given samples of them."""
    _, _, modes = _torus(targets, sources, error)
    _, seconds = _refinement(modes, count, error)
    return pairs * seconds * (_DOUBLE if error < SINGLE_FLOOR else 1)


def _tile_sums(
    xyz: NDArray[np.float64], channels: NDArray[Any], error: float, tile: Tile
) -> NDArray[Any]:
    from finufft import Plan

    single = channels.dtype == np.float32
    real, kind = (np.float32, "complex64") if single else (np.float64, "complex128")
    pairs = len(channels) // 2
    targets, sources = np.take(xyz, tile.targets, axis=1), np.take(xyz, tile.sources, axis=1)
    centre, period, modes = _torus(targets, sources, error)
    refinement, _ = _refinement(modes, len(tile.targets) + len(tile.sources), error)
    # (The library warns where single precision gets close to its limit; SINGLE_FLOOR knows.)
    options = {
        "eps": max(error / 2, 2e-7 if single else 1e-14), "dtype": kind, "nthreads": 1,
        "maxbatchsize": 1, "upsampfac": refinement, "showwarn": 0,
    }  # fmt: skip

    def angles(points: NDArray[np.float64]) -> list[NDArray[Any]]:
        scaled = (points - centre[:, None]) * (2 * math.pi / period[:, None])
        return list(np.ascontiguousarray(scaled, real))

    forward = Plan(1, tuple(modes), pairs, isign=-1, **options)
    forward.setpts(*angles(sources))
    strengths = np.empty((pairs, len(tile.sources)), kind)
    strengths.real, strengths.imag = channels[0::2, tile.sources], channels[1::2, tile.sources]
    spectrum = forward.execute(strengths).reshape(pairs, *modes)
    del forward, strengths
    for axis in range(3):
        frequency = (np.arange(modes[axis]) - modes[axis] // 2) * (2 * math.pi / period[axis])
        gaussian = math.sqrt(2 * math.pi) / period[axis] * np.exp(-0.5 * frequency**2)
        spectrum *= gaussian.astype(real).reshape([-1 if a == axis else 1 for a in range(3)])
    backward = Plan(2, tuple(modes), pairs, isign=1, **options)
    backward.setpts(*angles(targets))
    result = backward.execute(spectrum).reshape(pairs, -1)
    sums = np.empty((len(channels), len(tile.targets)), real)
    sums[0::2], sums[1::2] = result.real, result.imag
    return sums
