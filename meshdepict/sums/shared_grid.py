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
from meshdepict.sums.block_layout import cells, morton_order
from meshdepict.sums.grid_sums import _CORNERS, _ROOM, PointGrid, _far, _Points, _Spread, _spread

__all__ = ["FINEST", "Blocks", "block_reach", "gathered_sums", "spread_blocks"]

FINEST = RULES[-1]
"""The rule of the least error."""

_NEAR = 1 - 2.0**-22


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
    placed, low = _placed(points, channels, width, rule)
    spread = _spread(placed, 0, len(placed.cells.keys))
    return Blocks(_places(spread.keys, placed.cells.step) + low, spread.grid)


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
    placed, low = _placed(points, np.zeros((channels, len(points))), width, rule)
    step = placed.cells.step
    wanted, _ = placed.touched(0, len(placed.cells.keys))
    span = _places(wanted, step)
    # Only blocks within reach have a key here: others might share one with these.
    far = _far(rule, rule.density)
    first, last = span.min(axis=0) - far, span.max(axis=0) + far
    found = []
    for part in parts:
        near = part.places - low
        inside = ((near >= first) & (near <= last)).all(axis=1)
        found.append((near[inside] @ step, part.values[inside]))
    keys = np.unique(np.concatenate([wanted, *(key for key, _ in found)]))
    grid = np.zeros((len(keys), BLOCK**3 * channels), np.float32)
    for key, values in found:
        grid[np.searchsorted(keys, key)] += values  # of one part, each block once
    slots = np.searchsorted(keys, placed.cells.keys[:, None] + _CORNERS @ step).astype(np.int32)
    sums = np.zeros((channels, len(points)), np.float32)
    _Gathering().gather_all(placed, _Spread(keys, slots, grid), width, sums)
    return sums


class _Gathering(PointGrid):
    """The half of a grid that gathers."""

    def __init__(self) -> None:
        self._scratch = [np.empty((0, 0), np.float32)] * 2

    def gather_all(
        self, placed: _Points, spread: _Spread, width: float, sums: NDArray[np.float32]
    ) -> None:
        """Fill the sums at all points."""
        self._gather(placed, spread, (0, len(placed.cells.keys)), width, None, sums)


def _placed(
    points: NDArray[np.float64], channels: NDArray[Any], width: float, rule: Rule
) -> tuple[_Points, NDArray[np.int64]]:
    """Return points in the order of their blocks, and the place that keys are counted from."""
    spacing = width / rule.density
    low = points.min(axis=0)
    longest = float((points.max(axis=0) - low).max()) or 1.0
    order = morton_order(np.minimum((points - low).T / longest, _NEAR))
    along = points[order] / spacing - (rule.nodes / 2 - 1)
    first = np.floor(along)
    nodes = first.astype(np.int64)
    block = nodes // BLOCK
    corner = block.min(axis=0) - _ROOM
    found = cells((block - corner - _ROOM).astype(np.int32), _ROOM)
    sort = found.order
    values = np.ascontiguousarray(channels.T[order], np.float32)
    local = (nodes - BLOCK * block)[sort].astype(np.int32)
    shares = (along - first).astype(np.float32)[sort]
    return _Points(spacing, rule, order[sort], shares, local, values[sort], found), corner


def _places(keys: NDArray[np.int64], step: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the places (k, 3) that keys stand for."""
    z, rest = np.divmod(keys, step[2])
    y, x = np.divmod(rest, step[1])
    return np.stack([x, y, z], axis=1)
