"""Texels of an atlas: which of them lie in which triangle, and where in it.

Corners are snapped to a fine grid and compared in whole numbers. So no texel of two triangles that
share an edge belongs to both or to neither, however long and thin they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.threads import kernel

__all__ = ["Claims", "TexelGrid", "Texels"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_STEPS = 1024  # of a texel's side, to which corners are snapped
_FURTHEST = 16  # squares that coordinates may lie from the first: products stay within 63 bits


class Texels(NamedTuple):
    """Texels that lie in triangles.

    Attributes
    ----------
    place : (n,) array of int32
        Numbers in the rows that were asked for: row by row, from the left.
    triangle : (n,) array of int32
    weights : (n, 3) array of float32
        Barycentric coordinates of their centres.
    """

    place: NDArray[np.int32]
    triangle: NDArray[np.int32]
    weights: NDArray[np.float32]


class Claims(NamedTuple):
    """How triangles share an atlas.

    Attributes
    ----------
    counts : (m,) array of int64
        Texels of each triangle.
    shared : int
        Texels that lie in several.
    disputed : (m,) array of bool
        Triangles that others came before, somewhere.
    """

    counts: Ints
    shared: int
    disputed: NDArray[np.bool_]

    def __add__(self, other: object) -> Claims:
        """Return the claims on the rows of both."""
        assert isinstance(other, Claims)
        return Claims(
            self.counts + other.counts, self.shared + other.shared, self.disputed | other.disputed
        )


class TexelGrid:
    """The texels of a square picture, and the triangles that lie on it.

    A texel belongs to the triangle that its centre lies in; on a border to one of the two
    neighbours. Coordinates beyond [0, 1] wrap, as in a picture that repeats. Of triangles that
    overlap the first has the texel. A triangle in which no centre lies has the texel at its middle,
    unless that is another's.

    Parameters
    ----------
    texcoords : (m, 3, 2) array
        Finite; u to the right, v up.
    size : int
        Texels along a side.
    closed : bool
        Whether borders belong to every triangle: where none touch.

    Raises
    ------
    MeshdepictError
        For coordinates far outside.
    """

    def __init__(self, texcoords: Floats, size: int, *, closed: bool = False) -> None:
        if len(texcoords) and np.abs(texcoords).max() > _FURTHEST:
            worst = int(np.abs(texcoords).reshape(len(texcoords), -1).max(axis=1).argmax())
            raise MeshdepictError(
                f"texture coordinates reach as far as {np.abs(texcoords).max():.4g} (triangle "
                f"{worst:,}), and an atlas lies between 0 and 1: let a new one be made "
                "(--atlas new)"
            )
        self.size, self.closed = size, closed
        # Centres of texels at whole numbers, rows downwards.
        across = texcoords[..., 0] * size - 0.5
        down = (1 - texcoords[..., 1]) * size - 0.5
        self._x = np.rint(across * _STEPS).astype(np.int64)
        self._y = np.rint(down * _STEPS).astype(np.int64)
        self._empty = np.zeros(len(texcoords), bool)

    @property
    def excess(self) -> float:
        """How many times the triangles' areas fill the square; above 1 they must overlap."""
        x, y = self._x.astype(np.float64), self._y.astype(np.float64)
        double = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (y[:, 1] - y[:, 0]) * (
            x[:, 2] - x[:, 0]
        )
        return float(np.abs(double).sum() / 2 / (self.size * _STEPS) ** 2)

    def claims(self, begin: int, end: int) -> Claims:
        """Return who has texels in some rows."""
        _, _, claims = self._claimed(begin, end)
        return claims

    def fill_in(self, claims: Claims) -> None:
        """Let triangles without any texel of the whole picture have the one at their middle."""
        self._empty = claims.counts == 0

    def texels(self, begin: int, end: int) -> Texels:
        """Return the texels of the rows from one to before another."""
        owner, shares, _ = self._claimed(begin, end)
        if self._empty.any():
            _claim_middles(
                self._x, self._y, self._empty, self.size, _STEPS, begin, end, owner, shares
            )
        count = int(np.count_nonzero(owner >= 0))
        found = Texels(
            np.empty(count, np.int32), np.empty(count, np.int32), np.empty((count, 3), np.float32)
        )
        _gather(owner, shares, *found)
        return found

    def _claimed(
        self, begin: int, end: int
    ) -> tuple[NDArray[np.int32], NDArray[np.float32], Claims]:
        owner = np.full((end - begin) * self.size, -1, np.int32)
        shares = np.empty((len(owner), 2), np.float32)
        counts, disputed = np.zeros(len(self._x), np.int64), np.zeros(len(self._x), bool)
        shared = _claim(
            self._x, self._y, self.size, _STEPS, begin, end, self.closed, owner, shares, counts,
            disputed,
        )  # fmt: skip
        return owner, shares, Claims(counts, int(shared), disputed)


@kernel()
def _claim(x, y, size, steps, begin, end, closed, owner, shares, counts, disputed):  # type: ignore[no-untyped-def]
    """Give the texels of rows [begin, end) to the first triangle that each lies in."""
    shared = 0
    for t in range(len(x)):
        low, high = min(y[t, 0], y[t, 1], y[t, 2]), max(y[t, 0], y[t, 1], y[t, 2])
        first, last = -((-low) // steps), high // steps  # rows whose centres are between
        if first > last:
            continue
        second, third = 1, 2
        area = (x[t, 1] - x[t, 0]) * (y[t, 2] - y[t, 0]) - (y[t, 1] - y[t, 0]) * (x[t, 2] - x[t, 0])
        if area == 0:
            continue
        if area < 0:
            second, third, area = 2, 1, -area
        for copy in range(first // size, last // size + 1):
            for row in range(max(first, begin + copy * size), min(last, end - 1 + copy * size) + 1):
                left, right = np.int64(-(2**40)), np.int64(2**40)
                for side in range(3):
                    p = 0 if side == 0 else (second if side == 1 else third)
                    q = second if side == 0 else (third if side == 1 else 0)
                    dx, dy = x[t, q] - x[t, p], y[t, q] - y[t, p]
                    # Inside is where dx (Y − y) − dy (X − x) ≥ 0; > 0 where the neighbour has it.
                    least = dx * (row * steps - y[t, p]) + dy * x[t, p]
                    if not (closed or dy > 0 or (dy == 0 and dx > 0)):
                        least -= 1
                    if dy > 0:
                        right = min(right, least // (steps * dy))
                    elif dy < 0:
                        left = max(left, -(least // (-steps * dy)))
                    elif least < 0:
                        right = left - 1
                if left > right:
                    continue
                here = (row - copy * size - begin) * size
                # Twice the areas opposite to the second and the third corner, and their steps.
                dx2, dy2 = x[t, 0] - x[t, third], y[t, 0] - y[t, third]
                dx3, dy3 = x[t, second] - x[t, 0], y[t, second] - y[t, 0]
                whole = 1.0 / area
                for column in range(left, right + 1):
                    i = here + column % size
                    if owner[i] >= 0:
                        shared += 1
                        disputed[t] = True
                        continue
                    px, py = column * steps, row * steps
                    e2 = dx2 * (py - y[t, third]) - dy2 * (px - x[t, third])
                    e3 = dx3 * (py - y[t, 0]) - dy3 * (px - x[t, 0])
                    owner[i] = t
                    shares[i, second - 1] = e2 * whole
                    shares[i, third - 1] = e3 * whole
                    counts[t] += 1
    return shared


@kernel()
def _claim_middles(x, y, empty, size, steps, begin, end, owner, shares):  # type: ignore[no-untyped-def]
    """Give triangles without a texel the one at their middle, if nobody has it."""
    for t in range(len(x)):
        if empty[t]:
            column = (2 * (x[t, 0] + x[t, 1] + x[t, 2]) + 3 * steps) // (6 * steps) % size
            row = (2 * (y[t, 0] + y[t, 1] + y[t, 2]) + 3 * steps) // (6 * steps) % size
            if begin <= row < end and owner[(row - begin) * size + column] < 0:
                owner[(row - begin) * size + column] = t
                shares[(row - begin) * size + column] = np.float32(1 / 3)


@kernel()
def _gather(owner, shares, place, triangle, weights):  # type: ignore[no-untyped-def]
    n = 0
    for i in range(len(owner)):
        if owner[i] >= 0:
            place[n], triangle[n] = i, owner[i]
            second = min(max(shares[i, 0], np.float32(0)), np.float32(1))
            third = min(max(shares[i, 1], np.float32(0)), np.float32(1) - second)
            weights[n, 0] = max(np.float32(1) - second - third, np.float32(0))
            weights[n, 1], weights[n, 2] = second, third
            n += 1
