"""Gaps as wide as rounding: corners that are one point of the surface but not bit for bit.

Programs that turn, scale or print each triangle by itself leave them. Shading needs neighbours, so
such corners are brought together for it; the vertices of the mesh stay as they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected
from meshdepict.surface.edges import edge_keys
from meshdepict.surface.welding import same_position

__all__ = ["Closed", "closed_gaps"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Numbers of five digits are off by so much of the size, and what is turned by numbers of six …
_ROUNDING = 1e-5
# … but corners are only taken for one where their faces are this many times larger than the gap.
_LARGER = 50
_FELLOWS = 16  # corners at one point that are linked at once; more are linked by one another


class Closed(NamedTuple):
    """Points with the corners along gaps brought together."""

    points: Floats  # (n, 3)
    corners: int  # positions that were brought together
    widest: float  # gap that was closed


def closed_gaps(points: Floats, faces: Ints, *, rounding: float = 0.0) -> Closed | None:
    """Bring corners together that lie at open edges, apart by no more than rounding.

    Parameters
    ----------
    points : (n, 3) array
        In a box with a diagonal of one.
    faces : (m, 3) array of int
    rounding : float
        How far off the coordinates are by their type and their distance from the origin.

    Returns
    -------
    Closed or None
        None where there are no such gaps.
    """
    n = len(points)
    label = same_position(points)
    if label is not None:
        first = np.empty(n, np.int64)
        first[label[::-1]] = np.arange(n)[::-1]  # the first at each position is written last
        label = first[label]
        faces = label[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    key, count = edge_keys(faces, n)
    rim = np.unique(np.divmod(key[count == 1], n))
    if len(rim) == 0:
        return None
    links = _links(points[rim], _shortest(points, key, rim), max(_ROUNDING, rounding))
    if links is None:
        return None
    i, j, widest = links
    part = connected(len(rim), i, j)
    leader = np.empty(len(rim), np.int64)
    leader[part[::-1]] = np.arange(len(rim))[::-1]
    leader = leader[part]
    moved = points.copy()
    moved[rim] = points[rim[leader]]
    if label is not None:
        moved = moved[label]
    return Closed(moved, int(np.count_nonzero(np.bincount(part)[part] > 1)), widest)


def _shortest(points: Floats, key: Ints, rim: Ints) -> Floats:
    """Return the length of the shortest edge at each of some vertices."""
    n = len(points)
    shortest = np.zeros(n)
    shortest[rim] = np.inf
    a, b = np.divmod(key, n)
    near = (shortest[a] > 0) | (shortest[b] > 0)
    a, b = a[near], b[near]
    length = np.linalg.norm(points[a] - points[b], axis=1)
    np.minimum.at(shortest, a, length)
    np.minimum.at(shortest, b, length)
    return shortest[rim]


def _links(points: Floats, shortest: Floats, bound: float) -> tuple[Ints, Ints, float] | None:
    """Return pairs of points that are as good as one, and how far apart they are at most."""
    company = _in_company(points, bound)
    if len(company) < 2:
        return None
    if len(company) < len(points):
        links = _links(points[company], shortest[company], bound)
        return links and (company[links[0]], company[links[1]], links[2])
    from scipy.spatial import cKDTree

    radius = np.minimum(bound, shortest / _LARGER)
    tree = cKDTree(points)
    # The first of the two is the point itself.
    nearest = np.asarray(tree.query(points, k=2, distance_upper_bound=bound)[0])
    with_fellows = np.flatnonzero(nearest[:, 1] <= radius)
    if len(with_fellows) == 0:
        return None
    fellows = min(_FELLOWS, len(points))
    away, j = tree.query(points[with_fellows], k=fellows, distance_upper_bound=bound)
    i = np.repeat(with_fellows, fellows)
    j, distance = np.ravel(j), np.ravel(away)
    found = np.isfinite(distance) & (i != np.minimum(j, len(points) - 1))
    i, j, distance = i[found], j[found], distance[found]
    close = distance <= np.minimum(radius[i], radius[j])
    if not close.any():
        return None
    return i[close], j[close], float(distance[close].max())


def _in_company(points: Floats, bound: float) -> Ints:
    """Return points that others are near along each axis: all that have one within ``bound``.

    Usually none is left, and nothing is to be searched for.
    """
    left = np.arange(len(points))
    before = -1
    while len(left) != before:
        before = len(left)
        for axis in range(3):
            if len(left) == 0:
                return left
            order = np.argsort(points[left, axis], kind="stable")
            near = np.diff(points[left[order], axis]) <= bound
            left = left[np.sort(order[np.append(near, False) | np.append(False, near)])]
    return left
