"""Meshes and grids of PyVista and trimesh, both ways, with their colours and their other data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.document import Contents, Document
from meshdepict.shapes.foreign import as_polydata, as_trimesh
from meshdepict.surface.polygons import Polygons, strip_triangles
from meshdepict.voxels.grid import Grid
from meshdepict.voxels.length_unit import length_unit

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    from meshdepict.shapes.data_set import Faces, ImageData, PolyData

__all__ = [
    "image_contents",
    "image_of",
    "polydata_contents",
    "polydata_geometry",
    "to_polydata",
    "trimesh_contents",
]

Arrays = dict[str, NDArray[Any]]

_FIELD = "meshdepict"  # the field array that holds the provenance
_CHANNELS = ("red", "green", "blue", "alpha")
# Arrays of 8-bit colours, and the attributes that they stand for.
_COLORS = {
    "RGB": _CHANNELS,
    "RGBA": _CHANNELS,
    "original_RGB": tuple(f"original_{channel}" for channel in _CHANNELS),
}


def polydata_contents(given: object) -> Contents:
    """Return what `Mesh` needs of a ``pyvista.PolyData``, or of the surface of another data set.

    Raises
    ------
    MeshdepictError
        For what has no surface.
    """
    poly = as_polydata(given)
    vertices, polygons, cell = polydata_geometry(poly)
    attributes = {
        "vertex": _colors_apart(_fitting(poly.point_data, len(vertices))),
        "face": {
            name: values[cell] for name, values in _fitting(poly.cell_data, poly.n_cells).items()
        },
    }
    lines = tuple(str(line) for line in poly.field_data.get(_FIELD, ()))
    return Contents(vertices, polygons, attributes, Document(provenance=lines))


def polydata_geometry(poly: Faces) -> tuple[NDArray[Any], Polygons, NDArray[np.int64]]:
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
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64] | Polygons,
    attributes: Mapping[str, NDArray[Any]],
    face_attributes: Mapping[str, NDArray[Any]],
    lines: Iterable[str] = (),
) -> PolyData:
    """Return a ``pyvista.PolyData`` with a mesh's polygons, all of it copied.

    Parameters
    ----------
    vertices : (n, 3) array
    faces : (m, 3) array or Polygons
    attributes : {name: (n, …)}
        Of the vertices; 8-bit red, green and blue become the array "RGB".
    face_attributes : {name: (m, …)}
        They become cell arrays.
    lines : iterable of str
        Provenance, kept in the field data.
    """
    import pyvista as pv

    poly: PolyData = pv.PolyData()
    poly.points = vertices.copy()
    if isinstance(faces, Polygons):
        cells = pv.CellArray.from_arrays(faces.offsets, faces.connectivity, deep=True)
    else:
        cells = pv.CellArray.from_regular_cells(faces, deep=True)
    poly.SetPolys(cells)
    for data, arrays in (
        (poly.point_data, _colors_together(attributes)),
        (poly.cell_data, face_attributes),
    ):
        for name, values in arrays.items():
            data[name] = values.reshape(len(values), -1) if values.ndim > 2 else values.copy()
    if lines := list(lines):
        poly.field_data[_FIELD] = lines
    return poly


def trimesh_contents(given: object) -> Contents:
    """Return what `Mesh` needs of a ``trimesh.Trimesh``, or of a ``Scene``.

    Raises
    ------
    MeshdepictError
        For what has no faces.
    """
    tm = as_trimesh(given)
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


def to_trimesh(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    attributes: Mapping[str, NDArray[Any]],
) -> Any:
    """Return a ``trimesh.Trimesh`` with a mesh's vertices in their order, all of it copied.

    Parameters
    ----------
    vertices : (n, 3) array
    faces : (m, 3) array
    attributes : {name: (n, …)}
        Of the vertices; 8-bit red, green, blue and alpha become its colours.
    """
    import trimesh

    arrays = _colors_together(attributes)
    colors = arrays.pop("RGB", None)
    alpha = arrays.get("alpha")
    if colors is not None and alpha is not None and alpha.dtype == np.uint8:
        colors = np.column_stack((colors, arrays.pop("alpha")))
    return trimesh.Trimesh(
        vertices.copy(),
        faces.copy(),
        vertex_colors=colors,
        vertex_attributes={name: values.copy() for name, values in arrays.items()},
        process=False,
    )


def _cells(cells: vtkCellArray) -> Polygons:
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


# --- volumes ------------------------------------------------------------------------------------


def image_of(values: NDArray[Any], grid: Grid, lines: Iterable[str] = ()) -> ImageData:
    """Return ``pyvista.ImageData`` with scalars "values" or colours "RGBA" on a grid.

    Lines of provenance are kept in the field data, as by `to_polydata`.
    """
    import pyvista as pv

    image: ImageData = pv.ImageData(
        dimensions=grid.counts[::-1],
        spacing=grid.spacing,
        origin=grid.origin,
        direction_matrix=grid.direction,
    )
    if values.ndim == 4:
        image.point_data["RGBA"] = values.reshape(-1, 4)
    else:
        image.point_data["values"] = values.reshape(-1)
        image.field_data["unit"] = [grid.unit]
        if grid.length_unit:
            image.field_data["length_unit"] = [grid.length_unit.replace("µ", "u")]  # VTK's ASCII
    if lines := list(lines):
        image.field_data[_FIELD] = lines
    return image


def image_contents(image: object) -> tuple[NDArray[Any], dict[str, Any], str | None]:
    """Return values, place (the keywords of `Volume`) and unit of image data.

    Raises
    ------
    MeshdepictError
        For other data than ``ImageData``, and for none or several arrays without an active one.
    """
    import pyvista as pv

    if hasattr(image, "GetClassName") and not isinstance(image, pv.DataObject):
        image = pv.wrap(image)  # VTK's own
    if not isinstance(image, pv.ImageData):
        raise MeshdepictError(_no_image(image))
    values, at_cells = _scalars(image)
    if values.ndim > 1:
        raise MeshdepictError(
            f"has {values.shape[1]} values in a voxel, not one: make one of the components, or "
            "their grey values, the active scalars"
        )
    # Voxels are numbered from the extent's low corner, which need not be (0, 0, 0).
    low = np.array(image.extent[::2], np.float64) + (0.5 if at_cells else 0.0)
    shape = [max(n - 1, 1) if at_cells else n for n in image.dimensions]
    spacing, direction = np.array(image.spacing), np.array(image.direction_matrix)
    place = {
        "spacing": spacing,
        "origin": np.array(image.origin) + direction @ (low * spacing),
        "direction": direction,
    }
    unit = str(image.field_data["unit"][0]) if "unit" in image.field_data else None
    if "length_unit" in image.field_data:
        place["length_unit"] = length_unit(str(image.field_data["length_unit"][0]))
    return np.asarray(values).reshape(shape[::-1]), place, unit


def _no_image(data: object) -> str:
    """Return what other data than an image are, and which call makes a volume of them."""
    import pyvista as pv

    name = type(data).__name__
    said = f"holds {name}, not image data of a regular grid"
    if isinstance(data, pv.MultiBlock):
        return f"{said}: give one of its blocks, such as Volume.from_pyvista(blocks[0])"
    if isinstance(data, pv.PolyData):
        return f"{said}: it is a surface, for Mesh.from_pyvista(data) and bake(data)"
    if isinstance(data, pv.DataSet):
        return (
            f"{said}: resample it, pyvista.ImageData(dimensions=(…), spacing=(…), origin=(…))"
            ".sample(data), or bake its surface, data.extract_surface()"
        )
    return said


def _scalars(image: ImageData) -> tuple[NDArray[Any], bool]:
    for data, at_cells in ((image.point_data, False), (image.cell_data, True)):
        if data.active_scalars_name:
            return data[data.active_scalars_name], at_cells
        if len(data) == 1:
            return data[next(iter(data))], at_cells
        if len(data) > 1:
            raise MeshdepictError(
                f"has several arrays ({', '.join(data.keys())}) and none is marked as the scalars"
            )
    raise MeshdepictError("has no values at its voxels")
