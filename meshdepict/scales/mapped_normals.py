"""Normals that a mesh's normal maps give: finer than its triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.texture_frames import corner_tangents

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["TangentFrames", "mapped_normals"]

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class TangentFrames:
    """Where normal maps point to, at places within the triangles of a mesh.

    As MikkTSpace has it: normal and tangent are interpolated and not made unit again.

    Parameters
    ----------
    mesh : Mesh
    normals : (n, 3) array
        Of its vertices.
    texcoords : (m, 3, 2) array
        Of its triangles' corners.
    """

    def __init__(self, mesh: Mesh, normals: NDArray[np.floating], texcoords: Floats) -> None:
        self._faces, self._normals = mesh.faces, np.asarray(normals, np.float64)
        self._tangents, self._signs = corner_tangents(
            mesh.unit_points, mesh.faces, self._normals, texcoords
        )

    def at(self, triangle: Ints, weights: NDArray[np.floating]) -> tuple[Floats, Floats, Floats]:
        """Return tangent, bitangent and normal (n, 3) at places in triangles."""
        normal = np.einsum("nc,ncx->nx", weights, self._normals[self._faces[triangle]])
        tangent = np.einsum("nc,ncx->nx", weights, self._tangents[triangle])
        return tangent, self._signs[triangle][:, None] * np.cross(normal, tangent), normal


def mapped_normals(
    frames: TangentFrames, textures: Textures, triangle: Ints, weights: NDArray[np.floating]
) -> Floats:
    """Return unit normals (n, 3) at places in triangles, turned as their normal maps say."""
    tangent, bitangent, normal = frames.at(triangle, weights)
    found = normal.copy()
    texcoords = textures.texcoords
    if textures.normal_texcoords is not None:
        texcoords = textures.normal_texcoords
    material = textures.material[triangle]
    for k, texture in enumerate(textures.normal_maps):
        if texture is None or not (chosen := material == k).any():
            continue
        at = np.einsum("nc,ncx->nx", weights[chosen], texcoords[triangle[chosen]])
        x, y, z = (2 * texture.lookup(at).astype(np.float64) - 1).T
        scale = textures.normal_scales[k]
        turned = (
            (scale * x)[:, None] * tangent[chosen]
            + (scale * y)[:, None] * bitangent[chosen]
            + z[:, None] * normal[chosen]
        )
        some = np.linalg.norm(turned, axis=1) > 1e-6
        found[chosen] = np.where(some[:, None], turned, normal[chosen])
    length = np.linalg.norm(found, axis=1, keepdims=True)
    up = (0.0, 0.0, 1.0)
    return np.where(length > 1e-9, found / np.where(length > 1e-9, length, 1), up)
