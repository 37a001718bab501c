"""Polygons of any size: how they are stored, and how they become triangles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError

__all__ = [
    "FacesLike",
    "Polygons",
    "as_polygons",
    "polygon_corners",
    "strip_triangles",
    "triangulate",
    "whole_numbers",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_BLOCK = 1 << 17  # corners at a time: temporaries stay in the cache
_LARGE = 128  # corners: from here on the time for the best of all ears, their square, is felt


class Polygons(NamedTuple):
    """Polygon i has the corners ``connectivity[offsets[i]:offsets[i + 1]]``."""

    connectivity: Ints
    offsets: Ints

    def reversed(self, which: NDArray[np.bool_]) -> Polygons:
        """Return polygons of which those marked run the other way round from the same corner."""
        sizes = np.diff(self.offsets)
        first = np.repeat(self.offsets[:-1], sizes)
        size, turned = np.repeat(sizes, sizes), np.repeat(which, sizes)
        step = np.arange(len(self.connectivity)) - first
        step = np.where(turned, -step % size, step)
        return Polygons(self.connectivity[first + step], self.offsets)


FacesLike: TypeAlias = ArrayLike | Polygons | Sequence[ArrayLike]
"""(m, k) indices, or a list of polygons, each a list of indices, or `Polygons`."""


def as_polygons(faces: FacesLike) -> Polygons:
    """Return faces of any accepted form as new `Polygons`.

    Parameters
    ----------
    faces : (m, k) array_like of int with k ≥ 3, a list of index lists, or `Polygons`

    Raises
    ------
    MeshdepictError
        For anything but whole numbers, and for offsets that don't fit the connectivity.
    """
    if isinstance(faces, Polygons):
        return _checked(whole_numbers(faces.connectivity), whole_numbers(faces.offsets))
    try:
        table = np.asarray(faces)
        ragged = table.dtype == object
    except ValueError:  # NumPy refuses rows of different lengths
        ragged = True
    if ragged:
        return _from_lists(faces)
    if table.size == 0:
        return Polygons(np.empty(0, np.int64), np.zeros(1, np.int64))
    if table.ndim != 2 or table.shape[1] < 3:
        raise MeshdepictError(
            f"faces must be (m, 3) or (m, k) indices or a list of polygons, not shape {table.shape}"
        )
    count, size = table.shape
    return Polygons(whole_numbers(table).reshape(-1), np.arange(count + 1, dtype=np.int64) * size)


def _from_lists(faces: Any) -> Polygons:
    try:
        sizes = np.array([len(face) for face in faces], np.int64)
        flat = np.array(list(chain.from_iterable(faces)))
    except (TypeError, ValueError):
        raise MeshdepictError("faces must be index arrays or a list of index lists") from None
    return Polygons(whole_numbers(flat), np.concatenate(([0], np.cumsum(sizes))))


def whole_numbers(values: ArrayLike) -> Ints:
    """Return indices as a new array.

    Raises
    ------
    MeshdepictError
        For anything but whole numbers: fractions would be cut off, and NaN become any index.
    """
    array = np.asarray(values)
    if array.size and array.dtype.kind not in "iu":
        raise MeshdepictError(f"faces must hold whole numbers, not {array.dtype}")
    return array.astype(np.int64)  # always a copy: the caller's array stays the caller's


def _checked(connectivity: Ints, offsets: Ints) -> Polygons:
    flat = connectivity.ndim == offsets.ndim == 1 and len(offsets) > 0
    spans = flat and offsets[0] == 0 and offsets[-1] == len(connectivity)
    if not spans or (np.diff(offsets) < 0).any():
        raise MeshdepictError(
            "the offsets of polygons must rise from 0 to the length of their connectivity"
        )
    return Polygons(connectivity, offsets)


def triangulate(vertices: Floats, polygons: Polygons) -> tuple[Ints, Ints]:
    """Split polygons into triangles that are wound as their polygons are.

    Quads take the diagonal that leaves both halves facing along the Newell normal, and of two such
    the shorter; larger polygons become fans where that keeps every triangle facing so, else their
    ears are clipped. A polygon of k ≥ 3 corners always gives k − 2 triangles, degenerate ones too;
    smaller ones are skipped.

    Parameters
    ----------
    vertices : (n, 3) array
        Finite positions.
    polygons : Polygons
        Indices in ``0 … n − 1``.

    Returns
    -------
    triangles : (m, 3) array of int64
        In the order of the polygons.
    owner : (m,) array of int64
        The polygon that each triangle comes from.
    """
    connectivity, offsets = polygons
    sizes = np.diff(offsets)
    parts = np.maximum(sizes - 2, 0)
    owner = np.repeat(np.arange(len(sizes)), parts)
    present = np.flatnonzero(np.bincount(sizes))
    if len(present) == 1 and present[0] > 2:  # the usual mesh: one size throughout
        return _split_blocks(vertices, connectivity.reshape(-1, present[0])).reshape(-1, 3), owner
    first = np.cumsum(parts) - parts
    triangles = np.empty((len(owner), 3), np.int64)
    # By size, each looked at once: there may be many sizes.
    order = np.argsort(sizes, kind="stable")
    ends = np.cumsum(np.bincount(sizes))
    for size in present[present > 2]:
        chosen = order[ends[size - 1] : ends[size]]
        corners = connectivity[offsets[chosen, None] + np.arange(size)]
        split = _split_blocks(vertices, corners)
        triangles[first[chosen, None] + np.arange(size - 2)] = split
    return triangles, owner


def polygon_corners(triangles: Ints, owner: Ints, polygons: Polygons) -> Ints:
    """Return which of the polygons' corners (m, 3) those of the triangles are.

    Parameters
    ----------
    triangles, owner
        As `triangulate` returned.
    polygons : Polygons

    Where a polygon has a vertex twice, its first corner there stands for both.
    """
    connectivity, offsets = polygons
    if len(connectivity) == 3 * len(triangles) and (np.diff(offsets) == 3).all():
        return np.arange(len(connectivity)).reshape(-1, 3)
    count = int(connectivity.max()) + 1
    of_corner = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets)) * count + connectivity
    order = np.argsort(of_corner, kind="stable")
    wanted = owner[:, None] * count + triangles
    return np.asarray(order[np.searchsorted(of_corner[order], wanted)])


def strip_triangles(strips: Polygons) -> tuple[Ints, Ints]:
    """Return the triangles of triangle strips, and the strip that each comes from.

    A strip a, b, c, d, … stands for abc, cbd, …; triangles with two equal corners, which only join
    strips, are left out.
    """
    connectivity, offsets = strips
    parts = np.maximum(np.diff(offsets) - 2, 0)
    owner = np.repeat(np.arange(len(parts)), parts)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    triangles = connectivity[(offsets[owner] + step)[:, None] + np.arange(3)]
    odd = step % 2 == 1
    triangles[odd] = triangles[odd][:, [1, 0, 2]]
    a, b, c = triangles.T
    proper = (a != b) & (b != c) & (c != a)
    return triangles[proper], owner[proper]


def _split_blocks(vertices: Floats, corners: Ints) -> Ints:
    """Return (p, k − 2, 3) triangles of (p, k) polygons."""
    count, size = corners.shape
    if size == 3:
        return corners[:, None, :]
    triangles = np.empty((count, size - 2, 3), np.int64)
    step = max(_BLOCK // size, 1)
    for start in range(0, count, step):
        triangles[start : start + step] = _split(vertices, corners[start : start + step])
    return triangles


def _split(vertices: Floats, corners: Ints) -> Ints:
    size = corners.shape[1]
    # Corner by corner, relative to the first: survey coordinates cost no digits. Scaled, so that
    # products of four lengths don't overflow.
    origin = vertices.take(corners[:, 0], axis=0)
    points = np.stack([vertices.take(corner, axis=0) - origin for corner in corners.T], axis=1)
    points /= max(points.max(), -points.min()) or 1.0
    if size == 4:
        return _split_quads(corners, points)
    fan = np.cross(points[:, 1:-1], points[:, 2:])  # triangles (0, i, i + 1): corner 0 is zero
    normal = fan.sum(axis=1)
    middle = np.arange(1, size - 1)
    local = np.stack((np.zeros_like(middle), middle, middle + 1), axis=1)
    triangles = corners[:, local]
    concave = np.flatnonzero(~(np.einsum("pij,pj->pi", fan, normal) > 0).all(axis=1))
    if len(concave):
        flat = _flattened(points[concave], normal[concave])
        if size > _LARGE:
            from meshdepict.surface.ears import clip_large

            ears = np.stack([clip_large(polygon) for polygon in flat])
        else:
            ears = _clip_ears(flat)
        triangles[concave] = corners[concave[:, None, None], ears]
    return triangles


def _split_quads(corners: Ints, points: Floats) -> Ints:
    """Return (p, 2, 3) triangles of quads; of their points the first is the origin."""
    a, b, c = (np.ascontiguousarray(points[:, corner].T) for corner in (1, 2, 3))
    half_012, half_023, half_013 = _cross(a, b), _cross(b, c), _cross(a, c)
    normal = half_012 + half_023
    fits_02 = (_dot(half_012, normal) > 0) & (_dot(half_023, normal) > 0)
    fits_13 = (_dot(half_013, normal) > 0) & (_dot(normal - half_013, normal) > 0)
    shorter_13 = _dot(c - a, c - a) < _dot(b, b)
    use_13 = np.where(fits_02 == fits_13, shorter_13, fits_13)
    triangles = corners[:, [[0, 1, 2], [0, 2, 3]]]
    triangles[use_13] = corners[use_13][:, [[0, 1, 3], [1, 2, 3]]]
    return triangles


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of (3, p) vectors (faster than np.cross on columns)."""
    return np.stack(
        (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    )


def _dot(a: Floats, b: Floats) -> Floats:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _flattened(points: Floats, normal: Floats) -> Floats:
    """Project (p, k, 3) polygons along their normals to (p, k, 2), counter-clockwise."""
    least = np.eye(3)[np.abs(normal).argmin(axis=1)]
    u = np.cross(least, normal)
    length = np.linalg.norm(u, axis=1, keepdims=True)
    u /= np.where(length > 0, length, 1.0)
    v = np.cross(normal, u)
    length = np.linalg.norm(v, axis=1, keepdims=True)
    v /= np.where(length > 0, length, 1.0)
    return np.einsum("pki,pji->pkj", points, np.stack((u, v), axis=1))


def _clip_ears(flat: Floats) -> Ints:
    """Return (p, k − 2, 3) corner numbers for p polygons in the plane, clipped side by side.

    Every polygon loses its best ear in each step, so that the rings stay one rectangular array.
    Only the two neighbours of a clipped ear can change their rank: what lies deepest in the
    triangle of a blocked ear is always reflex, and reflex corners are not clipped.
    """
    count, size = flat.shape[:2]
    rows = np.arange(count)
    ring = np.tile(np.arange(size), (count, 1))
    rank = np.stack([_ear_rank(flat, ring, np.full(count, at)) for at in range(size)], axis=1)
    triangles = np.empty((count, size - 2, 3), np.int64)
    for step in range(size - 3):
        left = size - step
        ear = rank.argmax(axis=1)
        around = (ear[:, None] + (-1, 0, 1)) % left
        triangles[:, step] = np.take_along_axis(ring, around, axis=1)
        keep = np.arange(left) != ear[:, None]
        ring = ring[keep].reshape(count, left - 1)
        rank = rank[keep].reshape(count, left - 1)
        for neighbour in ((ear - 1) % (left - 1), ear % (left - 1)):
            rank[rows, neighbour] = _ear_rank(flat, ring, neighbour)
    triangles[:, -1] = ring
    return triangles


def _ear_rank(flat: Floats, ring: Ints, at: Ints) -> Floats:
    """Rank the corner ``at`` of each ring for clipping: the higher, the sooner.

    Positive: an ear, by the shape of its triangle. 0: a corner on a straight line, harmless to
    clip. About −1: convex, but another corner lies in its triangle. About −2: reflex.
    """
    rows = np.arange(len(ring))
    left = ring.shape[1]
    corner = [flat[rows, ring[rows, (at + shift) % left]] for shift in (-1, 0, 1)]
    a, b, c = (point[:, None] for point in corner)
    others = np.take_along_axis(flat, ring[:, :, None], axis=1)
    inside = (_turn(a, b, others) >= 0) & (_turn(b, c, others) >= 0) & (_turn(c, a, others) >= 0)
    for point in (a, b, c):  # the corners themselves, and others at the same place
        inside &= (others != point).any(axis=2)
    doubled_area = _turn(a, b, c)[:, 0]
    squares = sum(((p - q) ** 2).sum(axis=2)[:, 0] for p, q in ((a, b), (b, c), (c, a)))
    shape = doubled_area / np.where(squares > 0, squares, 1.0)
    penalty = np.where(shape < 0, 2.0, np.where((shape > 0) & inside.any(axis=1), 1.0, 0.0))
    ranked: Floats = shape - penalty
    return ranked


def _turn(a: Floats, b: Floats, c: Floats) -> Floats:
    """Return twice the signed area of the triangles (a, b, c) in the plane."""
    u, v = b - a, c - a
    turned: Floats = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return turned
