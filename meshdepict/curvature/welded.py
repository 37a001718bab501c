"""A mesh with its seams closed: what normals and curvature are properties of."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Welded"]


class Welded:
    """A mesh's surface with one vertex for each group that shares its normal.

    Attributes
    ----------
    points : (w, 3) array
        In the mesh's private unit frame.
    faces : (m, 3) array of int
        Outward where the mesh's orientation could tell.
    """

    def __init__(self, mesh: Mesh) -> None:
        self._mesh = mesh
        self._group = mesh.groups
        self.points, self.faces = mesh.unit_points, mesh.outward_faces
        if self._group is not None:
            self._first = np.unique(self._group, return_index=True)[1]
            self.points, self.faces = self.points[self._first], self._group[self.faces]
        for array in (self.points, self.faces):
            array.setflags(write=False)  # kernels are compiled for read-only ones, and once

    def gathered(self, values: NDArray[Any]) -> NDArray[Any]:
        """Turn an array over the mesh's vertices, equal within groups, into one over these."""
        return values if self._group is None else values[self._first]

    def spread(self, values: NDArray[Any]) -> NDArray[Any]:
        """Turn an array over these vertices into one over the mesh's."""
        return values if self._group is None else values[self._group]

    @cached_property
    def crowd(self) -> NDArray[np.int64]:
        """(w,) how many of the mesh's vertices each one stands for."""
        if self._group is None:
            return np.ones(len(self.points), np.int64)
        return np.bincount(self._group)

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """(w,) mixed Voronoi areas in the unit frame."""
        return self.gathered(self._mesh.unit_areas) * self.crowd

    @cached_property
    def proper_faces(self) -> NDArray[np.int64]:
        """(k, 3) those between three different vertices."""
        a, b, c = self.faces.T
        proper = (a != b) & (b != c) & (c != a)
        return self.faces if proper.all() else self.faces[proper]

    @cached_property
    def border(self) -> NDArray[np.bool_]:
        """(w,) whether the vertex lies on an edge of one face alone."""
        a = self.proper_faces
        b = np.roll(a, -1, axis=1)
        low, high = np.minimum(a, b).ravel(), np.maximum(a, b).ravel()
        edge, count = np.unique(low * len(self.points) + high, return_counts=True)
        border = np.zeros(len(self.points), bool)
        border[np.concatenate(np.divmod(edge[count == 1], len(self.points)))] = True
        return border
