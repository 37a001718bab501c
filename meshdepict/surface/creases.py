"""Sharp edges: which corners of triangles hang together round a vertex, and which are parted.

The triangles round a vertex form fans between the sharp edges that end there. Each fan is a side of
its own; where a crease runs out on a smooth surface, the triangles go on round its end and stay one
fan.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected
from meshdepict.surface.planes import Sides, side_keys

__all__ = ["Fans", "Parts", "fans_between_creases", "parted_corners"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_UNSURE = np.radians(2)  # a triangle that rounding may turn so far has its neighbour's plane
_CHAIN = 16  # such triangles beside each other


class Fans(NamedTuple):
    """Which corners of m triangles have one side of the surface in common.

    Attributes
    ----------
    label : (m, 3) array
        One number for the corners of a fan.
    creased : (m, 3) array of bool
        Whether a sharp edge ends at the corner's vertex.
    """

    label: Ints
    creased: Bools


class Parts(NamedTuple):
    """Vertices, some of which stand for one side of a vertex that was.

    Attributes
    ----------
    source : (n,) array
        Which vertex each was; those that were come first, in order.
    corners : (m, 3) array
        Of the triangles.
    group : (n,) array
        One number, from 0, for those that share a normal.
    """

    source: Ints
    corners: Ints
    group: Ints


def fans_between_creases(
    points: Floats,
    faces: Ints,
    welded: Ints,
    turned: Bools,
    *,
    angle: float,
    owner: Ints | None = None,
    grain: float = 0.0,
) -> Fans:
    """Find the sharp edges, and what hangs together between them.

    Parameters
    ----------
    points : (n, 3) array
    faces : (m, 3) array
    welded : (m, 3) array
        The same with one number for all vertices that are one point of the surface.
    turned : (m,) array of bool
        Which are wound inwards.
    angle : float
        Radians from one triangle's plane to the next from which an edge is sharp.
    owner : (m,) array, optional
        The polygon that each is part of: inside of one nothing is sharp.
    grain : float
        What points are rounded to.
    """
    surface = Sides(points, faces, welded, turned, grain)
    normal = _sure_normals(surface)
    one, two = _neighbours(welded)
    face, beyond = one // 3, two // 3
    cosine = np.einsum("ei,ei->e", normal[face], normal[beyond])
    known = (np.abs(normal).max(axis=1) > 0)[np.stack([face, beyond])].all(axis=0)
    sharp = known & (cosine < np.cos(angle))
    if owner is not None:
        sharp &= owner[face] != owner[beyond]
    at_crease = np.zeros(int(welded.max()) + 1, bool)
    after = np.roll(welded, -1, axis=1)
    for corners in (welded, after):
        at_crease[corners.ravel()[one[sharp]]] = True
    # What one passes from triangle to triangle: both ends of a side meet those of the other.
    one, two = one[~sharp], two[~sharp]
    same = welded.ravel()[one] == welded.ravel()[two]
    ends = [one, _next(one)]
    others = [np.where(same, two, _next(two)), np.where(same, _next(two), two)]
    label = connected(3 * len(faces), np.concatenate(ends), np.concatenate(others))
    return Fans(label.reshape(-1, 3), at_crease[welded])


def parted_corners(faces: Ints, fans: Fans, group: Ints) -> Parts:
    """Give every fan at a crease vertices of its own.

    Parameters
    ----------
    faces : (m, k) array
        Corners: of triangles, or of anything.
    fans : Fans
        Of them.
    group : (n,) array
        One number for the vertices that share a normal so far.

    Returns
    -------
    Parts
        Of the fans at a vertex the first triangle's keeps it; new vertices come after all others.
    """
    count = len(group)
    at = np.flatnonzero(fans.creased.ravel())
    vertex, label = faces.ravel()[at], fans.label.ravel()[at]
    pairs, first, which = np.unique(
        vertex * (int(label.max(initial=0)) + 1) + label, return_index=True, return_inverse=True
    )
    holder, side = vertex[first], label[first]
    order = np.lexsort((first, holder))
    keeps = np.empty(len(pairs), bool)
    keeps[order] = np.diff(holder[order], prepend=-1) > 0
    number = np.where(keeps, holder, 0)
    added = np.flatnonzero(~keeps)
    added = added[np.lexsort((first[added], holder[added]))]
    number[added] = count + np.arange(len(added))
    corners = faces.ravel().copy()
    corners[at] = number[which.ravel()]
    source = np.concatenate([np.arange(count), holder[added]])
    groups = group[source]
    groups[number] = int(group.max()) + 1 + side
    groups = np.unique(groups, return_inverse=True)[1].ravel()
    return Parts(source, corners.reshape(faces.shape), groups)


def _next(corner: Ints) -> Ints:
    """Return the corner after one, 3 · face + corner, in its triangle."""
    return np.where(corner % 3 == 2, corner - 2, corner + 1)


def _neighbours(welded: Ints) -> tuple[Ints, Ints]:
    """Return sides, 3 · face + side, that share an edge: where several do, each with the next."""
    keys = side_keys(welded, int(welded.max()) + 1).ravel()
    order = np.argsort(keys, kind="stable")
    same = keys[order[1:]] == keys[order[:-1]]
    return order[:-1][same], order[1:][same]


def _sure_normals(surface: Sides) -> Floats:
    """Return normals of triangles, those of slivers from beyond their longest side; else zero."""
    normal = surface.normal.copy()
    sure = surface.noise <= _UNSURE
    longest = surface.length.argmax(axis=1)[:, None]
    partner = np.take_along_axis(surface.partner, longest, axis=1)[:, 0]
    beyond = np.where(partner >= 0, partner // 3, np.arange(len(normal)))
    for _ in range(_CHAIN):
        ready = ~sure & sure[beyond]
        if not ready.any():
            break
        normal[ready] = normal[beyond[ready]]
        sure[ready] = True
    normal[~sure] = 0
    return normal
