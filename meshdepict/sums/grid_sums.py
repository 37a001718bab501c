"""Gaussian sums over points by way of a sparse grid, whose nodes lie up to half a width apart.

Points are spread on the nodes near them, the grid is blurred, and sums are gathered from it with
the weights that spread them (`bells`). Only blocks of nodes that points touch are there: cost and
memory are those of the surface, and hardly depend on the width.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.sums.bells import RULES, Rule, blur_taps, weight_table
from meshdepict.sums.block_kernels import (
    BLOCK,
    MOST_CHANNELS,
    MOST_NODES,
    block_keys,
    blur,
    gather,
    merge,
    spread,
)  # fmt: skip
from meshdepict.sums.block_layout import Cells, Way, blurs, cells
from meshdepict.sums.lanes import WIDE, many
from meshdepict.sums.ordered_points import OrderedPoints
from meshdepict.threads import each, spans, thread_count

__all__ = ["MOST_CHANNELS", "PointGrid", "least_cost", "predicted_cost", "rule_for"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Single = NDArray[np.float32]

_PIECE = 4096  # points that are spread by one thread, at least
_MOST_BLOCKS = 4096  # at once: 75 MB of nine channels, and three times that while they are blurred
_ROOM = 16  # blocks round all points: farther no blur reaches
_FINEST = 5e6  # widths in the extent of the points, at most: keys stay within 63 bits
_CORNERS: Ints = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)])
_COARSE = 16  # cells along the longest side, by which a surface's extent is estimated

# Seconds of one core: of a point, sorted and gathered; of a channel of a node that it is spread on,
# and that it is gathered from; of a tap and channel of the blur. Near what the fit in
# scripts/cost_constants.py gives, which parts the first two poorly.
_POINT_SECONDS = 1e-7
_SPREAD_SECONDS = 5e-11
_GATHER_SECONDS = 6e-11
_TAP_SECONDS = 1.3e-10


def rule_for(error: float) -> Rule | None:
    """Return the rule of least cost that keeps an error; None where there is none."""
    return next((rule for rule in RULES if rule.error <= error), None)


def least_cost(wanted: int, channels: int, rule: Rule) -> float:
    """Return core-seconds that no sum at so many points on a grid of its own can undercut."""
    return wanted * (_POINT_SECONDS + _GATHER_SECONDS * channels * rule.nodes**3)


def predicted_cost(points: Floats, width: float, rule: Rule, channels: int) -> float:
    """Return the core-seconds of a sum at all points, without a grid for them."""
    low = points.min(axis=0)
    longest = float((points.max(axis=0) - low).max()) or 1.0
    cell = ((points - low) * (_COARSE / longest)).astype(np.int64) @ (1, 32, 1024)
    if width > longest:
        return math.inf
    area = _area(len(np.unique(cell)), longest)
    return _cost(len(points), area, width, width, rule, channels)


def _area(occupied: int, longest: float) -> float:
    return occupied * (longest / _COARSE) ** 2 / 1.5


def _blocks(area: float, spacing: float) -> float:
    """Return about how many blocks a surface touches."""
    return 8 + 3.3 * area / (BLOCK * spacing) / (BLOCK * spacing)  # no square: it may overflow


def _cost(
    points: int, area: float, width: float, leader: float, rule: Rule, channels: int
) -> float:
    """Return the core-seconds of a sum on the grid of a narrower width, or of its own."""
    many, nodes, taps = _parts(points, area, width, leader, rule, channels)
    anew = many * _POINT_SECONDS + nodes * _SPREAD_SECONDS if leader == width else 0.0
    return anew + nodes * _GATHER_SECONDS + taps * _TAP_SECONDS


def _parts(
    points: int, area: float, width: float, leader: float, rule: Rule, channels: int
) -> tuple[float, float, float]:
    """Return points, channels of nodes that those are spread on, and of taps of the blur."""
    spacing = leader / rule.density
    taps, blocks = len(blur_taps(rule, width / spacing)), _blocks(area, spacing)
    nodes = points * rule.nodes**3 * channels
    return points, nodes, 3 * blocks * BLOCK**3 * taps * channels


class _Sorted(NamedTuple):
    """Points in the order of the blocks of a grid of one spacing."""

    spacing: float
    rule: Rule
    cells: Cells

    def touched(self, first: int, last: int) -> tuple[Ints, NDArray[np.int32]]:
        """Return keys of the blocks that cells [first, last) reach, and each one's (k, 8)."""
        corners = self.cells.keys[first:last, None] + _CORNERS @ self.cells.step
        keys: Ints = np.unique(corners)
        return keys, np.searchsorted(keys, corners).astype(np.int32)

    def corners(self, first: int, last: int) -> tuple[Ints, Floats]:
        """Return where the points of cells [first, last) begin and end, and their first nodes."""
        corners = (BLOCK * self.cells.places(first, last)).astype(np.float64)
        return self.cells.starts[first : last + 1], corners


class _Spread(NamedTuple):
    """What points were spread on."""

    keys: Ints
    slots: NDArray[np.int32]
    grid: Single


class PointGrid:
    """Sums over the same points and channels at several widths.

    A width shares what was spread for a narrower one where a wider blur costs less than to spread
    the points anew. Which ones do follows from the widths alone, and so do all sums.

    Parameters
    ----------
    points : OrderedPoints
    widths : sequence of float
        At which sums will be asked for; others share nothing.
    origin : (3,) array, optional
        Where nodes are counted from, below all points; where that suits best unless given.
    """

    def __init__(
        self, points: OrderedPoints, widths: Iterable[float] = (), *, origin: Floats | None = None
    ) -> None:
        places = points.points
        low, high = places.min(axis=0), places.max(axis=0)
        self._longest = float((high - low).max()) or 1.0
        if origin is None:  # layers are cut across the longest axis
            self._points = (places - low)[:, np.argsort(high - low, kind="stable")]
        else:
            self._points = places - origin
        self._order = points.order
        self._shape = points.rows.shape
        self._values = np.append(points.rows.ravel(), np.zeros(WIDE, np.float32))
        cell = ((places - low) * (_COARSE / self._longest)).astype(np.int64) @ (1, 32, 1024)
        occupied = int(np.count_nonzero(np.bincount(cell)))
        self._area = _area(occupied, self._longest)
        self._widths = sorted(widths)
        self._kept: tuple[_Sorted, _Spread] | None = None
        # Of what is spread, and what is blurred: memory that has been touched. Fresh pages take as
        # long as a blur.
        self._scratch = [np.empty(0, np.float32)] * 2

    def cost(self, width: float, rule: Rule, wanted: int) -> float:
        """Return the core-seconds that a sum at so many points is expected to take.

        Infinite where the points lie within a width, all between the same few nodes, and where they
        lie farther apart than nodes can be counted.
        """
        leader = self._leader(width, rule)
        if not leader <= self._longest <= _FINEST * leader:
            return math.inf
        count, channels = self._shape
        unwanted = (count - wanted) * channels * rule.nodes**3 * _GATHER_SECONDS
        return self._seconds(width, leader, rule) - unwanted

    def _seconds(self, width: float, leader: float, rule: Rule) -> float:
        count, channels = self._shape
        return _cost(count, self._area, width, leader, rule, channels)

    def parts(self, width: float, rule: Rule) -> tuple[float, float, float]:
        """Return how much of what the cost model counts a sum with a grid of its own has."""
        count, channels = self._shape
        return _parts(count, self._area, width, width, rule, channels)

    def forget(self) -> None:
        """Let go of what was spread."""
        self._kept = None

    def _leader(self, width: float, rule: Rule) -> float:
        """Return the width whose spacing a width has: its own, or a narrower one's."""
        if width not in self._widths:
            return width
        leader = 0.0
        for following in self._widths:
            ways = [following]
            # What doesn't fit at once isn't kept.
            kept = leader and _blocks(self._area, leader / rule.density) <= _MOST_BLOCKS
            if kept and _far(rule, following / leader * rule.density) <= _ROOM:
                ways.append(leader)
            leader = min(ways, key=lambda way: self._seconds(following, way, rule))
            if following == width:
                break
        return leader

    def sums(
        self,
        width: float,
        rule: Rule,
        *,
        targets: NDArray[np.bool_] | None = None,
        done: Callable[[float], None] | None = None,
    ) -> Single:
        """Return Σ_j c_j exp(−‖x_i − x_j‖² / 2 width²), (c, n), within the rule's error.

        Parameters
        ----------
        width : float
        rule : Rule
        targets : (n,) array of bool, optional
            Where the sums are wanted; elsewhere they are zero.
        done : callable, optional
            Called with shares of the work that are finished.
        """
        count, c = self._shape
        sums = np.zeros((count, c), np.float32)
        kept, spacing = self._kept, self._leader(width, rule) / rule.density
        if kept is None or kept[0].spacing != spacing or kept[0].rule != rule:
            self._kept = kept = None  # its memory is free for the next one
            points = self._sorted(spacing, rule)
            layers = _layers(points)
            if len(layers) == 1:
                self._kept = kept = points, self._spread(points, 0, len(points.cells.keys))
        if kept is not None:
            points, whole = kept
            self._gather(points, whole, (0, len(points.cells.keys)), width, targets, sums)
            if done:
                done(1.0)
            return sums.T
        reach = _far(rule, width / spacing) + 1
        key = points.cells.keys // points.cells.step[2]
        for first, last in layers:
            around = np.searchsorted(key, (key[first] - reach, key[last - 1] + reach + 1))
            some = self._spread(points, *(int(end) for end in around))
            self._gather(points, some, (first, last), width, targets, sums)
            if done:
                done(float((points.cells.starts[last] - points.cells.starts[first]) / count))
        return sums.T

    def _sorted(self, spacing: float, rule: Rule) -> _Sorted:
        ends = np.array([np.zeros(3), self._points.max(axis=0)]) / spacing - (rule.nodes / 2 - 1)
        low, high = np.floor(ends).astype(np.int64) // BLOCK
        low, high = low - _ROOM, high + _ROOM + 2
        step = np.cumprod([1, *(high - low)[:2]])
        keys = np.empty(len(self._points), np.int64)
        each(
            lambda a, b: block_keys(
                self._points, rule.nodes, 1 / spacing, low, step, a, b, keys
            ),
            spans(len(keys), thread_count()),
        )  # fmt: skip
        return _Sorted(spacing, rule, cells(keys, step, low))

    def _spread(self, sort: _Sorted, first: int, last: int) -> _Spread:
        """Spread the points of cells [first, last)."""
        keys, own = sort.touched(first, last)
        starts, corners = sort.corners(first, last)
        pieces = _pieces(starts)
        slots, extra, owner = _slots(own, pieces, len(keys))
        c = self._shape[1]
        shape = len(keys) + len(extra), BLOCK, BLOCK, BLOCK * c
        flat = self._memory(0, math.prod(shape))
        flat[:] = 0
        grid = flat.reshape(shape)
        each(
            lambda a, b: spread(
                starts, slots, corners, sort.cells.order, self._points, self._values,
                *_bells(sort, c), a, b, grid,
            ),
            pieces,
        )  # fmt: skip
        merge(extra, owner, grid.reshape(len(grid), -1))
        return _Spread(keys, own, flat)

    def _memory(self, number: int, count: int) -> Single:
        """Return so many numbers of one of the scratches, which have some more."""
        if len(self._scratch[number]) < count + WIDE:
            self._scratch[number] = np.empty(count + WIDE, np.float32)
        return self._scratch[number][:count]

    def _gather(
        self,
        points: _Sorted,
        spread: _Spread,
        span: tuple[int, int],
        width: float,
        targets: NDArray[np.bool_] | None,
        sums: Single,
    ) -> None:
        """Blur a grid and fill the sums at the points of some cells."""
        rule, c, (first, last) = points.rule, sums.shape[1], span
        density = width / points.spacing
        taps = blur_taps(rule, density)
        wanted, slots = points.touched(first, last)
        way = blurs(spread.keys, wanted, _far(rule, density), points.cells.step)
        grid = self._blurred(way, spread.grid, np.pad(taps, BLOCK))
        blocks = grid.reshape(-1, BLOCK, BLOCK, BLOCK * c)
        asked = np.ones(len(sums), np.bool_) if targets is None else targets
        starts, corners = points.corners(first, last)
        each(
            lambda a, b: gather(
                starts, slots, corners, points.cells.order, self._points, *_bells(points, c),
                blocks, self._order, asked, a, b, sums,
            ),
            spans(last - first, 8 * thread_count()),
        )  # fmt: skip

    def _blurred(self, way: Way, grid: Single, taps: Single) -> Single:
        c = self._shape[1]
        size = BLOCK**3 * c
        out = self._memory(1, len(way.near[2]) * size)

        def layers(first: int, last: int) -> None:
            # One layer after the other: between two blurs it stays in the cache.
            most = np.diff(way.layers[first : last + 1], axis=0).max(axis=0)
            after_z, after_y = (np.empty(n * size + WIDE, np.float32) for n in most[:2])
            for begins, ends in pairwise(way.layers[first : last + 1]):
                z, y, x = (near[a:b] for near, a, b in zip(way.near, begins, ends, strict=True))
                to = out[begins[2] * size : ends[2] * size]
                blur(z, grid, 0, taps, BLOCK**2 * c, size, after_z)
                blur(y, after_z, begins[0], taps, BLOCK * c, size, after_y)
                blur(x, after_y, begins[1], taps, c, size, to)

        each(layers, spans(len(way.layers) - 1, 4 * thread_count()))
        return out


def _bells(sort: _Sorted, channels: int) -> tuple[int, float, Single, tuple[int, ...]]:
    """Return what kernels know of bells: nodes, density, table, vectors of a row of nodes."""
    rule = sort.rule
    table = weight_table(rule, MOST_NODES).ravel()
    return rule.nodes, 1 / sort.spacing, table, many(rule.nodes * channels)


def _far(rule: Rule, density: float) -> int:
    """Return how many blocks a blur reaches."""
    return -(-(len(blur_taps(rule, density)) // 2) // BLOCK)


def _layers(points: _Sorted) -> list[tuple[int, int]]:
    """Cut cells across the last axis, so that not too many blocks are there at once."""
    keys, _ = points.touched(0, len(points.cells.keys))
    if len(keys) <= _MOST_BLOCKS:
        return [(0, len(points.cells.keys))]
    step = points.cells.step[2]
    layer, number = np.unique(keys // step, return_counts=True)
    slab = (np.cumsum(number) - 1) // _MOST_BLOCKS
    begins = layer[np.flatnonzero(np.diff(slab, prepend=-1))]
    cuts = np.unique(np.searchsorted(points.cells.keys // step, begins))
    ends = np.append(cuts[1:], len(points.cells.keys))
    return [(int(a), int(b)) for a, b in zip(cuts, ends, strict=True) if a < b]


def _pieces(starts: Ints) -> list[tuple[int, int]]:
    """Cut cells into runs of enough points, the same ones whatever the number of threads."""
    points = int(starts[-1] - starts[0])
    steps = np.arange(0, points, max(_PIECE, points // 64))
    cuts = np.append(np.searchsorted(starts, starts[0] + steps), len(starts) - 1)
    cuts = np.unique(cuts)
    return [(int(a), int(b)) for a, b in pairwise(cuts)]


def _slots(
    own: NDArray[np.int32], pieces: list[tuple[int, int]], count: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Return where cells are spread, so that no two pieces spread on the same block.

    The first piece that touches a block has it, the others an extra one, which is added later.

    Returns
    -------
    slots : (cells, 8) array
    extra, owner : (k,) arrays
        Blocks to be added, and to which ones.
    """
    slots, taken = own.copy(), np.zeros(count, np.bool_)
    extras: list[NDArray[np.int32]] = [np.empty(0, np.int32)]
    owners: list[NDArray[np.int32]] = [np.empty(0, np.int32)]
    following = count
    for begin, end in pieces:
        blocks = np.unique(own[begin:end])
        again = blocks[taken[blocks]]
        taken[blocks] = True
        if len(again):
            place = np.arange(following, following + len(again), dtype=np.int32)
            following += len(again)
            at = np.minimum(np.searchsorted(again, own[begin:end]), len(again) - 1)
            slots[begin:end] = np.where(again[at] == own[begin:end], place[at], own[begin:end])
            extras.append(place)
            owners.append(again)
    return slots, np.concatenate(extras), np.concatenate(owners)
