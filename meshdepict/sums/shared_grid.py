"""Gaussian sums over points that lie in several places: each spreads its own, whoever gathers.

The grid is that of `grid_sums`, but its nodes stand where everybody has them, and so blocks of
several processes add up. They are few where widths are wide, however many the points.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.sums.bells import RULES, Rule
from meshdepict.sums.block_kernels import BLOCK
from meshdepict.sums.grid_sums import _CORNERS, PointGrid, _far, _Sorted, _Spread
from meshdepict.sums.lanes import WIDE
from meshdepict.sums.ordered_points import OrderedPoints

__all__ = ["FINEST", "Blocks", "block_reach", "gathered_sums", "spread_blocks"]

FINEST = RULES[-1]
"""The rule of the least error."""


class Blocks(NamedTuple):
    """Blocks of nodes on which points were spread.

    Attributes
    ----------
    places : (k, 3) array of int64
        Counted from the origin of all coordinates.
    values : (k, m) array of float32
        The channels of their nodes.
    """

    places: NDArray[np.int64]
    values: NDArray[np.float32]


def spread_blocks(
    points: NDArray[np.float64], channels: NDArray[Any], width: float, rule: Rule = FINEST
) -> Blocks:
    """Spread points (n, 3) with channels (c, n) for a Gaussian of a width."""
    own = _Placed(points, channels, width, rule)
    sort = own.sorted()
    spread = own._spread(sort, 0, len(sort.cells.keys))
    places = sort.cells._replace(keys=spread.keys).places(0, len(spread.keys))
    return Blocks(places + own.base, spread.grid.reshape(-1, own.numbers)[: len(places)].copy())


def block_reach(width: float, rule: Rule = FINEST) -> tuple[float, float]:
    """Return the size of a block, and how far from a point there are blocks that its sum needs."""
    spacing = width / rule.density
    side = BLOCK * spacing
    return side, side * (_far(rule, rule.density) + 2)


def gathered_sums(
    points: NDArray[np.float64],
    channels: int,
    width: float,
    parts: Iterable[Blocks],
    rule: Rule = FINEST,
) -> NDArray[np.float32]:
    """Return sums (channels, n) at points, of all that was spread.

    Parameters
    ----------
    points : (n, 3) array
    channels : int
    width : float
    parts : iterable of Blocks
        In an order that is always the same; those beyond reach may be missing.
    rule : Rule
    """
    own = _Placed(points, np.zeros((channels, len(points))), width, rule)
    sort = own.sorted()
    step, low = sort.cells.step, sort.cells.low + own.base
    wanted, _ = sort.touched(0, len(sort.cells.keys))
    span = sort.cells._replace(keys=wanted).places(0, len(wanted)) - sort.cells.low
    # Only blocks within reach have a key here: others might share one with these.
    far = _far(rule, rule.density)
    first, last = span.min(axis=0) - far, span.max(axis=0) + far
    found = []
    for part in parts:
        near = part.places - low
        inside = ((near >= first) & (near <= last)).all(axis=1)
        found.append((near[inside] @ step, part.values[inside]))
    keys = np.unique(np.concatenate([wanted, *(key for key, _ in found)]))
    flat = np.zeros(len(keys) * own.numbers + WIDE, np.float32)
    grid = flat[: len(keys) * own.numbers].reshape(-1, own.numbers)
    for key, values in found:
        grid[np.searchsorted(keys, key)] += values  # of one part, each block once
    slots = np.searchsorted(keys, sort.cells.keys[:, None] + _CORNERS @ step).astype(np.int32)
    sums = np.zeros((len(points), channels), np.float32)
    spread = _Spread(keys, slots, grid.reshape(-1))
    own._gather(sort, spread, (0, len(sort.cells.keys)), width, None, sums)
    return sums.T


class _Placed(PointGrid):
    """Points on a grid whose nodes stand where they stand for all.

    Attributes
    ----------
    base : (3,) array of int64
        Blocks from the origin of all coordinates to that of these points.
    numbers : int
        Of a block.
    """

    def __init__(
        self, points: NDArray[np.float64], channels: NDArray[Any], width: float, rule: Rule
    ) -> None:
        super().__init__(OrderedPoints(points, channels))
        self._spacing, self._rule = width / rule.density, rule
        side = BLOCK * self._spacing
        self.base = np.floor(points.min(axis=0) / side).astype(np.int64)
        self.numbers = BLOCK**3 * len(channels)
        self._points = (points - self.base * side)[self._order]

    def sorted(self) -> _Sorted:
        """Return the points in the order of their blocks."""
        return self._sorted(self._spacing, self._rule)
