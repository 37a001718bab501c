"""Planes of a triangulated surface: which triangles lie in them, and where they end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected

__all__ = ["SHARP", "Sides", "side_keys", "unit_vectors"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHARP = np.radians(30)  # what bends more is an edge, not the facets of something round
_SMOOTH = np.radians(2)  # what bends less is one surface
_PLANE = np.radians(1)  # from a plane's mean normal to those of its triangles
# A scan has patches by chance that are as flat: a plane is larger than they are, in squared median
# edges, or ends at creases all round.
_LARGE = 25
_CREASED = 0.99
_WALLED = 0.01  # of all area: fewer that are small and walled are chance, too
_NARROW = 4  # a bend to triangles so many times lower is theirs: a fillet's, not the plane's


class Sides:
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
        sharp = (self.angle > SHARP) | (self.partner < 0)
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
            mean = unit_vectors(sums, sums, 0.0)[region]
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


def side_keys(faces: Ints, size: int) -> Ints:
    """Return a number (m, 3) for the vertices of each side, in either order."""
    after = np.roll(faces, -1, axis=1)
    return np.minimum(faces, after) * size + np.maximum(faces, after)


def _partners(faces: Ints) -> tuple[Ints, Bools]:
    """Return for each side that of the one other triangle, 3 · face + side, or −1; and crowds.

    The second says where more than two triangles meet.
    """
    keys = side_keys(faces, int(faces.max()) + 1).ravel()
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


def unit_vectors(vectors: Floats, otherwise: Floats, least: float = 1e-9) -> Floats:
    """Return vectors (…, 3) of length one; others in place of those that cancel."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    proper = length > least
    found: Floats = np.where(proper, vectors / np.where(proper, length, 1), otherwise)
    return found
