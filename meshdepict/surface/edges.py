"""Edges of a triangle soup: which sides of which faces meet there, and in which direction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.welding import same_position

__all__ = ["Cleaned", "Edges", "cleaned", "edge_keys", "is_balanced", "sorted_edges"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Edges:
    """The sides of m faces, sorted so that those on one edge follow one another."""

    face: Ints  # (3m,) whose side it is
    forward: Bools  # (3m,) whether it runs from the smaller to the larger vertex number
    start: Ints  # (e,) where an edge's sides begin
    count: Ints  # (e,) how many it has
    key: Ints  # (e,) smaller · n + larger vertex number


@dataclass(frozen=True)
class Cleaned:
    """Proper faces, each once, with one vertex per position."""

    faces: Ints  # (k, 3)
    place: Ints  # (m,) for each given face the one of the k that it equals, −1 where degenerate
    edges: Edges  # of the k faces
    edges_with_copies: Edges | None  # copies counting as the face that they equal; None: no copies


def _side_keys(faces: Ints, n: int) -> Ints:
    """Give every side a key such that the two directions of an edge have keys 2i and 2i + 1.

    Returns
    -------
    (3m,) array
        Side s of face f at s · m + f.
    """
    keys = np.empty((3, len(faces)), np.int64)
    for side in range(3):
        a, b = faces[:, side], faces[:, (side + 1) % 3]
        keys[side] = (np.minimum(a, b) * n + np.maximum(a, b)) * 2 + (a > b)
    return keys.reshape(-1)


def is_balanced(faces: Ints, n: int) -> bool:
    """Tell whether every edge has as many sides one way as the other: all closed and agreeing."""
    keys = _side_keys(faces, n)
    keys.sort()
    if len(keys) % 2 == 0 and not (keys[::2] & 1).any() and (keys[1::2] == keys[::2] + 1).all():
        return True  # a manifold, the common case: just one each
    balance = np.cumsum(1 - 2 * (keys & 1))
    keys >>= 1
    return not balance[np.append(keys[1:] != keys[:-1], True)].any()


def edge_keys(faces: Ints, n: int) -> tuple[Ints, Ints]:
    """Return the key of every edge, smaller · n + larger vertex number, and its number of sides."""
    keys = _side_keys(faces, n) >> 1
    keys.sort()
    start = np.flatnonzero(np.diff(keys, prepend=-1))
    return keys[start], np.diff(start, append=len(keys))


def sorted_edges(faces: Ints, n: int) -> Edges:
    """Collect the sides of faces (m, 3) by edge; n is the number of vertices."""
    keys = _side_keys(faces, n)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    forward = keys & 1 == 0
    keys >>= 1
    start = np.flatnonzero(np.diff(keys, prepend=-1))
    count = np.diff(start, append=len(keys))
    return Edges(order % max(len(faces), 1), forward, start, count, keys[start])


def cleaned(points: Floats, faces: Ints) -> Cleaned:
    """Weld vertices at one position, and leave out degenerate faces and copies of others."""
    n = len(points)
    edges = sorted_edges(faces, n)
    # A seam has vertices at one position on edges that lack a partner; most meshes have none.
    rim = np.unique(np.divmod(edges.key[edges.count % 2 == 1], n))
    seams = same_position(points[rim]) is not None
    if seams:
        label = np.asarray(same_position(points))
        first = np.empty(n, np.int64)
        first[label[::-1]] = np.arange(n)[::-1]  # the first at each position is written last
        faces = first[label[faces]]
    a, b, c = faces.T
    proper = (a != b) & (b != c) & (c != a)
    if seams or not proper.all():
        faces = faces[proper]
        edges = sorted_edges(faces, n)
    place = np.where(proper, np.cumsum(proper) - 1, -1)
    leader = _first_copies(faces, edges)
    if leader is None:
        return Cleaned(faces, place, edges, None)
    unique = leader == np.arange(len(faces))
    number = (np.cumsum(unique) - 1)[leader]
    return Cleaned(
        faces[unique],
        np.where(proper, number[place], -1),
        sorted_edges(faces[unique], n),
        replace(edges, face=number[edges.face]),
    )


def _first_copies(faces: Ints, edges: Edges) -> Ints | None:
    """For each face the first that has the same corners; None where all differ."""
    # Copies share three edges, none of them good (or, opposed, they are closed by themselves).
    good = edges.count == 2
    first = edges.start[good]
    good[good] = edges.forward[first] != edges.forward[first + 1]
    bad_sides = np.bincount(edges.face[np.repeat(~good, edges.count)], minlength=len(faces))
    suspects = np.flatnonzero(bad_sides == 3)
    corners = np.sort(faces[suspects], axis=1)
    order = np.lexsort(corners.T)  # stable, so the first of the copies stays the first
    corners = corners[order]
    again = np.append(False, (corners[1:] == corners[:-1]).all(axis=1))[: len(order)]
    if not again.any():
        return None
    leader = np.arange(len(faces))
    leads = np.maximum.accumulate(np.where(again, 0, np.arange(len(order))))
    leader[suspects[order]] = suspects[order[leads]]
    return leader
