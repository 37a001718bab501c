"""Normals of triangles beside creases: of their plane, or of what meets on their side.

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
from meshdepict.surface.components import connected
from meshdepict.surface.planes import SHARP, Sides, side_keys, unit_vectors

__all__ = ["PiecewiseNormals", "piecewise_normals"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

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
        wanted = side_keys(faces, size).ravel()
        place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        here = keys[place] == wanted
        inner = unit_vectors(self.sides.sum(axis=2), self.sides[:, :, 0]).reshape(-1, 3)[here]
        total = np.zeros((len(edges), 3))
        for axis in range(3):
            total[:, axis] = np.bincount(place[here], inner[:, axis], minlength=len(edges))
        some = np.empty((len(edges), 3))
        some[place[here]] = inner  # of two that cancel, either
        return unit_vectors(total, some)

    def centres(self) -> Floats:
        """Return normals (m, 3) in the middle of the triangles."""
        return unit_vectors(self.corners.sum(axis=1), self.corners[:, 0])

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
        corners[new] = inner = unit_vectors(shares @ before, nearest)
        sides[new] = np.stack([inner, np.roll(inner, -1, axis=1)], axis=2)
        before_end, at_end[new] = at_end[new], False
        ends = np.stack([shares, np.roll(shares, -1, axis=1)], axis=2)  # (k, side, end, corner)
        for old in range(3):  # sides that are part of the parent's side opposite its corner old − 1
            rows, side = np.nonzero((ends[..., old - 1] == 0).all(axis=-1))
            share = ends[rows, side][..., [old, (old + 1) % 3]]
            sides[new[rows], side] = unit_vectors(share @ along[rows, old], along[rows, old, :1])
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
    surface = Sides(points, faces, welded, turned, grain)
    if not ((surface.angle > SHARP) & (surface.partner >= 0)).any():
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
        beside & (surface.angle > SHARP) & (surface.partner >= 0) | flat[:, None] & surface.crowded
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
    meet = np.where(own[..., None], unit_vectors(sums[fan], normals[faces], 0.0), normals[faces])
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
    vertices[at] = unit_vectors(total[at], normals[at])
    return PiecewiseNormals(corners, sides, vertices, flat, creases | bent)
