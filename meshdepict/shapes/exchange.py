"""Meshes of PyVista and trimesh, both ways, with their colours and their other data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.document import Contents, Document
from meshdepict.surface.polygons import Polygons, strip_triangles

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["polydata_contents", "polydata_geometry", "to_polydata", "trimesh_contents"]

Arrays = dict[str, NDArray[Any]]

_FIELD = "meshdepict"  # the field array that holds the provenance
_CHANNELS = ("red", "green", "blue", "alpha")
# Arrays of 8-bit colours, and the attributes that they stand for.
_COLORS = {
    "RGB": _CHANNELS,
    "RGBA": _CHANNELS,
    "original_RGB": tuple(f"original_{channel}" for channel in _CHANNELS),
}


def polydata_contents(poly: Any) -> Contents:
    """Return what `Mesh` needs of a ``pyvista.PolyData``.

    Raises
    ------
    MeshdepictError
        For anything but a ``PolyData``.
    """
    if not all(hasattr(poly, name) for name in ("GetPolys", "point_data", "cell_data")):
        raise MeshdepictError(f"expected a pyvista.PolyData, got a {type(poly).__name__}")
    vertices, polygons, cell = polydata_geometry(poly)
    attributes = {
        "vertex": _colors_apart(_fitting(poly.point_data, len(vertices))),
        "face": {
            name: values[cell] for name, values in _fitting(poly.cell_data, poly.n_cells).items()
        },
    }
    lines = tuple(str(line) for line in poly.field_data.get(_FIELD, ()))
    return Contents(vertices, polygons, attributes, Document(provenance=lines))


def polydata_geometry(poly: Any) -> tuple[NDArray[Any], Polygons, NDArray[np.int64]]:
    """Return points, polygons (strips as triangles) and the cells that these come from.

    Parameters
    ----------
    poly : vtkPolyData

    Returns
    -------
    points : (n, 3) array
        In VTK's own memory.
    polygons : Polygons
    cell : (polygons,) array of int
        Where the data of each polygon stand among those of all cells.
    """
    from vtkmodules.util.numpy_support import vtk_to_numpy

    points = poly.GetPoints()
    vertices = vtk_to_numpy(points.GetData()) if points else np.empty((0, 3))
    polygons, strips = _cells(poly.GetPolys()), _cells(poly.GetStrips())
    first = poly.GetNumberOfVerts() + poly.GetNumberOfLines()
    cell = first + np.arange(len(polygons.offsets) - 1)
    if len(strips.connectivity):
        triangles, owner = strip_triangles(strips)
        ends = polygons.offsets[-1] + 3 * np.arange(1, len(triangles) + 1)
        cell = np.concatenate((cell, first + len(cell) + owner))
        polygons = Polygons(
            np.concatenate((polygons.connectivity, triangles.reshape(-1))),
            np.concatenate((polygons.offsets, ends)),
        )
    return vertices, polygons, cell


def to_polydata(
    mesh: Mesh, attributes: Mapping[str, NDArray[Any]], lines: Iterable[str] = ()
) -> Any:
    """Return a ``pyvista.PolyData`` with a mesh's polygons, all of it copied.

    Parameters
    ----------
    mesh : Mesh
        Its face attributes become cell arrays.
    attributes : {name: (n, …)}
        Of the vertices; 8-bit red, green and blue become the array "RGB".
    lines : iterable of str
        Provenance, kept in the field data.
    """
    import pyvista as pv

    poly = pv.PolyData()
    poly.points = mesh.vertices.copy()
    if mesh.polygons is None:
        cells = pv.CellArray.from_regular_cells(mesh.faces, deep=True)
    else:
        connectivity, offsets = mesh.polygons
        cells = pv.CellArray.from_arrays(offsets, connectivity, deep=True)
    poly.SetPolys(cells)
    for data, arrays in (
        (poly.point_data, _colors_together(attributes)),
        (poly.cell_data, mesh.attributes["face"]),
    ):
        for name, values in arrays.items():
            data[name] = values.reshape(len(values), -1) if values.ndim > 2 else values.copy()
    if lines := list(lines):
        poly.field_data[_FIELD] = lines
    return poly


def trimesh_contents(tm: Any) -> Contents:
    """Return what `Mesh` needs of a ``trimesh.Trimesh``.

    Raises
    ------
    MeshdepictError
        For anything but a ``Trimesh``.
    """
    if not all(hasattr(tm, name) for name in ("vertices", "faces", "visual")):
        raise MeshdepictError(f"expected a trimesh.Trimesh, got a {type(tm).__name__}")
    attributes = {
        "vertex": _fitting(tm.vertex_attributes, len(tm.vertices)),
        "face": _fitting(tm.face_attributes, len(tm.faces)),
    }
    kind = tm.visual.kind
    if kind in attributes:
        colors = np.asarray(getattr(tm.visual, f"{kind}_colors")).T
        opaque = bool((colors[3] == 255).all())
        attributes[kind] |= dict(zip(_CHANNELS, colors[:3] if opaque else colors, strict=False))
    return Contents(np.asarray(tm.vertices), np.asarray(tm.faces), attributes, Document())


def _cells(cells: Any) -> Polygons:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if not cells.GetNumberOfCells():
        return Polygons(np.empty(0, np.int64), np.zeros(1, np.int64))
    return Polygons(
        vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64),
        vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64),
    )


def _fitting(arrays: Mapping[str, Any], count: int) -> Arrays:
    """Return those arrays that have a row for each of the vertices or faces."""
    found = {name: np.array(values) for name, values in arrays.items()}
    return {name: values for name, values in found.items() if values.shape[:1] == (count,)}


def _colors_apart(arrays: Arrays) -> Arrays:
    """Return arrays of 8-bit colours as red, green and blue, the others as they are."""
    attributes: Arrays = {}
    for name, values in arrays.items():
        if name in _COLORS and values.dtype == np.uint8 and values.shape[1:] in ((3,), (4,)):
            attributes |= dict(zip(_COLORS[name], values.T, strict=False))
        else:
            attributes[name] = values
    return attributes


def _colors_together(attributes: Mapping[str, NDArray[Any]]) -> Arrays:
    """Return 8-bit red, green and blue as "RGB", the others as they are."""
    arrays = dict(attributes)
    for name in ("original_RGB", "RGB"):
        parts = _COLORS[name][:3]
        if all(part in arrays and arrays[part].dtype == np.uint8 for part in parts):
            arrays[name] = np.stack([arrays.pop(part) for part in parts], axis=1)
    return arrays
