"""Planes of a triangulated surface, and the normals that they have up to their creases.

Normals at vertices are means of what meets there. On a scan that is what is wanted. On a part with
planes and sharp edges, triangulated as coarsely as planes allow, they tilt at every crease, and
interpolated over large triangles they make a bump of a plane. Here each triangle gets normals of
its own: those of its plane, or, beside a plane, means of what meets on its side of the crease.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface import triangles
from meshdepict.surface.edges import connected

__all__ = ["PiecewiseNormals", "piecewise_normals"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SHARP = np.radians(30)  # what bends more is an edge, not the facets of something round
_SMOOTH = np.radians(2)  # what bends less is one surface
_PLANE = np.radians(1)  # from a plane's mean normal to those of its triangles
# A scan has patches by chance that are as flat: a plane is larger than they are, in squared median
# edges, or ends at creases all round.
_LARGE = 25
_CREASED = 0.99
_WALLED = 0.01  # of all area: fewer that are small and walled are chance, too
_NARROW = 4  # a bend to triangles so many times lower is theirs: a fillet's, not the plane's
_TILTED = np.radians(0.5)  # normals nearer to the plane's than that are as good


@dataclass(frozen=True)
class PiecewiseNormals:
    """Unit normals at the corners of m triangles, seen from within and along their sides.

    Attributes
    ----------
    corners : (m, 3, 3) array
        At each corner, for the inside.
    sides : (m, 3, 2, 3) array
        At both ends of the side from each corner to the next. What bends into a plane's neighbour
        smoothly has the neighbour's there.
    vertices : (n, 3) array
        One for each vertex: where creases meet, the mean of all sides.
    flat : (m,) array of bool
        Which triangles lie in planes.
    ends : (m, 3) array of bool
        At which of their sides planes end.
    """

    corners: Floats
    sides: Floats
    vertices: Floats
    flat: Bools
    ends: Bools

    def middles(self, edges: Ints, faces: Ints) -> Floats:
        """Return normals in the middle of edges: means over the triangles there.

        Parameters
        ----------
        edges : (e, 2) array
            Sorted vertex pairs, in lexical order.
        faces : (m, 3) array
        """
        size = int(faces.max()) + 1
        keys = edges[:, 0] * size + edges[:, 1]
        wanted = _side_keys(faces, size).ravel()
        place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        here = keys[place] == wanted
        inner = _unit(self.sides.sum(axis=2), self.sides[:, :, 0]).reshape(-1, 3)[here]
        total = np.zeros((len(edges), 3))
        for axis in range(3):
            total[:, axis] = np.bincount(place[here], inner[:, axis], minlength=len(edges))
        some = np.empty((len(edges), 3))
        some[place[here]] = inner  # of two that cancel, either
        return _unit(total, some)

    def centres(self) -> Floats:
        """Return normals (m, 3) in the middle of the triangles."""
        return _unit(self.corners.sum(axis=1), self.corners[:, 0])

    def tilted(self, faces: Ints) -> Bools:
        """Return which triangles (m,) have a corner whose vertex has another normal than they."""
        cosine = np.einsum("mci,mci->mc", self.corners, self.vertices[faces])
        return np.asarray((cosine < np.cos(_TILTED)).any(axis=1))

    def handed_down(self, parent: Ints, shares: Floats, vertices: Floats) -> PiecewiseNormals:
        """Return the normals of parts of the triangles.

        Parameters
        ----------
        parent : (k,) array
        shares : (k, 3, 3) array
            Barycentric coordinates in the parent of each corner.
        vertices : (n, 3) array
            Normals of the vertices, the new ones included.
        """
        corners, sides = self.corners[parent], self.sides[parent]
        flat, at_end = self.flat[parent], self.ends[parent]
        new = np.flatnonzero(np.bincount(parent)[parent] > 1)
        shares, before, along = shares[new], corners[new], sides[new]
        nearest = np.take_along_axis(before, shares.argmax(axis=2)[..., None], axis=1)
        corners[new] = inner = _unit(shares @ before, nearest)
        sides[new] = np.stack([inner, np.roll(inner, -1, axis=1)], axis=2)
        before_end, at_end[new] = at_end[new], False
        ends = np.stack([shares, np.roll(shares, -1, axis=1)], axis=2)  # (k, side, end, corner)
        for old in range(3):  # sides that are part of the parent's side opposite its corner old − 1
            rows, side = np.nonzero((ends[..., old - 1] == 0).all(axis=-1))
            share = ends[rows, side][..., [old, (old + 1) % 3]]
            sides[new[rows], side] = _unit(share @ along[rows, old], along[rows, old, :1])
            at_end[new[rows], side] = before_end[rows, old]
        return PiecewiseNormals(corners, sides, vertices, flat, at_end)


def piecewise_normals(
    points: Floats,
    faces: Ints,
    welded: Ints,
    turned: Bools,
    normals: Floats,
    *,
    edge: float,
    grain: float = 0.0,
) -> PiecewiseNormals | None:
    """Find the planes, and give normals to triangles; None where no normal of a plane is tilted.

    Parameters
    ----------
    points : (n, 3) array
    faces : (m, 3) array
    welded : (m, 3) array
        The same with one number for all vertices that share their normals.
    turned : (m,) array of bool
        Which are wound inwards.
    normals : (n, 3) array
        Of the vertices.
    edge : float
        Their median length.
    grain : float
        What points are rounded to.
    """
    surface = _Sides(points, faces, welded, turned, grain)
    if not ((surface.angle > _SHARP) & (surface.partner >= 0)).any():
        return None
    flat, plane = surface.planes(edge)
    if not flat.any():
        return None
    cosine = np.einsum("mi,mci->mc", plane, normals[faces])
    if (cosine[flat] > np.cos(_TILTED)).all():
        return None
    beyond = np.where(surface.partner >= 0, surface.partner // 3, np.arange(len(faces))[:, None])
    beside = flat[:, None] | flat[beyond]
    creases = (
        beside & (surface.angle > _SHARP) & (surface.partner >= 0) | flat[:, None] & surface.crowded
    )
    label = connected(3 * len(faces), *surface.around(~creases))
    fan = label.reshape(-1, 3)
    place = np.empty((int(label.max()) + 1, 3))
    place[label] = points[faces.ravel()]
    at_crease = np.zeros(int(welded.max()) + 1, bool)
    at_crease[welded[creases]] = at_crease[np.roll(welded, -1, axis=1)[creases]] = True
    own = at_crease[welded]
    sums = triangles.normal_sums(place, np.where(turned[:, None], fan[:, ::-1], fan))
    # Lengths of sums mean nothing: weights go with one over the area.
    meet = np.where(own[..., None], _unit(sums[fan], normals[faces], 0.0), normals[faces])
    corners = np.where(flat[:, None, None], plane[:, None], meet)

    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    bent = flat[:, None] & ~flat[beyond] & ~creases
    face, side = np.nonzero(bent)
    for end in range(2):
        other, corner = np.divmod(surface.matching(face, side, end), 3)
        sides[face, side, end] = corners[other, corner]

    # Where creases meet: the mean of the fans, each once, whatever their triangles.
    count = len(points)
    pairs, first = np.unique(faces[own] * len(place) + fan[own], return_index=True)
    total = np.zeros((count, 3))
    np.add.at(total, pairs // len(place), corners[own][first])
    at = np.unique(faces[own])
    vertices = normals.copy()
    vertices[at] = _unit(total[at], normals[at])
    return PiecewiseNormals(corners, sides, vertices, flat, creases | bent)


class _Sides:
    """What lies beyond the sides of triangles, and how far the surface bends there."""

    def __init__(
        self, points: Floats, faces: Ints, welded: Ints, turned: Bools, grain: float
    ) -> None:
        self.welded = welded
        a, b, c = points[faces].swapaxes(0, 1)
        cross = np.cross(b - a, c - a)
        double = np.linalg.norm(cross, axis=1)
        self.area = double / 2
        outward = np.where(turned, -1, 1)
        self.normal = cross * (outward / np.where(double > 0, double, 1))[:, None]
        self.length = np.linalg.norm(np.stack([b - a, c - b, a - c], axis=1), axis=2)
        self.height = double[:, None] / np.where(self.length > 0, self.length, 1)
        # How far rounding may have turned the triangle; of a sliver nobody knows.
        least = self.height.min(axis=1)
        self.noise = np.arctan2(grain, least, where=least > 0, out=np.full(len(faces), np.pi))
        self.partner, self.crowded = _partners(welded)
        beyond = self.partner // 3
        cosine = np.einsum("mi,msi->ms", self.normal, self.normal[beyond])
        self.angle = np.arccos(np.clip(cosine, -1, 1))
        unsure = np.minimum(self.noise[:, None] + self.noise[beyond], _SMOOTH)
        self.bend = np.where(self.partner >= 0, np.maximum(self.angle - unsure, 0), np.pi)

    def planes(self, edge: float) -> tuple[Bools, Floats]:
        """Return which triangles lie in planes (m,), and the normals of these (m, 3)."""
        count = len(self.area)
        kinds, plane = (np.zeros(count, bool), np.zeros(count, bool)), self.normal.copy()
        sharp = (self.angle > _SHARP) | (self.partner < 0)
        wide = np.where(self.partner >= 0, self.height.reshape(-1)[self.partner], 0) * _NARROW
        ends = (self.bend <= _SMOOTH) | sharp | (wide < self.height)
        left = self.area > 0
        limit = _PLANE
        # What curves slowly drifts from its mean normal; then a smaller bend is taken for an end.
        for _ in range(5):
            joined = (self.bend <= limit) & left[:, None] & left[self.partner // 3]
            face, side = np.nonzero(joined)
            region = connected(count, face, self.partner[face, side] // 3)
            sums = np.zeros((int(region.max()) + 1, 3))
            for axis in range(3):
                sums[:, axis] = np.bincount(region, self.area * self.normal[:, axis])
            mean = _unit(sums, sums, 0.0)[region]
            off = np.arccos(np.clip(np.einsum("mi,mi->m", mean, self.normal), -1, 1))
            off -= np.minimum(self.noise, _SMOOTH)
            even = np.bincount(region, off > _PLANE)[region] == 0
            # Of the border that is not open, and of two triangles at least.
            border = np.where(joined | (self.partner < 0), 0, self.length)
            creased = np.bincount(region, (border * sharp).sum(axis=1))
            walled = creased > _CREASED * np.bincount(region, border.sum(axis=1))
            walled &= np.bincount(region) > 1
            large = np.bincount(region, self.area) > _LARGE * edge**2
            for kind, found in zip(kinds, (large, walled & ~large), strict=True):
                kind |= left & even & found[region] & ends.all(axis=1)
            plane[left & even] = mean[left & even]
            left &= ~even
            limit /= 2
        large, walled = kinds
        if self.area[walled].sum() > _WALLED * self.area.sum():
            large |= walled
        return large, plane

    def around(self, through: Bools) -> tuple[Ints, Ints]:
        """Return pairs of corners, 3 · face + corner, that meet at sides one may pass through."""
        face, side = np.nonzero(through & (self.partner >= 0))
        here = [3 * face + side, 3 * face + (side + 1) % 3]
        there = [self.matching(face, side, end) for end in range(2)]
        return np.concatenate(here), np.concatenate(there)

    def matching(self, face: Ints, side: Ints, end: int) -> Ints:
        """Return the corner beyond a side, 3 · face + corner, at its first or second end."""
        other, turned = np.divmod(self.partner[face, side], 3)
        vertex = self.welded[face, (side + end) % 3]
        same = self.welded[other, turned] == vertex
        return 3 * other + np.where(same, turned, (turned + 1) % 3)


def _side_keys(faces: Ints, size: int) -> Ints:
    """Return a number (m, 3) for the vertices of each side, in either order."""
    after = np.roll(faces, -1, axis=1)
    return np.minimum(faces, after) * size + np.maximum(faces, after)


def _partners(faces: Ints) -> tuple[Ints, Bools]:
    """Return for each side that of the one other triangle, 3 · face + side, or −1; and crowds.

    The second says where more than two triangles meet.
    """
    keys = _side_keys(faces, int(faces.max()) + 1).ravel()
    order = np.argsort(keys, kind="stable")
    start = np.flatnonzero(np.diff(keys[order], prepend=-1))
    count = np.diff(start, append=len(keys))
    partner = np.full(len(keys), -1)
    pair = start[count == 2]
    one, two = order[pair], order[pair + 1]
    proper = one // 3 != two // 3
    one, two = one[proper], two[proper]
    partner[one], partner[two] = two, one
    crowded = np.zeros(len(keys), bool)
    crowded[order] = np.repeat(count > 2, count)
    return partner.reshape(-1, 3), crowded.reshape(-1, 3)


def _unit(vectors: Floats, otherwise: Floats, least: float = 1e-9) -> Floats:
    """Return vectors (…, 3) of length one; others in place of those that cancel."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    proper = length > least
    found: Floats = np.where(proper, vectors / np.where(proper, length, 1), otherwise)
    return found
