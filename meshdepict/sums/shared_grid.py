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
from meshdepict.sums.block_layout import Cells
from meshdepict.sums.grid_sums import PointGrid, _far, _Spread
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
    grid = _Shared(points, channels, width, rule)
    spread = grid.spread()
    values = spread.grid.reshape(-1, BLOCK**3 * len(channels))[: len(spread.keys)]
    return Blocks(grid.places(spread.keys), values.copy())


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
    grid = _Shared(points, np.zeros((channels, len(points))), width, rule)
    wanted = grid.wanted()
    span = grid.places(wanted)
    # Only blocks within reach have a key here: others might share one with these.
    far = _far(rule, rule.density)
    first, last = span.min(axis=0) - far, span.max(axis=0) + far
    found = []
    for part in parts:
        inside = ((part.places >= first) & (part.places <= last)).all(axis=1)
        found.append((grid.keys(part.places[inside]), part.values[inside]))
    keys = np.unique(np.concatenate([wanted, *(key for key, _ in found)]))
    return grid.gathered(keys, found)


class _Shared(PointGrid):
    """A grid whose blocks stand where everybody has them.

    Parameters
    ----------
    points : (n, 3) array
    channels : (c, n) array
    width : float
    rule : Rule
    """

    def __init__(
        self, points: NDArray[np.float64], channels: NDArray[Any], width: float, rule: Rule
    ) -> None:
        self._width, spacing = width, width / rule.density
        side = BLOCK * spacing
        self._first = np.floor(points.min(axis=0) / side).astype(np.int64)
        super().__init__(OrderedPoints(points, channels), origin=self._first * side)
        self._sort = self._sorted(spacing, rule)

    @property
    def _cells(self) -> Cells:
        return self._sort.cells

    def places(self, keys: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the places (k, 3) that keys stand for, counted from the origin."""
        z, rest = np.divmod(keys, self._cells.step[2])
        y, x = np.divmod(rest, self._cells.step[1])
        found: NDArray[np.int64] = np.stack([x, y, z], axis=1) + self._cells.low + self._first
        return found

    def keys(self, places: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the keys of places."""
        found: NDArray[np.int64] = (places - self._first - self._cells.low) @ self._cells.step
        return found

    def wanted(self) -> NDArray[np.int64]:
        """Return the keys of the blocks that points are gathered from."""
        return self._sort.touched(0, len(self._cells.keys))[0]

    def spread(self) -> _Spread:
        """Spread all points."""
        return self._spread(self._sort, 0, len(self._cells.keys))

    def gathered(
        self,
        keys: NDArray[np.int64],
        parts: Iterable[tuple[NDArray[np.int64], NDArray[np.float32]]],
    ) -> NDArray[np.float32]:
        """Return sums (c, n) of parts, keys and the values of their blocks, at all points."""
        count, channels = self._shape
        size = BLOCK**3 * channels
        flat = self._memory(0, len(keys) * size)
        flat[:] = 0
        blocks = flat.reshape(-1, size)
        for some, values in parts:
            blocks[np.searchsorted(keys, some)] += values  # of one part, each block once
        sums = np.zeros((count, channels), np.float32)
        cells = 0, len(self._cells.keys)
        spread = _Spread(keys, np.empty((0, 8), np.int32), flat)
        self._gather(self._sort, spread, cells, self._width, None, sums)
        return sums.T
