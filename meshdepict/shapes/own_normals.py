"""A file's own normals in place of computed ones: what its program meant by smooth and by sharp."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.document import Document
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.parted import PartedMesh
from meshdepict.surface.creases import Fans, parted_corners
from meshdepict.surface.polygons import as_polygons

__all__ = ["with_own_normals"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_COLUMNS = ("nx", "ny", "nz")
_NAMES = ("Normals", "normals")  # of arrays (n, 3) in VTK's data
_SHORTEST = 1e-12


def with_own_normals(mesh: Mesh) -> PartedMesh:
    """Return a mesh with the normals that its file holds; vertices that have several are parted.

    All of them are turned round where they look inwards on the whole. Where one is missing, or no
    direction, the computed one stays.

    Raises
    ------
    MeshdepictError
        Where the file holds none.
    """
    polygons = mesh.polygons or as_polygons(mesh.faces)
    vertex = polygons.connectivity
    found = _of_corners(mesh)
    if found is None:
        raise MeshdepictError(
            "normals='file' needs normals in the file, as PLY has them in nx, ny, nz, OBJ in vn, "
            "glTF in NORMAL and VTP in Normals: leave it out to compute them"
        )
    length = np.linalg.norm(np.where(np.isfinite(found), found, 0), axis=1)
    proper = np.isfinite(found).all(axis=1) & (length > _SHORTEST) & np.isfinite(length)
    unit = found / np.where(proper, length, 1)[:, None]
    if _agreement(mesh, vertex[proper], unit[proper]) < 0:
        warnings.warn(
            "the file's normals look inwards: they are turned", MeshdepictWarning, stacklevel=3
        )
        unit = -unit
    if not proper.all():
        unit[~proper] = mesh.normals[vertex[~proper]]
        warnings.warn(
            f"{np.count_nonzero(~proper):,} corners have no normal in the file: computed ones "
            "stand for them",
            MeshdepictWarning,
            stacklevel=3,
        )
    return _parted(mesh, vertex, unit + 0.0)


def _of_corners(mesh: Mesh) -> Floats | None:
    """Return the normals of the polygons' corners as the file has them, NaN where it has none."""
    polygons = mesh.polygons or as_polygons(mesh.faces)
    document = mesh.document
    if isinstance(document, Document) and document.describes(None, polygons):
        try:
            own = document.own_normals
        except MeshdepictError as error:  # "has a line …": the file is its subject
            raise MeshdepictError(f"normals='file' can't be had: the file {error}") from error
        if own is not None:
            normals, corner = own
            found: Floats = np.where(corner[:, None] >= 0, normals[corner], np.nan)
            return found
    held = mesh.attributes["vertex"]
    if set(_COLUMNS) <= set(held):
        each = np.stack([held[name].astype(np.float64) for name in _COLUMNS], axis=1)
        return np.asarray(each[polygons.connectivity])
    for name in _NAMES:
        if name in held and held[name].shape[1:] == (3,):
            return np.asarray(held[name][polygons.connectivity].astype(np.float64))
    return None


def _agreement(mesh: Mesh, vertex: Ints, unit: Floats) -> float:
    """Return how far normals at vertices point outwards."""
    return float(np.einsum("ki,ki,k->", unit, mesh.normals[vertex], mesh.unit_areas[vertex]))


def _parted(mesh: Mesh, vertex: Ints, unit: Floats) -> PartedMesh:
    """Return the mesh with a vertex for each normal that corners have at one."""
    group = np.arange(len(mesh.vertices)) if mesh.groups is None else mesh.groups
    kinds = np.unique(np.c_[group[vertex], unit], axis=0, return_inverse=True)[1]
    label = kinds.reshape(-1, 1)
    parts = parted_corners(vertex[:, None], Fans(label, np.ones(label.shape, bool)), group)
    normals = mesh.normals[parts.source]
    normals[parts.corners[:, 0]] = unit
    return PartedMesh(mesh, parts.source, parts.corners[:, 0], parts.group, normals=normals)
