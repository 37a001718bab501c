"""What a ray asks of the triangles that it meets: their sides, and the normal in between."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.openings import open_faces
from meshdepict.threads import kernel

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Walls", "between", "farthest", "turning", "walls_of"]

Single = NDArray[np.float32]


class Walls(NamedTuple):
    """The triangles of a mesh as `paths` takes them.

    Attributes
    ----------
    faces : (m, 3) array of int32
        Corners in the order in which Embree counts barycentric weights.
    points : (v, 3) array of float64
        In the mesh's unit frame.
    outward : (m, 3) array of float32
        Unit normals of the triangles; zero of degenerate ones.
    opened : (m,) array of bool
        Whether both sides are real.
    sizes : (m,) array of float32
        Longest edges.
    """

    faces: NDArray[np.int32]
    points: NDArray[np.float64]
    outward: Single
    opened: NDArray[np.bool_]
    sizes: Single


_known: WeakKeyDictionary[Mesh, Walls] = WeakKeyDictionary()


def walls_of(mesh: Mesh) -> Walls:
    """Return the triangles of a mesh; kept as long as the mesh."""
    if mesh not in _known:
        a, b, c = (mesh.unit_points[corner] for corner in mesh.outward_faces.T)
        ab, ac, bc = b - a, c - a, c - b
        sizes = np.sqrt(np.max([np.einsum("ij,ij->i", e, e) for e in (ab, ac, bc)], axis=0))
        scale = np.where(sizes > 0, sizes, 1)[:, None]  # tiny triangles have normals, too
        outward: NDArray[Any] = np.cross(ab / scale, ac / scale)
        length = np.linalg.norm(outward, axis=1, keepdims=True)
        found = Walls(
            mesh.faces.astype(np.int32), mesh.unit_points,
            (outward / np.where(length > 0, length, 1)).astype(np.float32),
            open_faces(mesh.unit_points, mesh.faces), sizes.astype(np.float32),
        )  # fmt: skip
        for array in found:
            array.setflags(write=False)
        _known[mesh] = found
    return _known[mesh]


def between(values: NDArray[Any], faces: NDArray[Any], weights: NDArray[Any]) -> NDArray[Any]:
    """Return values of vertices (v, …) within triangles (k, 3), by weights (k, 2)."""
    second, third = weights[:, 0], weights[:, 1]
    shares = np.stack([np.maximum(1 - second - third, 0), second, third], axis=1)
    return np.einsum("kc,kc...->k...", shares.astype(values.dtype), values[faces])


def turning(mesh: Mesh, normals: NDArray[Any]) -> Single:
    """Return how far normals (v, 3) turn about each vertex, in radians per diagonal: (v,)."""
    walls = walls_of(mesh)
    corners = np.asarray(normals, np.float32)[walls.faces]
    steps = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    each_one = np.repeat(steps / np.where(walls.sizes > 0, walls.sizes, 1), 3)
    at = walls.faces.ravel()
    total, many = (np.bincount(at, w, len(walls.points)) for w in (each_one, None))
    return (total / np.maximum(many, 1)).astype(np.float32)


@kernel()
def farthest(normals, a, b, c):  # type: ignore[no-untyped-def]
    """Return the longest distance between two of three normals."""
    ab = bc = ca = np.float32(0)
    for axis in range(3):
        ab += (normals[b, axis] - normals[a, axis]) ** 2
        bc += (normals[c, axis] - normals[b, axis]) ** 2
        ca += (normals[a, axis] - normals[c, axis]) ** 2
    return math.sqrt(max(ab, bc, ca))
