"""Gaussian sums over points: Σ_j c_j exp(−‖x_i − x_j‖² / 2 width²), fast, to a stated error.

Three ways, chosen by their estimated cost: adding up neighbours (`direct_sums`), whose cost grows
with the square of the width; a sparse grid (`grid_sums`), whose cost does not, down to errors of
7·10⁻⁶; and frequency space (`spectral_sums`) for smaller ones. All leave an error relative to the
largest mass anywhere, not to the mass at the target, so a small part beside a large one, or a
vertex off the surface, is then computed again with as much more accuracy as it needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.sums import direct_sums as direct
from meshdepict.sums import grid_sums as grid
from meshdepict.sums import spectral_sums as spectral
from meshdepict.sums.ordered_points import OrderedPoints

__all__ = ["MARGIN", "GaussianSums", "gaussian_sums", "predicted_seconds"]

# How much smaller than the error asked for its sources are made at first. Each of them (neglected
# neighbours, cut frequencies, false images, rounding) is relative to the largest mass around, and
# within a scan masses differ by a factor of about three: rims, bends, neighbouring sheets.
MARGIN = 4.0
_SPECTRAL_FLOOR = 1e-13  # what transforms in double precision can reach
_TINY = 1e-290  # a Gaussian below this is zero in double precision

# A pair of points and ten channels on one core, in single precision; and its shares: what a pair
# costs without any channel, and each of them (scripts/cost_constants.py measures the three).
_PAIR_SECONDS = 4.5e-10
_PAIR_BASE = 0.6
_PAIR_CHANNEL = 0.04
# What a point takes besides, in predictions: it is sorted, gathered and checked either way.
_POINT_SECONDS = 0.8e-6

_COARSER = 1.2  # times: cells and batches are coarser than the ball, and more pairs are computed


class GaussianSums:
    """Sums over the same points and channels, at one width after the other.

    Parameters
    ----------
    points : (n, 3) array
        Near the origin: recentred by the caller.
    channels : (c, n) array
        What is summed. Channel 0 is the mass, ≥ 0; the others are at most as large.
    widths : sequence of float
        At which sums will be asked for, as far as that is known: neighbouring ones share some work.
        A sum depends on them, to its rounding, and not on what was asked for before.
    """

    def __init__(
        self,
        points: NDArray[np.float64],
        channels: NDArray[np.float64] | NDArray[np.float32],
        widths: Iterable[float] = (),
    ) -> None:
        self._points, self._channels = points, channels
        self._widths = tuple(widths)
        self._apart = np.sqrt(_squared_distances(np.ascontiguousarray(points.T), None))
        self._grid: grid.PointGrid | None = None
        self._groups: direct.PointGroups | None = None
        self._ordered: OrderedPoints | None = None

    def at(
        self,
        width: float,
        *,
        error: float,
        targets: NDArray[np.bool_] | None = None,
        heaviest: float | None = None,
        done: Callable[[float], None] | None = None,
    ) -> NDArray[Any]:
        """Sum Gaussians of the given width, centred at every point, at every point.

        Parameters
        ----------
        width : float
            Standard deviation of the Gaussian, in the units of the points.
        error : float
            Largest error of a sum, relative to the sum of channel 0 at the same place.
        targets : (n,) array of bool, optional
            Where the sums are wanted; all points unless given. Elsewhere the result is zero.
        heaviest : float, optional
            With ``targets``: the largest sum of channel 0 at any point, where it is known; it saves
            accuracy that is not needed. The sum of all masses is taken for it unless given.
        done : callable, optional
            Called with shares of the work that are finished; they add up to one.

        Returns
        -------
        (c, n) array
            float32 where that is as accurate as asked for, else float64.
        """
        xyz = np.ascontiguousarray(self._points.T) / width
        share = error / MARGIN
        sums = self._one_pass(xyz, width, share, targets, done)
        if targets is None:
            targets = np.ones(len(self._points), bool)
            heaviest = float(sums[0].max())
        elif heaviest is None:
            heaviest = float(self._channels[0].sum())
        while share > _TINY:
            # The error is about share × the largest mass: is that small against the mass here?
            short = targets & (share * heaviest > error * sums[0].astype(np.float64))
            if not short.any():
                break
            least = float(sums[0, short].min())
            needed = error * least / (2 * heaviest) if least > 2 * share * heaviest else share**2
            share = max(min(needed, share / 10), _TINY / 10)
            again = self._one_pass(xyz, width, share, short, None)
            if again.dtype != sums.dtype:
                sums = sums.astype(again.dtype)
            sums[:, short] = again[:, short]
        if share <= _TINY:
            sums[:, targets & (sums[0] <= 100 * _TINY * heaviest)] = 0
        return sums

    def _in_order(self) -> OrderedPoints:
        if self._ordered is None:
            self._ordered = OrderedPoints(self._points, self._channels)
        return self._ordered

    def _one_pass(
        self,
        xyz: NDArray[np.float64],
        width: float,
        share: float,
        targets: NDArray[np.bool_] | None,
        done: Callable[[float], None] | None,
    ) -> NDArray[Any]:
        """Sum at the targets, leaving errors of about ``share`` of the largest mass anywhere."""
        channels, points = self._channels, xyz.shape[1]
        count = len(channels)
        radius = math.sqrt(2 * math.log(1 / share))
        pairs = (count + 1) // 2
        wanted = points if targets is None else int(targets.sum())
        if targets is None:
            near = float(np.mean(self._apart <= _COARSER * radius * width))
            direct_cost = _pair_cost(near, points, points, count)
        else:
            direct_cost = _direct_cost(xyz, radius, count, targets)
        rule = grid.rule_for(share) if count <= grid.MOST_CHANNELS else None
        if rule is not None and grid.least_cost(wanted, count, rule) < direct_cost:
            if self._grid is None:
                self._grid = grid.PointGrid(self._in_order(), self._widths)
            if self._grid.cost(width, rule, wanted) < direct_cost:
                return self._grid.sums(width, rule, targets=targets, done=done)
        if share > _SPECTRAL_FLOOR and spectral.least_cost(wanted, share, pairs) < direct_cost:
            tiles, cost = spectral.plan_tiles(xyz, share, pairs, targets)
            if cost < direct_cost:
                rows = _with_rows(channels, 2 * pairs, _precision(share, spectral.SINGLE_FLOOR))
                return spectral.spectral_sums(xyz, rows, share, tiles, done)[:count]
        if self._groups is None:
            self._groups = direct.PointGroups(self._in_order())
        precision = _precision(share, direct.SINGLE_FLOOR)
        sums = self._groups.sums(width, radius, precision, targets)
        if done:
            done(1.0)
        return sums


def gaussian_sums(
    points: NDArray[np.float64],
    channels: NDArray[np.float64] | NDArray[np.float32],
    width: float,
    *,
    error: float,
    targets: NDArray[np.bool_] | None = None,
    heaviest: float | None = None,
    done: Callable[[float], None] | None = None,
) -> NDArray[Any]:
    """Return sums at one width: `GaussianSums` says what each of these is."""
    return GaussianSums(points, channels).at(
        width, error=error, targets=targets, heaviest=heaviest, done=done
    )


def predicted_seconds(
    points: NDArray[np.float64], width: float, *, channels: int, error: float
) -> float:
    """Return the core-seconds that `gaussian_sums` at all points is expected to take.

    Of its first pass: how many sums have to be done again, with more accuracy, is not known before.
    """
    xyz, share, pairs = points.T / width, error / MARGIN, (channels + 1) // 2
    radius = math.sqrt(2 * math.log(1 / share))
    direct_cost = _direct_cost(xyz, radius, channels, None)
    cost, rule, count = direct_cost, grid.rule_for(share), len(points)
    if rule is not None and grid.least_cost(count, channels, rule) < direct_cost:
        cost = min(direct_cost, grid.predicted_cost(points, width, rule, channels))
    if (
        cost == direct_cost
        and share > _SPECTRAL_FLOOR
        and spectral.least_cost(len(points), share, pairs) < direct_cost
    ):
        cost = min(direct_cost, spectral.planned_seconds(xyz, share, pairs))
    return cost + _POINT_SECONDS * len(points)


def _precision(share: float, floor: float) -> type[np.floating[Any]]:
    return np.float32 if share >= floor else np.float64


def _with_rows(channels: NDArray[Any], count: int, kind: type[np.floating[Any]]) -> NDArray[Any]:
    """Return the channels in the precision wanted, filled up with zeros to ``count`` rows."""
    rows = np.zeros((count, channels.shape[1]), kind)
    rows[: len(channels)] = channels
    return rows


def _direct_cost(
    xyz: NDArray[np.float64],
    radius: float,
    channels: int,
    targets: NDArray[np.bool_] | None,
) -> float:
    """Return estimated core-seconds: the pairs of a sample of targets and sources, scaled up."""
    count = xyz.shape[1]
    wanted = count if targets is None else int(targets.sum())
    near = float(np.mean(_squared_distances(xyz, targets) <= (_COARSER * radius) ** 2))
    return _pair_cost(near, wanted, count, channels)


def _pair_cost(near: float, wanted: int, count: int, channels: int) -> float:
    return near * wanted * count * _PAIR_SECONDS * (_PAIR_BASE + _PAIR_CHANNEL * channels)


def _squared_distances(
    xyz: NDArray[np.float64], targets: NDArray[np.bool_] | None
) -> NDArray[np.float64]:
    """Return those between a sample of the targets and one of all points."""
    wanted = np.arange(xyz.shape[1]) if targets is None else np.flatnonzero(targets)
    few = xyz[:, wanted[:: max(1, len(wanted) // 64)]]
    some = xyz[:, :: max(1, xyz.shape[1] // 4096)]
    # (Written out rather than as a product of matrices: BLAS would wake all of its threads.)
    squared = sum((f[:, None] - s) ** 2 for f, s in zip(few, some, strict=True))
    return np.asarray(squared)
