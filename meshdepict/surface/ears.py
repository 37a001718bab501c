"""Ears of one large polygon in the plane, clipped in a time that grows little faster than its size.

`polygons` clips many small polygons side by side and takes the best ear each time, which costs the
square of the corners. Here ears go round by round, and only reflex corners near an ear are asked
whether they lie in it: those in its cells of a grid.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import kernel

__all__ = ["clip_large"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def clip_large(flat: Floats) -> Ints:
    """Return the (k − 2, 3) corner numbers of triangles that make up a polygon.

    Parameters
    ----------
    flat : (k, 2) array
        Counter-clockwise. Where edges cross, triangles may overlap; there are k − 2 all the same.
    """
    count = len(flat)
    low, high = flat.min(axis=0), flat.max(axis=0)
    side = max(int(np.sqrt(count)), 1)
    size = np.where(high > low, (high - low) / side, 1.0)
    cell = np.minimum(((flat - low) / size).astype(np.int64), side - 1)
    key = cell[:, 0] * side + cell[:, 1]
    order = np.argsort(key, kind="stable")
    start = np.searchsorted(key[order], np.arange(side * side + 1))
    triangles = np.empty((count - 2, 3), np.int64)
    _clip(np.ascontiguousarray(flat), low, size, side, order, start, triangles)
    return triangles


@kernel()
def _clip(
    flat: Floats, low: Floats, size: Floats, side: int, order: Ints, start: Ints, triangles: Ints
) -> None:
    count = len(flat)
    after, before = np.empty(count, np.int64), np.empty(count, np.int64)
    reflex, gone = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    for i in range(count):
        after[i], before[i] = (i + 1) % count, (i - 1) % count
    for i in range(count):
        reflex[i] = _turn(flat, before[i], i, after[i]) < 0
    # What changes by clipping an ear are its neighbours: they are asked in the next round. (At
    # once, a fan of needles would come of it.) Where nobody is left to ask, all are asked again,
    # since an ear is also freed by what vanished from inside it.
    # Kinds: 0 asks for true ears, 1 for convex corners, 2 for any. Where all were asked in vain,
    # the next kind is right for good: such a polygon crosses itself, and nothing is.
    kind = 0
    made, at = 0, 0
    asked, later = np.empty(count, np.int64), np.empty(count, np.int64)
    changed = np.zeros(count, np.int64)  # the round in which a neighbour was clipped
    waiting, number = 0, 0
    while made < count - 3:
        everybody = waiting == 0
        if everybody:
            for _ in range(count - made):
                asked[waiting] = at
                waiting += 1
                at = after[at]
        number += 1
        fresh, first = 0, made
        for turn in range(waiting):
            b = asked[turn]
            if gone[b] or changed[b] == number or made == count - 3:
                continue
            a, c = before[b], after[b]
            if not _is_ear(flat, low, size, side, order, start, reflex, gone, a, b, c, kind):
                continue
            triangles[made, 0], triangles[made, 1], triangles[made, 2] = a, b, c
            made += 1
            gone[b] = True
            after[a], before[c] = c, a
            for end in (a, c):
                if reflex[end]:
                    reflex[end] = _turn(flat, before[end], end, after[end]) < 0
                if changed[end] != number:
                    changed[end] = number
                    later[fresh] = end
                    fresh += 1
            at = a
        if everybody and made == first:
            kind += 1
        asked, later, waiting = later, asked, fresh
    triangles[made, 0], triangles[made, 1], triangles[made, 2] = before[at], at, after[at]


@kernel()
def _is_ear(
    flat: Floats,
    low: Floats,
    size: Floats,
    side: int,
    order: Ints,
    start: Ints,
    reflex: NDArray[np.bool_],
    gone: NDArray[np.bool_],
    a: int,
    b: int,
    c: int,
    kind: int,
) -> bool:
    doubled = _turn(flat, a, b, c)
    if kind > 0 or doubled <= 0:  # a corner on a straight line is harmless to clip
        return kind == 2 or doubled >= 0
    i0, i1 = _span(flat[a, 0], flat[b, 0], flat[c, 0], low[0], size[0], side)
    j0, j1 = _span(flat[a, 1], flat[b, 1], flat[c, 1], low[1], size[1], side)
    for i in range(i0, i1 + 1):
        for place in range(start[i * side + j0], start[i * side + j1 + 1]):
            other = order[place]
            if not reflex[other] or gone[other] or other in (a, c):
                continue
            if _same(flat, other, a) or _same(flat, other, b) or _same(flat, other, c):
                continue
            if (
                _turn(flat, a, b, other) >= 0
                and _turn(flat, b, c, other) >= 0
                and _turn(flat, c, a, other) >= 0
            ):
                return False
    return True


@kernel()
def _span(a: float, b: float, c: float, low: float, size: float, side: int) -> tuple[int, int]:
    """Return the first and the last of the cells that three coordinates span."""
    first, last = int((min(a, b, c) - low) / size), int((max(a, b, c) - low) / size)
    return min(first, side - 1), min(last, side - 1)


@kernel()
def _turn(flat: Floats, a: int, b: int, c: int) -> float:
    """Return twice the signed area of the triangle (a, b, c)."""
    return (flat[b, 0] - flat[a, 0]) * (flat[c, 1] - flat[a, 1]) - (flat[b, 1] - flat[a, 1]) * (
        flat[c, 0] - flat[a, 0]
    )


@kernel()
def _same(flat: Floats, a: int, b: int) -> bool:
    return bool(flat[a, 0] == flat[b, 0] and flat[a, 1] == flat[b, 1])
