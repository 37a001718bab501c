"""What lies across from the points of one surface on another one: rays along normals, both ways."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.transport.rays import ray_scene

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Across", "surface_across"]

Floats = NDArray[np.float64]

_BEHIND = 1e-6  # of the diagonal, before its point where a ray begins: rounding in float32


class Across(NamedTuple):
    """Places on a surface.

    Attributes
    ----------
    triangle : (n,) array of int32
        −1 where nothing was met.
    weights : (n, 3) array
        Barycentric coordinates.
    """

    triangle: NDArray[np.int32]
    weights: Floats


def surface_across(mesh: Mesh, points: Floats, normals: Floats, reach: float) -> Across:
    """Return the nearest place of a mesh along each normal or against it, if there is any.

    Faces that look the other way than the normal are the other side of a wall, and not met.

    Parameters
    ----------
    mesh : Mesh
    points : (n, 3) array
        In the mesh's unit frame.
    normals : (n, 3) array
        Unit.
    reach : float
        How far, in diagonals.
    """
    scene: Any = ray_scene(mesh)
    count = len(points)
    triangle, weights = np.full(count, -1, np.int32), np.zeros((count, 3))
    nearest = np.full(count, np.inf)
    corners = mesh.unit_points[mesh.outward_faces] if len(mesh.faces) < count else None
    for sign in (1.0, -1.0):
        directions = sign * normals
        origins = (points - _BEHIND * directions).astype(np.float32)
        far = np.full(count, reach + _BEHIND, np.float32)  # Embree writes into it
        met = scene.run(
            origins, directions.astype(np.float32), dists=far, query="INTERSECT", output=True
        )
        face = np.asarray(met["primID"], np.int64)
        hit = np.flatnonzero(face >= 0)
        face = face[hit]
        if corners is None:
            a, b, c = np.moveaxis(mesh.unit_points[mesh.outward_faces[face]], 1, 0)
        else:
            a, b, c = np.moveaxis(corners[face], 1, 0)
        facing = (np.cross(b - a, c - a) * normals[hit]).sum(axis=1) > 0
        distance = np.abs(np.asarray(met["tfar"], np.float64)[hit] - _BEHIND)
        better = facing & (distance < nearest[hit])
        chosen, face = hit[better], face[better]
        nearest[chosen] = distance[better]
        triangle[chosen] = face
        # Embree counts u and v from the corners as the mesh has them, turned or not.
        u, v = (np.clip(np.asarray(met[name], np.float64)[chosen], 0, 1) for name in "uv")
        weights[chosen] = np.stack([np.maximum(1 - u - v, 0), u, v], axis=1)
    return Across(triangle, weights)
