"""Several meshes as one surface, for rays that meet all of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.vectors import frozen
from meshdepict.shapes.document import Document
from meshdepict.shapes.mesh import Mesh

__all__ = ["JoinedMesh"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class JoinedMesh(Mesh):
    """The vertices and triangles of some meshes, one mesh after the other.

    Normals, and which sides are outside, are each mesh's own: nothing is joined where they touch.

    Parameters
    ----------
    meshes : sequence of Mesh

    Attributes
    ----------
    meshes : tuple of Mesh
    parts : tuple of slice
        Which of the vertices are those of each.
    """

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        starts = [0, *accumulate(len(mesh.vertices) for mesh in meshes)]
        self.meshes = tuple(meshes)
        self.parts = tuple(slice(*ends) for ends in pairwise(starts))
        units = {mesh.length_unit for mesh in meshes}
        ups = {str(getattr(mesh.document, "up", "")) for mesh in meshes}
        super().__init__(
            np.concatenate([mesh.vertices for mesh in meshes]),
            self._of_each("faces"),
            winding="keep",
            document=Document(up=ups.pop() if len(ups) == 1 else ""),
            length_unit=units.pop() if len(units) == 1 else "",
        )

    def _of_each(self, name: str) -> Ints:
        """Return triangles of every mesh, in the vertices of all."""
        pairs = zip(self.meshes, self.parts, strict=True)
        return np.concatenate([getattr(mesh, name) + part.start for mesh, part in pairs])

    @cached_property
    def outward_faces(self) -> Ints:
        """The triangles, turned outwards as in each mesh."""
        return frozen(self._of_each("outward_faces"))

    @cached_property
    def normals(self) -> Floats:
        """(n, 3) those of each mesh."""
        return frozen(np.concatenate([mesh.normals for mesh in self.meshes]))

    @cached_property
    def open_faces(self) -> NDArray[np.bool_]:
        """Of each triangle, whether its part of its own mesh has a boundary."""
        return frozen(np.concatenate([mesh.open_faces for mesh in self.meshes]))

    @cached_property
    def outline(self) -> Floats:
        """Points (k, 3) that a fitted view has to show."""
        return np.concatenate([mesh.outline for mesh in self.meshes])

    @cached_property
    def coverage(self) -> NDArray[np.float32] | None:
        """How much (n,) a picture shows of each vertex, in [0, 1]; None: all of everything."""
        known = [getattr(mesh, "coverage", None) for mesh in self.meshes]
        if all(each is None for each in known):
            return None
        pairs = zip(self.meshes, known, strict=True)
        parts = [
            np.ones(len(mesh.vertices), np.float32) if each is None else each
            for mesh, each in pairs
        ]
        return np.concatenate(parts)
