"""What is odd about a mesh: none of it stops a bake, all of it is worth knowing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected
from meshdepict.surface.welding import same_position

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Defects", "find_defects"]

Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Defects:
    """Counts of what a mesh has too much or too little of.

    Vertices at bit-identical positions count as one in `parts` and in the edges.

    Attributes
    ----------
    parts : int
        Pieces that hang together by their vertices.
    unreferenced_vertices : int
        Met by no face.
    coincident_vertices : int
        At the position of an earlier vertex.
    degenerate_faces : int
        Triangles without area.
    duplicate_faces : int
        Triangles with the same three corners as an earlier one, in any order.
    border_edges : int
        With one face.
    nonmanifold_edges : int
        With more than two faces.
    """

    parts: int
    unreferenced_vertices: int
    coincident_vertices: int
    degenerate_faces: int
    duplicate_faces: int
    border_edges: int
    nonmanifold_edges: int


def find_defects(mesh: Mesh) -> Defects:
    """Count the defects of a mesh, polygons as the triangles that they are split into.

    Edges are those of faces with three different corners, duplicates among them.
    """
    n = len(mesh.vertices)
    label = same_position(mesh.vertices)
    faces = mesh.faces if label is None else label[mesh.faces]
    used = np.bincount(mesh.faces.ravel(), minlength=n) > 0
    a, b, c = faces.T
    distinct = (a != b) & (b != c) & (c != a)
    degenerate = int(np.count_nonzero(~(distinct & _has_area(mesh))))
    sides = _faces_per_edge(faces[distinct], n)
    component = connected(n, np.concatenate((a, b)), np.concatenate((b, c)))
    return Defects(
        parts=len(np.unique(component[faces])),
        unreferenced_vertices=int(np.count_nonzero(~used)),
        coincident_vertices=0 if label is None else n - int(label.max()) - 1,
        degenerate_faces=degenerate,
        duplicate_faces=_duplicates(faces[distinct]),
        border_edges=int(np.count_nonzero(sides == 1)),
        nonmanifold_edges=int(np.count_nonzero(sides > 2)),
    )


def _has_area(mesh: Mesh) -> NDArray[np.bool_]:
    a, b, c = (mesh.unit_points[corner] for corner in mesh.faces.T)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0


def _faces_per_edge(faces: Ints, n: int) -> Ints:
    keys = np.empty((3, len(faces)), np.int64)
    for corner in range(3):
        a, b = faces[:, corner], faces[:, corner - 1]
        keys[corner] = np.minimum(a, b) * n + np.maximum(a, b)
    return np.unique(keys, return_counts=True)[1]


def _duplicates(faces: Ints) -> int:
    corners = np.sort(faces, axis=1)
    corners = corners[np.lexsort(corners.T)]
    return int(np.count_nonzero((corners[1:] == corners[:-1]).all(axis=1)))
