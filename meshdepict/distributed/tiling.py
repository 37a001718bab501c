"""How a mesh that nobody has as a whole is cut into boxes of about equally many vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

__all__ = ["SIDE", "Extent", "cell_of", "cut", "ranges"]

SIDE = 128
"""Cells along each axis, of which tiles are made."""


@dataclass(frozen=True)
class Extent:
    """Where a mesh lies: a shape as far as the eye is concerned.

    Attributes
    ----------
    low, high : (3,) arrays
        Of the box about it.
    outline : (k, 3) array
        Vertices that lie furthest out in all directions that the eye asks for.
    identity : str
    edge_length : float
        0 where nobody has asked for it.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    outline: NDArray[np.float64]
    identity: str = ""
    edge_length: float = 0.0
    length_unit: str = ""
    kind: str = "mesh"

    @cached_property
    def centre(self) -> NDArray[np.float64]:
        """(3,) middle of the box."""
        return self.low / 2 + self.high / 2

    @cached_property
    def diagonal(self) -> float:
        """Its diagonal."""
        extent = self.high - self.low
        largest = float(extent.max())
        return largest and largest * float(np.linalg.norm(extent / largest))

    def recentred(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return positions (…, 3) relative to the centre, in diagonals."""
        moved: NDArray[np.float64] = (points - self.centre) / (self.diagonal or 1.0)
        return moved


def ranges(count: int, length: int) -> Iterator[slice]:
    """Cut so many rows into ranges."""
    for start in range(0, count, length):
        yield slice(start, min(start + length, count))


def cell_of(points: NDArray[np.float64], extent: Extent) -> NDArray[np.int64]:
    """Return the cell (n,) that each point lies in, of SIDE³."""
    longest = float((extent.high - extent.low).max()) or 1.0
    place = ((points - extent.low) * (SIDE / longest)).astype(np.int64)
    x, y, z = np.clip(place, 0, SIDE - 1).T
    cell: NDArray[np.int64] = (x * SIDE + y) * SIDE + z
    return cell


def cut(count: NDArray[np.int64], most: int) -> NDArray[np.int32]:
    """Return the tile of each cell, tiles being boxes of cells.

    Boxes are halved across their longest axis where the points are halved, until none has more
    points than allowed, or it is a single cell.

    Parameters
    ----------
    count : (SIDE³,) array
        Points of each cell.
    most : int
        Points of a tile.
    """
    grid = count.reshape(SIDE, SIDE, SIDE)
    tiles = np.zeros(grid.shape, np.int32)
    waiting: list[tuple[slice, ...]] = [(slice(0, SIDE),) * 3]
    number = 0
    while waiting:
        box = _shrunk(grid, waiting.pop())
        if box is None:
            continue
        sizes = [part.stop - part.start for part in box]
        axis = int(np.argmax(sizes))
        if grid[box].sum() <= most or sizes[axis] == 1:
            tiles[box] = number
            number += 1
            continue
        along = grid[box].sum(axis=tuple(other for other in range(3) if other != axis))
        halves = np.cumsum(along)[:-1]
        at = box[axis].start + 1 + int(np.argmin(np.abs(halves - along.sum() / 2)))
        before, after = list(box), list(box)
        before[axis], after[axis] = slice(box[axis].start, at), slice(at, box[axis].stop)
        waiting += [tuple(after), tuple(before)]
    return tiles.reshape(-1)


def _shrunk(grid: NDArray[np.int64], box: tuple[slice, ...]) -> tuple[slice, slice, slice] | None:
    """Return the part of a box that has points, None where none has."""
    some = grid[box] > 0
    if not some.any():
        return None
    found = []
    for axis, part in enumerate(box):
        at = np.flatnonzero(some.any(axis=tuple(other for other in range(3) if other != axis)))
        found.append(slice(part.start + int(at[0]), part.start + int(at[-1]) + 1))
    return found[0], found[1], found[2]
