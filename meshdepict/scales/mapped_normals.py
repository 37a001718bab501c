"""Normals that a mesh's normal maps give: finer than its triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.frames import tangents
from meshdepict.scales.interpolated_scales import bent
from meshdepict.surface.texture_frames import corner_tangents

if TYPE_CHECKING:
    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["NormalMaps", "TangentFrames"]

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


class NormalMaps:
    """The normals that a mesh's normal maps give, and how they bend.

    Parameters
    ----------
    mesh : Mesh
    normals : (n, 3) array
        Of its vertices.
    textures : Textures
        With normal maps whose pictures can be had.
    """

    def __init__(self, mesh: Mesh, normals: NDArray[np.floating], textures: Textures) -> None:
        self._mesh, self._textures = mesh, textures
        own = textures.normal_texcoords
        self._texcoords = textures.texcoords if own is None else own
        self._frames = TangentFrames(mesh, normals, self._texcoords)
        # The last one of what has no material.
        maps = (*textures.normal_maps, None)
        self._mapped = np.array([each is not None for each in maps])
        self._steps = 1 / np.array(
            [1 if each is None else min(each.pixels.shape[:2]) for each in maps]
        )

    def reach(self, triangle: Ints) -> NDArray[np.bool_]:
        """Return which triangles have a normal map."""
        found: NDArray[np.bool_] = self._mapped[self._textures.material[triangle]]
        return found

    def at(self, triangle: Ints, weights: NDArray[np.floating]) -> Floats:
        """Return unit normals (n, 3) at places in triangles."""
        tangent, bitangent, normal = self._frames.at(triangle, weights)
        found = normal.copy()
        material = self._textures.material[triangle]
        for k, texture in enumerate(self._textures.normal_maps):
            if texture is None or not (chosen := material == k).any():
                continue
            at = np.einsum("nc,ncx->nx", weights[chosen], self._texcoords[triangle[chosen]])
            x, y, z = (2 * texture.lookup(at).astype(np.float64) - 1).T
            scale = self._textures.normal_scales[k]
            turned = (
                (scale * x)[:, None] * tangent[chosen]
                + (scale * y)[:, None] * bitangent[chosen]
                + z[:, None] * normal[chosen]
            )
            some = np.linalg.norm(turned, axis=1, keepdims=True) > 1e-6
            found[chosen] = np.where(some, turned, normal[chosen])
        length = np.linalg.norm(found, axis=1, keepdims=True)
        up = (0.0, 0.0, 1.0)
        return np.where(length > 1e-9, found / np.where(length > 1e-9, length, 1), up)

    def curvature(self, triangle: Ints, weights: NDArray[np.floating]) -> PrincipalCurvatures:
        """Return how the normals turn from one texel of their map to the next, per world unit.

        0 in triangles that have no area in the map.
        """
        normal = self.at(triangle, weights)
        a = tangents(normal)
        b = np.cross(normal, a)
        texcoords = self._texcoords[triangle]
        points = self._mesh.unit_points[self._mesh.faces[triangle]] * (self._mesh.diagonal or 1.0)
        sides, edges = texcoords[:, 1:] - texcoords[:, :1], points[:, 1:] - points[:, :1]
        double = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
        firm = np.abs(double) > 1e-30
        whole = np.where(firm, double, 1.0)
        step = self._steps[self._textures.material[triangle]]
        moved, turned = [], []
        for axis in (0, 1):  # one texel along u, then along v
            sign = 1 - 2 * axis
            second = sign * sides[:, 1, 1 - axis] / whole * step
            third = -sign * sides[:, 0, 1 - axis] / whole * step
            share = np.where(firm, np.stack([-second - third, second, third]), 0).T
            moved.append(np.einsum("nk,nkx->nx", share[:, 1:], edges))
            turned.append(
                (self.at(triangle, weights + share) - self.at(triangle, weights - share)) / 2
            )
        p = np.array([[(m * e).sum(axis=1) for e in (a, b)] for m in moved])
        n = np.array([[(t * e).sum(axis=1) for e in (a, b)] for t in turned])
        area = p[0, 0] * p[1, 1] - p[0, 1] * p[1, 0]
        some = np.abs(area) > 1e-30
        area = np.where(some, area, 1.0)
        # S p = n for both steps, made symmetric.
        aa = (n[0, 0] * p[1, 1] - n[1, 0] * p[0, 1]) / area
        bb = (n[1, 1] * p[0, 0] - n[0, 1] * p[1, 0]) / area
        ab = (n[1, 0] * p[0, 0] - n[0, 0] * p[1, 0] + n[0, 1] * p[1, 1] - n[1, 1] * p[0, 1]) / area
        return bent(a, b, *(np.where(some, value, 0.0) for value in (aa, ab / 2, bb)))
