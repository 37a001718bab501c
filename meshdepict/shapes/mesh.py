"""Mesh: vertices, faces and attributes as they were given; what follows from them is `Geometry`."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from copy import copy
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.document import Document
from meshdepict.shapes.fingerprint import fingerprint
from meshdepict.shapes.geometry import Geometry
from meshdepict.shapes.summary import data_rows, mesh_rows
from meshdepict.shapes.table import html_table
from meshdepict.surface.mesh_input import (
    as_vertices,
    check_indices,
    checked_attributes,
    checked_groups,
    place_strays,
)
from meshdepict.surface.polygons import (
    FacesLike,
    Polygons,
    as_polygons,
    polygon_corners,
    triangulate,
)

if TYPE_CHECKING:
    from meshdepict.shapes.document import Contents
    from meshdepict.shapes.textures import Textures

__all__ = ["Mesh"]

Floats = NDArray[np.float64]


class Mesh(Geometry):
    """A surface of triangles or polygons, validated once, never modified.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Positions in world units.
    faces : (m, 3) or (m, k) array_like of int, a list of polygons, or `Polygons`
        Vertex indices, counter-clockwise seen from outside.
    attributes : {"vertex": {name: (n, …)}, "face": {name: (polygons, …)}}, optional
        What else is known at vertices and polygons, colours for instance.
    winding : {"auto", "keep"}
        "auto" turns faces that point inwards before normals are computed (see `orientation`);
        `faces` themselves stay as given. "keep" believes the file.
    document : object, optional
        What the file's reader wants the file's writer to know.
    length_unit : str
        What the coordinates are measured in, "m" or "mm" for instance; empty where unknown.
    groups : (n,) array of int, optional
        Which vertices share a normal, numbered from 0 without gaps; found by position unless given.
    textures : Textures, or a function that returns them, optional
        In place of those of the file. A function is called when they are asked for.

    Raises
    ------
    MeshdepictError
        For an empty mesh, wrong shapes, an index out of range, and NaN or infinite vertices that
        faces use.
    """

    kind = "mesh"

    def __init__(
        self,
        vertices: ArrayLike,
        faces: FacesLike,
        *,
        attributes: Mapping[str, Mapping[str, Any]] | None = None,
        winding: str = "auto",
        document: object = None,
        length_unit: str = "",
        groups: NDArray[np.int64] | None = None,
        textures: Textures | Callable[[], Textures | None] | None = None,
    ) -> None:
        self.vertices = as_vertices(vertices)
        polygons = as_polygons(faces)
        if len(polygons.connectivity) == 0:
            raise MeshdepictError(
                f"the mesh has no faces ({len(self.vertices):,} vertices): shading needs a "
                "surface; reconstruct one from the points first"
            )
        check_indices(polygons, len(self.vertices))
        used = np.zeros(len(self.vertices), bool)
        used[polygons.connectivity] = True
        if strays := place_strays(self.vertices, used):
            warnings.warn(
                f"{strays:,} vertices that no face uses are NaN, infinite or too far away: they "
                "are left out",
                MeshdepictWarning,
                stacklevel=2,
            )
        if not isinstance(winding, str) or winding not in ("auto", "keep"):
            raise MeshdepictError(f"winding={winding!r} is neither 'auto' nor 'keep'")
        self.faces, self._owner = triangulate(self.vertices, polygons)
        if len(self.faces) == 0:
            raise MeshdepictError("the mesh has no faces with three corners or more")
        self.polygons = None if (np.diff(polygons.offsets) == 3).all() else polygons
        self.attributes = checked_attributes(
            {} if attributes is None else attributes,
            vertex=len(self.vertices),
            face=len(polygons.offsets) - 1,
        )
        self.winding = winding
        self.document = document
        self.length_unit = length_unit
        self._groups = None if groups is None else checked_groups(groups, len(self.vertices))
        self._textures = textures if textures is None or callable(textures) else self._fit(textures)
        for array in (self.vertices, self.faces, self._owner, *polygons):
            array.setflags(write=False)

    @classmethod
    def from_pyvista(cls, poly: object, *, winding: str = "auto") -> Mesh:
        """Take the polygons and strips of a ``pyvista.PolyData`` with its point and cell arrays.

        Strips become triangles; lines and single vertices are left out. The 8-bit colours "RGB"
        or "RGBA" become the vertex attributes red, green, blue and alpha. Of solid cells and of
        blocks the surface is taken, with a note.

        Raises
        ------
        MeshdepictError
            For what has no surface, such as ``ImageData``, and as `Mesh`.
        """
        from meshdepict.shapes.exchange import polydata_contents

        return cls._of(polydata_contents(poly), winding)

    @classmethod
    def from_trimesh(cls, tm: object, *, winding: str = "auto") -> Mesh:
        """Take the faces of a ``trimesh.Trimesh`` with its colours and attributes.

        Colours become the vertex or face attributes red, green, blue and, where any is
        transparent, alpha. The meshes of a ``Scene`` become one.

        Raises
        ------
        MeshdepictError
            For what has no faces, such as a ``PointCloud``, and as `Mesh`.
        """
        from meshdepict.shapes.exchange import trimesh_contents

        return cls._of(trimesh_contents(tm), winding)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData`` with the polygons and all arrays, which are copied.

        8-bit vertex colours become the array "RGB"; `from_pyvista` takes all of it back.
        """
        from meshdepict.shapes.exchange import to_polydata

        faces = self.faces if self.polygons is None else self.polygons
        return to_polydata(self.vertices, faces, self.attributes["vertex"], self.attributes["face"])

    def to_trimesh(self) -> Any:
        """Return a ``trimesh.Trimesh`` of the triangles, vertices in the same order.

        Its vertex arrays go along, 8-bit colours as trimesh's own; those of faces don't.
        """
        from meshdepict.shapes.exchange import to_trimesh

        return to_trimesh(self.vertices, self.faces, self.attributes["vertex"])

    @classmethod
    def _of(cls, contents: Contents, winding: str) -> Mesh:
        vertices, faces, attributes, document, length_unit = contents
        return cls(
            vertices,
            faces,
            attributes=attributes,
            winding=winding,
            document=document,
            length_unit=length_unit,
        )

    def __repr__(self) -> str:
        """Return counts and size."""
        faces = len(self.faces) if self.polygons is None else len(self.polygons.offsets) - 1
        size = f"diagonal {self.diagonal:.4g}"
        return f"<Mesh: {len(self.vertices):,} vertices, {faces:,} faces, {size}>"

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        return html_table([*mesh_rows(self), *data_rows(self)], "Mesh")

    # --- what every kind of shape has -------------------------------------------------------

    @cached_property
    def identity(self) -> str:
        """Counts, and the fingerprint of vertices and triangles."""
        counts = f"{len(self.vertices)} vertices {len(self.faces)} triangles"
        return f"{counts} sha256 {fingerprint(self.vertices, self.faces)}"

    @cached_property
    def textures(self) -> Textures | None:
        """The textures that the mesh was given, or that its file names; None without any.

        Nothing of them is read before they are asked for, and no picture is decoded before its
        pixels are.
        """
        if callable(self._textures):
            found = self._textures()
            return None if found is None else self._fit(found)
        if self._textures is not None or not isinstance(self.document, Document):
            return self._textures
        polygons = self.polygons or as_polygons(self.faces)
        if not self.document.describes(None, polygons):
            return None
        return self.document.textures(self.triangle_corners)

    @property
    def triangle_corners(self) -> NDArray[np.int64]:
        """(m, 3) which of all polygons' corners, counted one after the other, triangles have."""
        polygons = self.polygons or as_polygons(self.faces)
        return polygon_corners(self.faces, self._owner, polygons)

    def _fit(self, textures: Textures) -> Textures:
        """Return textures that fit the mesh's triangles."""
        from meshdepict.shapes.textures import Textures

        if not isinstance(textures, Textures):
            raise MeshdepictError(
                f"textures={textures!r:.80} are neither Textures nor a function that returns them"
            )
        if len(textures.material) != len(self.faces):
            raise MeshdepictError(
                f"textures of {len(textures.material):,} triangles don't fit a mesh of "
                f"{len(self.faces):,}"
            )
        return textures

    @property
    def texcoords(self) -> NDArray[np.float64] | None:
        """(m, 3, 2) texture coordinates of the triangles' corners, v up; None without textures."""
        return None if self.textures is None else self.textures.texcoords

    def with_textures(self, textures: Textures) -> Mesh:
        """Return the mesh with other textures in place of those that it has.

        Raises
        ------
        MeshdepictError
            For textures of another number of triangles.
        """
        other = copy(self)
        vars(other)["textures"] = other._textures = self._fit(textures)
        return other

    # --- other faces ------------------------------------------------------------------------

    def rewound(self) -> Mesh:
        """Return the mesh with its faces themselves turned outwards; itself where they are.

        Vertices, attributes, the order of the faces and the first corner of each stay, and so do
        textures for shading. What else the file held is left behind, texture coordinates with a
        warning: they are not saved.
        """
        flipped = self.orientation.flipped
        if not flipped.any():
            return self
        kept = self._provenance_alone("faces are turned")
        polygons = self.polygons or as_polygons(self.faces)
        # Degenerate triangles are never turned: a polygon goes the way of most of its area.
        a, b, c = (self.unit_points[corner] for corner in self.faces.T)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        count = len(polygons.offsets) - 1
        turned = np.bincount(self._owner, np.where(flipped, areas, -areas), minlength=count) > 0
        mesh = Mesh(
            self.vertices,
            polygons.reversed(turned),
            attributes=self.attributes,
            winding="keep",
            document=kept,
            length_unit=self.length_unit,
        )
        numbers = Polygons(np.arange(len(polygons.connectivity)), polygons.offsets)
        corner = numbers.reversed(turned).connectivity
        mesh._textures = partial(self._turned_textures, mesh, corner)
        return mesh

    def _turned_textures(self, other: Mesh, corner: NDArray[np.int64]) -> Textures | None:
        from meshdepict.shapes.turned_textures import Split, turned_textures

        before, after = (Split(mesh.triangle_corners, mesh._owner) for mesh in (self, other))
        return turned_textures(self.textures, before, after, corner)

    def as_triangles(self) -> Mesh:
        """Return the mesh with the triangles that are shaded as its faces; itself if they are.

        Polygons and strips of a file become triangles, their data each triangle's. Vertices stay;
        what else the file held is left behind, texture coordinates with a warning.
        """
        strips = isinstance(self.document, Document) and self.document.has_strips
        if self.polygons is None and not strips:
            return self
        return Mesh(
            self.vertices,
            self.faces,
            attributes={
                "vertex": self.attributes["vertex"],
                "face": {n: values[self._owner] for n, values in self.attributes["face"].items()},
            },
            winding=self.winding,
            document=self._provenance_alone("polygons become triangles"),
            length_unit=self.length_unit,
            textures=partial(getattr, self, "textures"),
        )

    def _provenance_alone(self, where: str) -> Document | None:
        """Return what of its file's document fits other faces, too."""
        if not isinstance(self.document, Document):
            return None
        if self.document.texcoords is not None or self.document.is_textured:
            warnings.warn(
                f"texture coordinates are lost where {where}", MeshdepictWarning, stacklevel=3
            )
        return Document(provenance=self.document.provenance, up=self.document.up)
