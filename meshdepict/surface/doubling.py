"""Faces that are there twice, with both windings: their normals cancel, so one side is shaded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected
from meshdepict.surface.edges import sorted_edges
from meshdepict.surface.welding import mixed_bits, same_position

__all__ = ["other_sides"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SHEET = 0.2  # of the area; a hemisphere has half, a flat sheet all


def other_sides(points: Floats, faces: Ints) -> Bools | None:
    """Find the faces that are the other side of an earlier one.

    What is left of two opposed normals is rounding, and points anywhere; so the later face has to
    be turned with the earlier one. Two kinds stay as they are. Walls, faces where two bodies touch,
    end all round at edges of other faces: they are inside, and what is seen beside them must not
    lean on them. And where the two sides of an open sheet have vertices of their own, each has
    normals of its own, and can be seen.

    Parameters
    ----------
    points : (n, 3) array of float
        Points at bit-identical positions count as one.
    faces : (m, 3) array of int

    Returns
    -------
    (m,) array of bool or None
        None where there are none.
    """
    given = faces
    label = same_position(points)
    if label is not None:
        faces = label[faces]
    leader = _leaders(faces)
    if leader is None:
        return None
    odd = _is_odd(faces)
    other = odd != odd[leader]
    if not other.any():
        return None
    own = np.flatnonzero((leader == np.arange(len(faces))) & _is_proper(faces))
    number = np.empty(len(faces), np.int64)
    number[own] = np.arange(len(own))
    doubled = np.zeros(len(own), bool)
    doubled[number[leader[other]]] = True
    patch, wall = _walls(faces[own], doubled, len(points))
    place = number[leader[other]]
    turns = ~wall[place]
    if label is not None:
        apart = (np.sort(given, axis=1) != np.sort(given[leader], axis=1)).any(axis=1)[other]
        turns &= ~(apart & _open_sheets(points, given[own], patch)[patch[place]])
    other[other] = turns
    return other if other.any() else None


def _leaders(faces: Ints) -> Ints | None:
    """For each face the first with the same three corners; None where all differ."""
    total = mixed_bits(faces.astype(np.uint64)).sum(axis=1)
    ranked = np.sort(total)
    again = ranked[1:] == ranked[:-1]
    if not again.any():
        return None  # most meshes: one sort of plain numbers settles it
    suspects = np.flatnonzero(np.isin(total, ranked[1:][again]) & _is_proper(faces))
    corners = np.sort(faces[suspects], axis=1)
    order = np.lexsort(corners.T)  # stable, so the first of the copies stays the first
    corners = corners[order]
    same = np.append(False, (corners[1:] == corners[:-1]).all(axis=1))[: len(order)]
    leads = np.maximum.accumulate(np.where(same, 0, np.arange(len(order))))
    leader = np.arange(len(faces))
    leader[suspects[order]] = suspects[order[leads]]
    return leader


def _is_proper(faces: Ints) -> Bools:
    a, b, c = faces.T
    proper: Bools = (a != b) & (b != c) & (c != a)
    return proper


def _is_odd(faces: Ints) -> Bools:
    """Whether the corners are an odd permutation of their order by number."""
    a, b, c = faces.T
    odd: Bools = (a > b) ^ (b > c) ^ (a > c)
    return odd


def _walls(faces: Ints, doubled: Bools, n: int) -> tuple[Ints, Bools]:
    """Return the patch of each face, and whether it is a wall: doubled, and ending at others."""
    edges = sorted_edges(faces, n)
    first = edges.start[edges.count == 2]
    patch = connected(len(faces), edges.face[first], edges.face[first + 1])
    count = np.repeat(edges.count, edges.count)
    at_others, free = (
        np.bincount(patch[edges.face[which]], minlength=int(patch.max()) + 1) > 0
        for which in (count > 2, count == 1)
    )
    single = np.bincount(patch, ~doubled) > 0
    return patch, (at_others & ~free & ~single)[patch]


def _open_sheets(points: Floats, faces: Ints, patch: Ints) -> Bools:
    """Whether each patch has a vector area, which is zero where closed, near that of its faces."""
    a, b, c = (points[corner] for corner in faces.T)
    cross = np.cross(b - a, c - a)
    vector = np.stack([np.bincount(patch, axis) for axis in cross.T], axis=1)
    area = np.bincount(patch, np.linalg.norm(cross, axis=1))
    sheet: Bools = np.linalg.norm(vector, axis=1) > _SHEET * area
    return sheet
