"""Meshes whose vertices were parted, so that each has one normal: at creases, or as files say."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scene.vectors import frozen
from meshdepict.shapes.document import Document
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.components import connected
from meshdepict.surface.creases import Fans, fans_between_creases, parted_corners
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.textures import Textures
    from meshdepict.surface.sides import Sides

__all__ = ["PartedMesh", "check_creases", "crease_fans", "parted_at_creases"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SINGLE = 6e-8  # relative rounding of single precision, in which files hold coordinates


@dataclass(frozen=True, kw_only=True)
class PartedDocument(Document):
    """What a parted mesh keeps of its file: who wrote it, and texture coordinates of corners."""

    polygons: Polygons
    texture: tuple[Floats, Ints] | None

    @property
    def texcoords(self) -> tuple[Floats, Ints] | None:
        """(t, 2) texture coordinates, and which of them each corner has (−1: none), or None."""
        return self.texture

    def describes(self, vertices: Floats | None, polygons: Polygons) -> bool:
        """Whether these are the polygons, and no vertices are asked about."""
        return vertices is None and all(map(np.array_equal, self.polygons, polygons))


class PartedMesh(Mesh):
    """A mesh with several vertices where another has one: copies with all its data.

    Parameters
    ----------
    mesh : Mesh
        The other one.
    source : (n,) array
        Its vertex that each stands for; its own come first, in order.
    connectivity : array
        Of its polygons, in the new vertices.
    group : (n,) array
        One number, from 0, for those that share a normal.
    normals : (n, 3) array, optional
        Unit, where they are known.
    creases : float, optional
        The angle that it was parted at.

    Attributes
    ----------
    before : Mesh
        The other one.
    source, creases
        As given.
    chosen_normals : {"computed", "file"}
    """

    def __init__(
        self,
        mesh: Mesh,
        source: Ints,
        connectivity: Ints,
        group: Ints,
        *,
        normals: Floats | None = None,
        creases: float | None = None,
    ) -> None:
        before = mesh.polygons or as_polygons(mesh.faces)
        polygons = Polygons(connectivity, before.offsets)
        document = mesh.document
        if isinstance(mesh.document, Document) and len(source) > len(mesh.vertices):
            own, found = mesh.document, None
            if own.texcoords is not None and own.describes(None, before):
                found = own.texcoords
            document = PartedDocument(
                provenance=own.provenance, up=own.up, polygons=polygons, texture=found
            )
        vertex = {name: values[source] for name, values in mesh.attributes["vertex"].items()}
        super().__init__(
            mesh.vertices[source],
            polygons,
            attributes={"vertex": vertex, "face": mesh.attributes["face"]},
            winding=mesh.winding,
            document=document,
            length_unit=mesh.length_unit,
            groups=group,
        )
        self.source = source
        self.creases, self.chosen_normals = creases, "computed" if normals is None else "file"
        self.before, self._known = mesh, None if normals is None else frozen(normals)

    @cached_property
    def textures(self) -> Textures | None:
        """Those of the other mesh: their corners are the same."""
        return self.before.textures

    @property
    def added(self) -> int:
        """How many vertices were added."""
        return len(self.vertices) - len(self.before.vertices)

    @cached_property
    def patches(self) -> Ints | None:
        """For each vertex the patch between creases that it lies on; None: there is but one."""
        group = self.groups
        if self.creases is None or group is None:
            return None
        a, b, c = group[self.faces].T
        ends = np.concatenate([a, b]), np.concatenate([b, c])
        patch = connected(int(group.max()) + 1, *ends)[group]
        used = np.zeros(len(patch), bool)
        used[self.faces] = True
        return frozen(patch) if np.ptp(patch[used]) else None

    @cached_property
    def _sides(self) -> Sides:
        return self.before._sides.renumbered(self.faces, self.source)  # turned as it was

    @cached_property
    def normals(self) -> Floats:
        """(n, 3) unit normals: the known ones, or of each vertex's own side.

        Max's weights grow as triangles shrink: where a tiny one that is folded over decides, and
        turns a normal by more than a crease, areas do instead.
        """
        if self._known is not None:
            return self._known
        found = super().normals
        if self.creases is None or self.groups is None:
            return found
        a, b, c = self.unit_points[self.outward_faces].swapaxes(0, 1)
        cross = np.cross(b - a, c - a)
        group, count = self.groups[self.faces].ravel(), int(self.groups.max()) + 1
        sums = np.stack(
            [np.bincount(group, np.repeat(axis, 3), minlength=count) for axis in cross.T], axis=1
        )
        length = np.linalg.norm(sums, axis=1, keepdims=True)
        by_area = (sums / np.where(length > 0, length, 1))[self.groups]
        off = (found * by_area).sum(axis=1) < np.cos(np.radians(self.creases))
        off &= length[self.groups, 0] > 0
        return frozen(np.where(off[:, None], by_area, found))


def check_creases(creases: Any) -> None:
    """Refuse what is no angle.

    Raises
    ------
    MeshdepictError
        For anything but degrees between 0 and 180.
    """
    if not 0 < (real(creases) or 0) < 180:
        raise MeshdepictError(
            f"creases={creases!r} is not an angle in degrees between 0 and 180, such as 40"
        )


def parted_at_creases(mesh: Mesh, creases: float) -> PartedMesh:
    """Return a mesh with vertices of their own for both sides of sharp edges.

    Parameters
    ----------
    mesh : Mesh
        It stays as it is.
    creases : float
        Degrees from one triangle's plane to the next from which an edge is sharp.

    Raises
    ------
    MeshdepictError
        For anything but degrees between 0 and 180.
    """
    check_creases(creases)
    group = mesh.groups
    parts = parted_corners(
        mesh.faces,
        crease_fans(mesh, creases),
        np.arange(len(mesh.vertices)) if group is None else group,
    )
    connectivity = _of_polygons(mesh, parts.corners)
    return PartedMesh(mesh, parts.source, connectivity, parts.group, creases=float(creases))


def crease_fans(mesh: Mesh, creases: float) -> Fans:
    """Return what hangs together between a mesh's sharp edges."""
    group, unit = mesh.groups, mesh.diagonal or 1.0
    return fans_between_creases(
        mesh.unit_points,
        mesh.faces,
        mesh.faces if group is None else group[mesh.faces],
        mesh.orientation.flipped,
        angle=np.radians(creases),
        owner=None if mesh.polygons is None else mesh._owner,
        grain=_SINGLE * float(np.abs(mesh.vertices).max()) / unit,
    )


def _of_polygons(mesh: Mesh, corners: Ints) -> Ints:
    """Return the connectivity of a mesh's polygons from the new corners of its triangles."""
    if mesh.polygons is None:
        return corners.ravel()
    connectivity, offsets = mesh.polygons
    size = len(mesh.vertices)
    polygon = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    known = (mesh._owner[:, None] * size + mesh.faces).ravel()
    keys, first = np.unique(known, return_index=True)
    wanted = polygon * size + connectivity
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    # A polygon of two corners has no triangle: its vertices stay.
    return np.where(keys[place] == wanted, corners.ravel()[first[place]], connectivity)
