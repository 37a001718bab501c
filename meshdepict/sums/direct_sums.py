"""Gaussian sums over points by adding up neighbours: exact but for what lies beyond a radius.

The points are put into groups of sixteen that are near each other, with a box round each, a box
round sixteen boxes, and so on. Sixteen targets walk down the boxes within reach together, and each
source that is near enough to one of them is added to the sums of all: one vector has its sixteen
weights, and another the sums of each channel. Coordinates are relative to the targets, so that
single precision suffices.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.sums.lanes import (
    WIDE,
    add_scaled,
    fill,
    larger,
    load,
    lowest,
    many,
    minus,
    nothing,
    plus,
    power_of_two,
    rounded,
    store,
    times,
    within,
)  # fmt: skip
from meshdepict.sums.ordered_points import OrderedPoints
from meshdepict.threads import each, kernel, spans

__all__ = ["SINGLE_FLOOR", "PointGroups", "exact_sums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SINGLE_FLOOR = 2e-6  # relative error that single precision reaches safely in these sums

_TOGETHER = 128  # sources, about, that are added up before their sum is: for the sake of rounding
_ACROSS = 100  # widths of a box, in which numbers of single precision are off by 3e-6 widths
_PIECE = 64  # groups of targets that a thread takes at a time

# In these units of the width the Gaussian exp(−d²/2) is 2^(−d²).
_UNIT = math.sqrt(2 * math.log(2.0))
# By which boxes are wider than what is in them, of the extent of all: their numbers are rounded.
_ROUNDED = 1e-6
_FARTHEST = 1e18  # that is finite when squared: boxes that fill up a row are at infinity
_ONE = many(WIDE)


def exact_sums(points: Floats, channels: Floats, width: float) -> Floats:
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


class _Sources(NamedTuple):
    """Groups in one precision; points that fill up the last one have no channels."""

    local: Floats  # (groups, 3, WIDE): from the middle of a group, all in one row
    values: NDArray[Any]  # (groups, WIDE, c), all in one row


class PointGroups:
    """Points in groups, for sums over the same points and channels at several widths.

    Parameters
    ----------
    points : OrderedPoints
    """

    def __init__(self, points: OrderedPoints) -> None:
        self._own = points
        last = np.repeat(points.points[-1:], -len(points.points) % WIDE, axis=0)
        self._grouped = np.concatenate([points.points, last]).reshape(-1, WIDE, 3)
        low, high = self._grouped.min(axis=1), self._grouped.max(axis=1)
        self._middles, self._sides = (low + high) / 2, (high - low).max(axis=1)
        extent = float((points.points.max(axis=0) - points.points.min(axis=0)).max())
        self._boxes, self._begins = _levels(low, high, _ROUNDED * extent)
        self._sources: dict[type[np.floating[Any]], _Sources] = {}

    def _in_groups(self, precision: type[np.floating[Any]]) -> _Sources:
        if precision not in self._sources:
            own = self._own
            local = (self._grouped - self._middles[:, None]).transpose(0, 2, 1)
            values = np.zeros((self._grouped.size // 3, len(own.channels)), precision)
            single = precision == np.float32
            values[: len(own.order)] = own.rows if single else own.channels.T[own.order]
            self._sources[precision] = _Sources(local.ravel(), values.ravel())
        return self._sources[precision]

    def sums(
        self,
        width: float,
        radius: float,
        precision: type[np.floating[Any]],
        targets: NDArray[np.bool_] | None = None,
    ) -> NDArray[Any]:
        """Sum Gaussians over all sources within a radius (and some beyond).

        Parameters
        ----------
        width : float
        radius : float
            In widths.
        precision : float32 or float64
        targets : (n,) array of bool, optional
            Where the sums are wanted; elsewhere they come out as zero.

        Returns
        -------
        (c, n) array
        """
        order = self._own.order
        wanted = np.arange(len(order)) if targets is None else np.flatnonzero(targets[order])
        make = np.empty if targets is None else np.zeros
        sums = make((len(order), len(self._own.channels)), precision)
        if precision == np.float32 and len(wanted):
            # Where sixteen lie on two sides of a gap, single precision would not do.
            across = self._sides if targets is None else self._across(wanted)
            far = np.repeat(across > _ACROSS * width, WIDE)[: len(wanted)]
            if far.any():
                self._add(wanted[far], width, radius, np.float64, sums)
                wanted = wanted[~far]
        self._add(wanted, width, radius, precision, sums)
        return sums.T

    def _across(self, wanted: Ints) -> Floats:
        """Return the longest side of the box round every sixteen of some points."""
        begins = np.arange(0, len(wanted), WIDE)
        points = self._own.points[wanted]
        low, high = np.minimum.reduceat(points, begins), np.maximum.reduceat(points, begins)
        found: Floats = (high - low).max(axis=1)
        return found

    def _add(
        self,
        wanted: Ints,
        width: float,
        radius: float,
        precision: type[np.floating[Any]],
        sums: NDArray[Any],
    ) -> None:
        """Fill the sums (n, c) at some points, sixteen after each other at a time."""
        sources, like = self._in_groups(precision), many(WIDE * sums.shape[1])
        scale = 1 / (width * _UNIT)
        each(
            lambda a, b: _sum_groups(
                self._own.points, self._own.order, wanted, *sources, self._middles, self._boxes,
                self._begins, scale, radius / _UNIT, like, a, b, sums,
            ),
            spans(-(-len(wanted) // WIDE), max(1, len(wanted) // (WIDE * _PIECE))),
        )  # fmt: skip


def _levels(low: Floats, high: Floats, wider: float) -> tuple[NDArray[np.float32], Ints]:
    """Return boxes round boxes, sixteen at a time, until sixteen are left.

    Returns
    -------
    boxes : array
        Of every sixteen their lowest x, y and z, and then their highest, (…, 6, WIDE), in one row.
    begins : array
        Where each level begins, counted in sixteens.
    """
    parts, begins = [], [0]
    while True:
        count = -(-len(low) // WIDE)
        fill = ((0, count * WIDE - len(low)), (0, 0))
        low = np.pad(low, fill, constant_values=np.inf).reshape(count, WIDE, 3)
        high = np.pad(high, fill, constant_values=-np.inf).reshape(count, WIDE, 3)
        both = np.concatenate([low - wider, high + wider], axis=2)
        parts.append(both.transpose(0, 2, 1).astype(np.float32).ravel())
        if count == 1:
            return np.concatenate(parts), np.array(begins)
        begins.append(begins[-1] + count)
        low, high = low.min(axis=1), high.max(axis=1)


@kernel("free", inline=True)
def _beyond(low, high, boxes, row, zero):  # type: ignore[no-untyped-def]
    """Return how far sixteen boxes are from one along an axis."""
    before = minus(load(boxes, row, _ONE), fill(high))
    after = minus(fill(low), load(boxes, row + 3 * WIDE, _ONE))
    return larger(larger(before, after), zero)


@kernel("free")
def _near(box, boxes, row, limit):  # type: ignore[no-untyped-def]
    """Say by bits which of sixteen boxes are within reach of one."""
    zero = nothing(boxes, _ONE)
    x = _beyond(box[0], box[3], boxes, row, zero)
    y = _beyond(box[1], box[4], boxes, row + WIDE, zero)
    z = _beyond(box[2], box[5], boxes, row + 2 * WIDE, zero)
    return within(plus(times(x, x), plus(times(y, y), times(z, z))), fill(limit))


@kernel("free", inline=True)
def _moved(local, row, by, factor, values):  # type: ignore[no-untyped-def]
    """Return where sources are along an axis, from the middle of the targets, in their units."""
    return rounded(times(plus(load(local, row, _ONE), fill(by)), factor), values)


@kernel("free", inline=True)
def _outside(place, half, zero):  # type: ignore[no-untyped-def]
    """Return how far places are from an interval about zero."""
    return larger(larger(minus(place, half), minus(zero, plus(place, half))), zero)


@kernel("free")
def _sum_groups(  # type: ignore[no-untyped-def]
    points, order, wanted, local, values, middles, boxes, begins, scale, radius, like, first, last,
    sums,
):  # fmt: skip
    """Compute the sums of groups [first, last) of the wanted points.

    Parameters
    ----------
    points : (n, 3) array
    order : (n,) array
        Where each point belongs among the sums.
    wanted : (m,) array
        Which of the points are targets.
    local, values
        Of sources: see `_Sources`.
    middles : (groups, 3) array
    boxes, begins
        See `_levels`.
    scale, radius : float
        From the units of points to those in which the Gaussian is 2^(−d²); in these.
    like : tuple
        As many vectors as channels.
    sums : (n, c) array
    """
    of = values.dtype.type
    c = sums.shape[1]
    middle, half = np.empty(3), np.empty(3)
    box = np.empty(6, np.float32)
    single = np.float32(min(radius / scale, _FARTHEST)) ** 2
    targets, places = np.empty(3 * WIDE, values.dtype), np.empty(3 * WIDE, values.dtype)
    found = np.empty(len(like) * WIDE, values.dtype)
    masks, blocks = np.empty(len(begins), np.int64), np.empty(len(begins), np.int64)
    factor, limit = fill(scale), fill(of(radius) * of(radius))
    zero, zeros = nothing(values, _ONE), nothing(values, like)
    for group in range(first, last):
        begin, end = group * WIDE, min(group * WIDE + WIDE, len(wanted))
        for axis in range(3):
            low = high = points[wanted[begin], axis]
            for i in range(begin + 1, end):
                low = min(low, points[wanted[i], axis])
                high = max(high, points[wanted[i], axis])
            middle[axis], half[axis] = (low + high) / 2, (high - low) / 2 * scale
            box[axis], box[3 + axis] = np.float32(low), np.float32(high)
            for i in range(WIDE):
                j = wanted[min(begin + i, end - 1)]
                targets[axis * WIDE + i] = of((points[j, axis] - middle[axis]) * scale)
        tx, ty, tz = (
            load(targets, 0, _ONE), load(targets, WIDE, _ONE), load(targets, 2 * WIDE, _ONE),
        )  # fmt: skip
        hx, hy, hz = fill(of(half[0])), fill(of(half[1])), fill(of(half[2]))
        total, some, added = zeros, zeros, 0
        top = len(begins) - 1
        level = top
        blocks[top] = 0
        masks[top] = _near(box, boxes, begins[top] * 6 * WIDE, single)
        while level <= top:
            if masks[level] == 0:
                level += 1
                continue
            child = blocks[level] * WIDE + lowest(masks[level])
            masks[level] &= masks[level] - 1
            if level > 0:
                level -= 1
                blocks[level] = child
                masks[level] = _near(box, boxes, (begins[level] + child) * 6 * WIDE, single)
                continue
            row = child * 3 * WIDE
            sx = _moved(local, row, middles[child, 0] - middle[0], factor, values)
            sy = _moved(local, row + WIDE, middles[child, 1] - middle[1], factor, values)
            sz = _moved(local, row + 2 * WIDE, middles[child, 2] - middle[2], factor, values)
            x, y, z = _outside(sx, hx, zero), _outside(sy, hy, zero), _outside(sz, hz, zero)
            bits = within(plus(times(x, x), plus(times(y, y), times(z, z))), limit)
            store(sx, places, 0)
            store(sy, places, WIDE)
            store(sz, places, 2 * WIDE)
            while bits != 0:
                j = lowest(bits)
                bits &= bits - 1
                dx = minus(fill(places[j]), tx)
                dy = minus(fill(places[WIDE + j]), ty)
                dz = minus(fill(places[2 * WIDE + j]), tz)
                squared = plus(times(dx, dx), plus(times(dy, dy), times(dz, dz)))
                weight = power_of_two(minus(zero, squared))
                some = add_scaled(some, weight, values, (child * WIDE + j) * c)
                added += 1
            if added >= _TOGETHER:
                total, some, added = plus(total, some), zeros, 0
        store(plus(total, some), found, 0)
        for i in range(begin, end):
            to = sums[order[wanted[i]]]
            for m in range(c):
                to[m] = found[m * WIDE + i - begin]
