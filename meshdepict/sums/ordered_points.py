"""Points in an order in which sixteen after one another are near each other, and their channels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.sums.lanes import WIDE
from meshdepict.threads import each, kernel

__all__ = ["OrderedPoints"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SERIAL = 4  # times all points are halved before threads go on with the parts


class OrderedPoints:
    """Points halved across their longest side, again and again, down to groups of `WIDE`.

    Parameters
    ----------
    points : (n, 3) array
        Near the origin.
    channels : (c, n) array

    Attributes
    ----------
    order : (n,) array
    points : (n, 3) array
        In that order.
    channels : (c, n) array
        As they were given.
    rows : (n, c) array of float32
        The channels in that order.
    """

    def __init__(self, points: Floats, channels: NDArray[Any]) -> None:
        self.channels = channels
        self.order: Ints = np.arange(len(points))
        keys = np.empty(len(points))
        parts = [(0, len(points))]
        for _ in range(_SERIAL):
            cuts = [(a, _halved(points, self.order, keys, a, b), b) for a, b in parts]
            parts = [part for a, cut, b in cuts for part in ((a, cut), (cut, b)) if part[0] < b]
        each(lambda a, b: _grouped(points, self.order, keys, a, b), parts)
        self.points = points[self.order]
        self.rows = np.empty((len(points), len(channels)), np.float32)
        for row, channel in zip(self.rows.T, channels, strict=True):
            row[:] = channel[self.order]


@kernel()
def _halved(points, order, keys, begin, end):  # type: ignore[no-untyped-def]
    """Sort points [begin, end) into two halves, and return where the second begins.

    Across the longest side; the first has so many whole groups. Of no more than a group the second
    half is empty.
    """
    groups = -(-(end - begin) // WIDE)
    if groups <= 1:
        return end
    axis, longest = 0, -1.0
    for a in range(3):
        low = high = points[order[begin], a]
        for i in range(begin + 1, end):
            low = min(low, points[order[i], a])
            high = max(high, points[order[i], a])
        if high - low > longest:
            axis, longest = a, high - low
    for i in range(begin, end):
        keys[i] = points[order[i], axis]
    cut = begin + groups // 2 * WIDE
    low, high = begin, end - 1
    while low < high:  # Hoare's selection
        one, two, three = keys[low], keys[(low + high) // 2], keys[high]
        pivot = max(min(one, two), min(max(one, two), three))
        i, j = low, high
        while i <= j:
            while keys[i] < pivot:
                i += 1
            while keys[j] > pivot:
                j -= 1
            if i <= j:
                keys[i], keys[j] = keys[j], keys[i]
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if cut <= j:
            high = j
        elif cut >= i:
            low = i
        else:
            break
    return cut


@kernel()
def _grouped(points, order, keys, begin, end):  # type: ignore[no-untyped-def]
    """Halve points [begin, end) down to groups."""
    ends = np.empty(64, np.int64)
    count = 1
    ends[0] = end
    while count > 0:
        cut = _halved(points, order, keys, begin, ends[count - 1])
        if cut == ends[count - 1]:
            begin = cut
            count -= 1
        else:
            ends[count] = cut
            count += 1
