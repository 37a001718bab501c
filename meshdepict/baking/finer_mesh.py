"""A mesh while its triangles are split: what is where, and with which normal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.space import ScaleSpace
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.parted import PartedMesh
from meshdepict.surface.piecewise_normals import PiecewiseNormals, piecewise_normals
from meshdepict.surface.splitting import edge_pairs, midpoints, split_faces
from meshdepict.surface.welding import same_position

if TYPE_CHECKING:
    from meshdepict.shapes.textures import Textures

__all__ = ["FinerMesh", "Places"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_ROUNDS = 5  # an edge becomes 32 at most
_GROWTH = 16  # times as many triangles as before, at most
# Beside planes: they may be two triangles each, and one edge from end to end.
_PLANE_ROUNDS = 10
_PLANE_GROWTH = 100_000  # triangles, where that is more
_SHORTEST = 1 / 16  # of the median edge
_SINGLE = 6e-8  # relative rounding of single precision, in which files hold coordinates


class Places(NamedTuple):
    """Places on the triangles of a mesh.

    Attributes
    ----------
    corners : (n, 3) array of int
        Three of its vertices.
    weights : (n, 3) array
        Barycentric coordinates between them.
    normals : (n, 3) array or None
        Where they are not the vertices' interpolated.
    """

    corners: Ints
    weights: Floats
    normals: Floats | None

    def those(self, chosen: Bools) -> Places:
        """Return some of them."""
        normals = None if self.normals is None else self.normals[chosen]
        return Places(self.corners[chosen], self.weights[chosen], normals)

    def __add__(self, other: Any) -> Places:
        """Return these and others after them."""
        normals = None if self.normals is None else np.concatenate([self.normals, other.normals])
        return Places(
            np.concatenate([self.corners, other.corners]),
            np.concatenate([self.weights, other.weights]),
            normals,
        )


class FinerMesh:
    """Triangles that parts of a mesh's own triangles become.

    Parameters
    ----------
    mesh : Mesh
        It stays as it is.
    pieces : PiecewiseNormals, optional
        Normals of its triangles, found unless given.

    Attributes
    ----------
    faces : (m, 3) array
    vertices : Places
        Where the corners of the faces lie on the mesh; the mesh's own come first.
    pieces : PiecewiseNormals or None
        Of the faces; None where the vertices' normals will do.
    rounds, most : int
        How often to split, and from how many triangles on no more.
    """

    def __init__(self, mesh: Mesh, pieces: PiecewiseNormals | None = None) -> None:
        self._mesh = mesh
        self.faces, self._owner = mesh.faces, np.arange(len(mesh.faces))
        self.pieces = pieces or _pieces(mesh)
        count = len(mesh.vertices)
        self.vertices = Places(
            np.repeat(np.arange(count)[:, None], 3, axis=1),
            np.tile((1.0, 0.0, 0.0), (count, 1)),
            None if self.pieces is None else self.pieces.vertices,
        )
        self.rounds = _PLANE_ROUNDS if self.pieces else _ROUNDS
        self.most = _GROWTH * len(mesh.faces)
        if self.pieces:
            self.most = max(self.most, _PLANE_GROWTH)
        self._active = np.ones(len(self.faces), bool)
        # Copies of a vertex along a seam, whose edges have to be split alike.
        seams = self.pieces is not None or isinstance(mesh, PartedMesh)
        self._position = same_position(mesh.vertices) if seams else None

    def samples(self, space: ScaleSpace, places: Places) -> InterpolatedSpace:
        """Return samples at places, from a scale space of the mesh."""
        return InterpolatedSpace(space, places.corners, places.weights, normals=places.normals)

    def points(self, places: Places) -> Floats:
        """Return where places are, in the mesh's unit frame."""
        return np.einsum("nc,nci->ni", places.weights, self._mesh.unit_points[places.corners])

    def edges(self) -> Ints:
        """Return the edges of triangles that are new: sorted pairs of vertices, in order."""
        return edge_pairs(self.faces[self._active])

    def middles(self, edges: Ints) -> Places:
        """Return the middles of edges."""
        corners, weights = midpoints(self.vertices.corners, self.vertices.weights, edges)
        normals = None if self.pieces is None else self.pieces.middles(edges, self.faces)
        return Places(corners, weights, normals)

    def hiding(self) -> Ints:
        """Return new triangles whose corners don't have their normals, and so say nothing."""
        if self.pieces is None:
            return np.zeros(0, np.int64)
        return np.flatnonzero(self.pieces.tilted(self.faces) & self._active)

    def centres(self, faces: Ints) -> Places:
        """Return the centres of some triangles."""
        assert self.pieces is not None
        corners, weights = midpoints(
            self.vertices.corners, self.vertices.weights, self.faces[faces]
        )
        return Places(corners, weights, self.pieces.centres()[faces])

    def with_insides(self, error: Floats, edges: Ints, faces: Ints, inside: Floats) -> Floats:
        """Return errors of edges, at least those inside some of the triangles that they bound."""
        place, here = self._bounding(edges, faces)
        # A needle gets no shorter by making it narrower.
        length = np.where(here, self.lengths(edges)[place], 0)
        here &= length > length.max(axis=1, keepdims=True) / 2
        larger = error.copy()
        np.maximum.at(larger, place[here], np.repeat(inside[:, None], 3, axis=1)[here])
        return larger

    def lengths(self, edges: Ints) -> Floats:
        """Return lengths of edges, in the mesh's unit frame."""
        a, b = self.points(self.vertices)[edges].swapaxes(0, 1)
        return np.asarray(np.linalg.norm(b - a, axis=1))

    def affordable(self, edges: Ints, error: Floats, wanted: Bools, hiding: Ints) -> Bools:
        """Return which of the wanted edges to split: beside planes not the shortest, nor too many.

        The longest that are off most come first.
        """
        self.rounds -= 1
        if self.pieces is None or not wanted.any():
            return self.together(edges, wanted)
        length = self.lengths(edges)
        shortest = _SHORTEST * self._mesh.edge_length / (self._mesh.diagonal or 1.0)
        wanted = wanted & (length > shortest)
        if self.rounds < _PLANE_ROUNDS - _ROUNDS:
            place, here = self._bounding(edges, hiding)
            beside = np.zeros(len(edges), bool)
            beside[place[here]] = True
            wanted &= beside
        room = max(0, (self.most - len(self.faces)) // 2)
        if np.count_nonzero(wanted) > room:
            weight = np.where(wanted, error * length, 0)
            least = np.partition(weight, len(weight) - room - 1)[len(weight) - room - 1]
            wanted &= weight > least
        return self.together(edges, wanted)

    def together(self, edges: Ints, wanted: Bools) -> Bools:
        """Return the wanted edges and their copies along seams."""
        if self._position is None:
            return wanted
        ends = np.sort(self._position[edges], axis=1)
        same = np.unique(ends[:, 0] * len(self._position) + ends[:, 1], return_inverse=True)[1]
        return np.bincount(same, wanted)[same] > 0

    def _bounding(self, edges: Ints, faces: Ints) -> tuple[Ints, Bools]:
        """Return for the sides of some triangles which edge each is, and whether it is any."""
        size = len(self.vertices.corners)
        keys = edges[:, 0] * size + edges[:, 1]
        corners = self.faces[faces]
        sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1), axis=-1)
        wanted = sides[..., 0] * size + sides[..., 1]
        place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        return place, keys[place] == wanted

    def split(self, edges: Ints, middles: Places, chosen: Bools) -> None:
        """Split triangles at the middles of the chosen edges."""
        before, count = self.faces, len(self.vertices.corners)
        new = edges[chosen]
        number = count + np.arange(len(new))
        self.vertices += middles.those(chosen)
        self.faces, parent = split_faces(self.faces, new, number)
        self._owner = self._owner[parent]
        self._active = np.bincount(parent)[parent] > 1
        if self._position is not None:
            self._active[:] = True  # a neighbour along a seam may have been split
            pairs = np.sort(self._position[new], axis=1)
            _, same = np.unique(pairs[:, 0] * count + pairs[:, 1], return_inverse=True)
            first = self._position.max() + 1
            self._position = np.concatenate([self._position, first + same.ravel()])
        if self.pieces is None:
            return
        old = np.arange(count)
        ends = np.concatenate([np.stack([old, old], axis=1), new])[self.faces]  # (k, 3, 2)
        shares = (ends[:, :, None, :] == before[parent][:, None, :, None]).mean(axis=-1)
        assert self.vertices.normals is not None
        self.pieces = self.pieces.handed_down(parent, shares, self.vertices.normals)

    def mesh(self) -> Mesh:
        """Return it as a mesh: attributes of vertices interpolated, those of faces handed down."""
        mesh = self._mesh
        new = slice(len(mesh.vertices), None)
        where, share = self.vertices.corners[new], self.vertices.weights[new]

        def spread(values: NDArray[Any]) -> NDArray[Any]:
            mean = np.einsum("nc,nc...->n...", share, values[where].astype(np.float64))
            if values.dtype.kind in "iub":
                mean = np.rint(mean)
            return np.concatenate([values, mean.astype(values.dtype)])

        points = np.einsum("nc,nci->ni", share, mesh.vertices[where])
        polygon = mesh._owner[self._owner]
        numeric = {k: v for k, v in mesh.attributes["vertex"].items() if v.dtype.kind in "iubf"}
        return Mesh(
            np.concatenate([mesh.vertices, points]),
            self.faces,
            attributes={
                "vertex": {name: spread(values) for name, values in numeric.items()},
                "face": {n: v[polygon] for n, v in mesh.attributes["face"].items()},
            },
            winding="keep",
            length_unit=mesh.length_unit,
            textures=self._textures,
        )

    def _textures(self) -> Textures | None:
        """Return the textures of the parts that triangles have become."""
        if self._mesh.textures is None:
            return None
        of = self._mesh.faces[self._owner]
        places = self.vertices.corners[self.faces]  # (k, 3, 3): of each corner, between which
        same = places[..., None] == of[:, None, None, :]
        shares = np.einsum("kcpo,kcp->kco", same, self.vertices.weights[self.faces])
        total = shares.sum(axis=2, keepdims=True)  # more than 1 where a triangle has a vertex twice
        return self._mesh.textures.parts(self._owner, shares / np.where(total > 0, total, 1))


def _pieces(mesh: Mesh) -> PiecewiseNormals | None:
    """Return normals of the triangles of a mesh with planes; parted ones have theirs."""
    if isinstance(mesh, PartedMesh):
        return None
    unit, group = mesh.diagonal or 1.0, mesh.groups
    return piecewise_normals(
        mesh.unit_points, mesh.faces, mesh.faces if group is None else group[mesh.faces],
        mesh.orientation.flipped, mesh.normals,
        edge=mesh.edge_length / unit, grain=_SINGLE * float(np.abs(mesh.vertices).max()) / unit,
    )  # fmt: skip
