"""Texture coordinates that a mesh came with, whether or not it has a picture to lay there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.shapes.document import Document
from meshdepict.surface.polygons import as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["file_texcoords", "own_texcoords"]

Floats = NDArray[np.float64]

# Names of a vertex's coordinates, as MeshLab, Blender and glTF's readers have them.
_NAMES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))


def own_texcoords(mesh: Mesh) -> tuple[Floats, NDArray[np.bool_]] | None:
    """Return coordinates (m, 3, 2) of the triangles' corners, and which triangles (m,) have them.

    Those of the mesh's textures, else those that its file has at corners or at vertices; None
    without any. Where a triangle has none, or such as are no numbers, they are 0.
    """
    if mesh.textures is not None:
        laid = mesh.textures.texcoords
        blank = (laid == 0).all(axis=2).any(axis=1)  # what has none has no material either
        return laid, ~((mesh.textures.material < 0) & blank)
    found = file_texcoords(mesh)
    if found is None:
        return None
    placed = np.asarray(np.isfinite(found).all(axis=(1, 2)))
    return np.where(placed[:, None, None], found, 0.0), placed


def file_texcoords(mesh: Mesh) -> Floats | None:
    """Return the coordinates (m, 3, 2) that a mesh's file has at corners, else at vertices.

    NaN where a corner has none; None without any.
    """
    found = _of_corners(mesh)
    return _of_vertices(mesh) if found is None else found


def _of_corners(mesh: Mesh) -> Floats | None:
    document, polygons = mesh.document, mesh.polygons or as_polygons(mesh.faces)
    if not isinstance(document, Document) or document.texcoords is None:
        return None
    places, corner = document.texcoords
    if len(corner) != len(polygons.connectivity) or not document.describes(None, polygons):
        return None
    at = np.where(corner[:, None] >= 0, places[corner], np.nan)
    return np.asarray(at[mesh.triangle_corners], np.float64)


def _of_vertices(mesh: Mesh) -> Floats | None:
    vertex = mesh.attributes["vertex"]
    for names in _NAMES:
        if all(name in vertex and vertex[name].dtype.kind == "f" for name in names):
            of_vertices = np.stack([vertex[name] for name in names], axis=1).astype(np.float64)
            return np.asarray(of_vertices[mesh.faces])
    return None
