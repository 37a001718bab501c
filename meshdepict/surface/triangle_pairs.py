"""An atlas for any triangles: two in each cell, cells of a few sizes in rows of the square.

Legs and hypotenuses run through centres of texels, so that bilinear filters need but one texel
beyond them. No two triangles touch; a texel lies between them at least, mostly two. Pictures of
this kind are read without mipmaps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["LEAST_CELL", "least_size", "paired"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_CELL = 6
"""Texels along the side of a cell whose triangles have two texels along each leg."""

_SIZES = 2.0 ** (np.arange(97) / 8)  # of cells, rounded: 9 % apart
_NARROW = 4  # a needle counts as no less than its longest side by so much
_ROUNDS = 40


def paired(points: Floats, faces: Ints, size: int) -> Floats:
    """Return texture coordinates (m, 3, 2) in which every triangle has a place of its own.

    A triangle's place is about as large as it is, a right-angled one that faces the same way; the
    right angle is opposite to its longest side.

    Parameters
    ----------
    points : (n, 3) array
    faces : (m, 3) array of int
    size : int
        Texels along the side of the square.

    Raises
    ------
    MeshdepictError
        Where the square hasn't room for so many.
    """
    count = len(faces)
    if -(-count // 2) > (size // LEAST_CELL) ** 2:
        raise MeshdepictError(
            f"{count:,} triangles have no room on {size:,} x {size:,} texels: take --size "
            f"{least_size(count)} at least, or colours at vertices (meshdepict bake)"
        )
    corners = points[faces]
    sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)  # 01, 12, 20
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    length = np.maximum(np.sqrt(area), sides.max(axis=1) / _NARROW)
    order = np.argsort(-length, kind="stable")
    wanted = length[order[::2]]
    side = _fitting(wanted, size)
    x, y = _places(side, size)
    # In texels from the square's upper left corner: centres lie at whole numbers.
    extra = side // 16  # antialiasing reads beyond edges, the farther the larger the cell
    leg = (side - 5 - 4 * extra).astype(np.float64)
    zero = np.zeros(len(leg))
    right = np.stack([zero, leg, zero], axis=1), np.stack([zero, zero, leg], axis=1)
    cell = np.arange(count) // 2
    second = np.arange(count) % 2 == 1
    turn = np.where(second, -1, 1)[:, None]
    start = np.where(second, (side - 2 - extra)[cell], (1 + extra)[cell])
    across = x[cell][:, None] + start[:, None] + turn * right[0][cell]
    down = y[cell][:, None] + start[:, None] + turn * right[1][cell]
    found = np.empty((count, 3, 2))
    # First the corner opposite to the longest side; downwards rows turn the picture over.
    first = (sides[order].argmax(axis=1) + 2) % 3
    for k, step in enumerate((0, 2, 1)):
        corner = (first + step) % 3
        found[order, corner, 0] = (across[:, k] + 0.5) / size
        found[order, corner, 1] = 1 - (down[:, k] + 0.5) / size
    return found


def least_size(count: int) -> int:
    """Return the smallest power of two along the side of a square where so many have room."""
    needed = LEAST_CELL * int(np.ceil(np.sqrt(-(-count // 2))))
    return 1 << (needed - 1).bit_length()


def _fitting(wanted: Floats, size: int) -> Ints:
    """Return sides of cells, descending, about in proportion to lengths, that fill the square."""
    sizes = np.unique(np.rint(LEAST_CELL * _SIZES).astype(np.int64))
    sizes = sizes[sizes <= max(size, LEAST_CELL)]

    def at(density: float) -> Ints:
        place = np.searchsorted(sizes, wanted * density, side="right") - 1
        return np.asarray(sizes[np.maximum(place, 0)])

    longest = float(wanted.max(initial=0.0))
    if longest == 0:
        wanted = np.ones_like(wanted)
        longest = 1.0
    low, high = 0.0, 2 * size / longest
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        low, high = (middle, high) if _height(at(middle), size) <= size else (low, middle)
    return at(low)


def _height(side: Ints, size: int) -> int:
    """Return how many texels high the rows of cells are."""
    found, counts = np.unique(side, return_counts=True)
    return int((-(-counts // (size // found)) * found).sum())


def _places(side: Ints, size: int) -> tuple[Ints, Ints]:
    """Return the upper left texel of each cell."""
    x, y = np.empty_like(side), np.empty_like(side)
    top = 0
    for one in np.unique(side)[::-1]:
        chosen = np.flatnonzero(side == one)
        number = np.arange(len(chosen))
        columns = size // one
        x[chosen], y[chosen] = number % columns * one, top + number // columns * one
        top += -(-len(chosen) // columns) * one
    return x, y
