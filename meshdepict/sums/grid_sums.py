"""Gaussian sums over points by way of a sparse grid, whose nodes lie up to half a width apart.

Points are spread on the nodes near them, the grid is blurred, and sums are gathered from it with
the weights that spread them (`bells`). Only blocks of nodes that points touch are there: cost and
memory are those of the surface, and hardly depend on the width.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.sums.bells import RULES, Rule, blur_taps, weight_table
from meshdepict.sums.block_kernels import BLOCK, LINES, blur, gather, merge, spread
from meshdepict.sums.block_layout import Cells, blurs, cells, morton_order
from meshdepict.threads import each, spans, thread_count

__all__ = ["PointGrid", "least_cost", "predicted_cost", "rule_for"]

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
_POINT_SECONDS = 1.5e-7
_SPREAD_SECONDS = 1.2e-10
_GATHER_SECONDS = 1e-10
_TAP_SECONDS = 1e-10


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


class _Points(NamedTuple):
    """Points in the order of the blocks of a grid of one spacing."""

    spacing: float
    rule: Rule
    order: Ints  # as they were given
    shares: Single
    local: NDArray[np.int32]
    values: Single
    cells: Cells

    def touched(self, first: int, last: int) -> tuple[Ints, NDArray[np.int32]]:
        """Return keys of the blocks that cells [first, last) reach, and each one's (k, 8)."""
        corners = self.cells.keys[first:last, None] + _CORNERS @ self.cells.step
        keys: Ints = np.unique(corners)
        return keys, np.searchsorted(keys, corners).astype(np.int32)


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
    points : (n, 3) array
        Near the origin.
    channels : (c, n) array
    widths : sequence of float
        At which sums will be asked for; others share nothing.
    """

    def __init__(
        self, points: Floats, channels: NDArray[Any], widths: Iterable[float] = ()
    ) -> None:
        low = points.min(axis=0)
        extent = points.max(axis=0) - low
        self._longest = float(extent.max()) or 1.0
        places = np.minimum((points - low).T / self._longest, 1 - 2.0**-22)
        axes = np.argsort(extent, kind="stable")  # layers are cut across the longest
        self._order = morton_order(places)
        self._points = (points - low)[self._order][:, axes]
        self._values = np.ascontiguousarray(channels.T[self._order], np.float32)
        cell = (_COARSE * places).astype(np.int64)
        occupied = len(np.unique(cell[0] + 32 * (cell[1] + 32 * cell[2])))
        self._area = _area(occupied, self._longest)
        self._widths = sorted(widths)
        self._kept: tuple[_Points, _Spread] | None = None
        # Blocks on their way, in memory that has been touched: fresh pages take as long as a blur.
        self._scratch = [np.empty((0, 0), np.float32)] * 2

    def cost(self, width: float, rule: Rule, wanted: int) -> float:
        """Return the core-seconds that a sum at so many points is expected to take.

        Infinite where the points lie within a width, all between the same few nodes, and where they
        lie farther apart than nodes can be counted.
        """
        leader = self._leader(width, rule)
        if not leader <= self._longest <= _FINEST * leader:
            return math.inf
        count, channels = self._values.shape
        unwanted = (count - wanted) * channels * rule.nodes**3 * _GATHER_SECONDS
        return self._seconds(width, leader, rule) - unwanted

    def _seconds(self, width: float, leader: float, rule: Rule) -> float:
        count, channels = self._values.shape
        return _cost(count, self._area, width, leader, rule, channels)

    def parts(self, width: float, rule: Rule) -> tuple[float, float, float]:
        """Return how much of what the cost model counts a sum with a grid of its own has."""
        count, channels = self._values.shape
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
        count, c = self._values.shape
        sums = np.zeros((c, count), np.float32)
        kept, spacing = self._kept, self._leader(width, rule) / rule.density
        if kept is None or kept[0].spacing != spacing or kept[0].rule != rule:
            self._kept = kept = None  # its memory is free for the next one
            points = self._sorted(spacing, rule)
            layers = _layers(points)
            if len(layers) == 1:
                self._kept = kept = points, _spread(points, 0, len(points.cells.keys))
        if kept is not None:
            points, whole = kept
            self._gather(points, whole, (0, len(points.cells.keys)), width, targets, sums)
            if done:
                done(1.0)
            return sums
        reach = _far(rule, width / spacing) + 1
        key = points.cells.keys // points.cells.step[2]
        for first, last in layers:
            around = np.searchsorted(key, (key[first] - reach, key[last - 1] + reach + 1))
            some = _spread(points, *(int(end) for end in around))
            self._gather(points, some, (first, last), width, targets, sums)
            if done:
                done(float((points.cells.starts[last] - points.cells.starts[first]) / count))
        return sums

    def _sorted(self, spacing: float, rule: Rule) -> _Points:
        along = self._points / spacing - (rule.nodes / 2 - 1)
        first = np.floor(along)
        shares = (along - first).astype(np.float32)
        nodes = first.astype(np.int32)
        block = nodes // BLOCK
        found = cells(block, _ROOM)
        order = found.order
        return _Points(
            spacing, rule, self._order[order], shares[order], (nodes - BLOCK * block)[order],
            self._values[order], found,
        )  # fmt: skip

    def _gather(
        self,
        points: _Points,
        spread: _Spread,
        span: tuple[int, int],
        width: float,
        targets: NDArray[np.bool_] | None,
        sums: Single,
    ) -> None:
        """Blur a grid and fill the sums at the points of some cells."""
        rule, c, (first, last) = points.rule, len(sums), span
        density = width / points.spacing
        taps = blur_taps(rule, density)
        wanted, slots = points.touched(first, last)
        way = blurs(spread.keys, wanted, _far(rule, density), points.cells.step)
        grid = spread.grid
        for number, (near, axis) in enumerate(zip(way, (2, 1, 0), strict=True)):
            grid = self._blurred(near, grid, taps, c * BLOCK**axis, number % 2)
        blocks = grid.reshape(len(grid), BLOCK, BLOCK, BLOCK * c)
        asked = np.ones(len(points.order), np.bool_) if targets is None else targets[points.order]
        starts, table = points.cells.starts[first : last + 1], weight_table(rule)
        each(
            lambda a, b: gather(
                starts, slots, points.shares, points.local, table, blocks, points.order, asked,
                a, b, sums,
            ),
            spans(last - first, 8 * thread_count()),
        )  # fmt: skip

    def _blurred(
        self, near: NDArray[np.int32], grid: Single, taps: Single, stride: int, to: int
    ) -> Single:
        if len(self._scratch[to]) < len(near):
            self._scratch[to] = np.empty((len(near), grid.shape[1]), np.float32)
        out, before = self._scratch[to][: len(near)], len(taps) // 2
        taps = np.pad(taps, (0, -len(taps) % LINES))
        each(
            lambda a, b: blur(near, grid, taps, before, stride, a, b, out),
            spans(len(near), 4 * thread_count()),
        )
        return out


def _far(rule: Rule, density: float) -> int:
    """Return how many blocks a blur reaches."""
    return -(-(len(blur_taps(rule, density)) // 2) // BLOCK)


def _layers(points: _Points) -> list[tuple[int, int]]:
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


def _spread(points: _Points, first: int, last: int) -> _Spread:
    """Spread the points of cells [first, last)."""
    keys, own = points.touched(first, last)
    pieces = _pieces(points.cells.starts[first : last + 1])
    slots, extra, owner = _slots(own, pieces, len(keys))
    c = points.values.shape[1]
    grid = np.zeros((len(keys) + len(extra), BLOCK, BLOCK, BLOCK * c), np.float32)
    table, starts = weight_table(points.rule), points.cells.starts[first : last + 1]
    each(
        lambda a, b: spread(
            starts, slots, points.shares, points.local, points.values, table, a, b, grid
        ),
        pieces,
    )
    flat = grid.reshape(len(grid), -1)
    merge(extra, owner, flat)
    return _Spread(keys, own, flat[: len(keys)])


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
