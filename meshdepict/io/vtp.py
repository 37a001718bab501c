"""VTP: VTK's XML polygon data, with all its other arrays, lines and points kept."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.vtk_errors import vtk_errors
from meshdepict.io.ply_properties import exact_float
from meshdepict.io.vtk_polydata import polydata
from meshdepict.io.vtk_xml import parse_vtk
from meshdepict.shapes.document import COLOR, Contents, Document, Saving, recolored, same_vertices
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["VtpDocument", "decode", "encode", "provenance"]

_FIELD = "meshdepict"  # the field array that holds the provenance
# Arrays of three 8-bit numbers stand for three attributes.
_TRIPLES = {"RGB": COLOR, "original_RGB": tuple(f"original_{name}" for name in COLOR)}

_VTK_TYPES = {"?": np.uint8, "e": np.float32, "g": np.float64}  # what VTK has no type for


@dataclass(frozen=True, kw_only=True)
class VtpDocument(Document):
    """A whole VTP file."""

    data: bytes

    @property
    def has_strips(self) -> bool:
        """Whether triangle strips are among the file's faces."""
        return bool(_polydata(self.data).GetNumberOfStrips())

    def describes(self, vertices: NDArray[np.float64] | None, polygons: Polygons) -> bool:
        """Whether these are the file's vertices (if given) and polygons, not changed ones."""
        own_vertices, own_polygons, _ = _geometry(_polydata(self.data))
        same = same_vertices(vertices, own_vertices)
        return same and all(map(np.array_equal, own_polygons, polygons))


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return the lines that this program wrote into the field data."""
    data = file.read()
    return _written(_polydata(data)) if f'"{_FIELD}"'.encode() in data else ()


def _written(poly: Any) -> tuple[str, ...]:
    array = poly.GetFieldData().GetAbstractArray(_FIELD)
    if array is None or not array.IsA("vtkStringArray"):
        return ()
    return tuple(array.GetValue(at) for at in range(array.GetNumberOfValues()))


# --- reading ----------------------------------------------------------------------------------


def decode(data: bytes, path: Path) -> Contents:
    """Read polygons and triangle strips with their point and cell arrays.

    Raises
    ------
    MeshdepictError
        For a file that is cut off or wrong, and for VTK data of another kind.
    """
    poly = _polydata(data)
    vertices, polygons, cell = _geometry(poly)
    face = {name: values[cell] for name, values in _arrays(poly.GetCellData()).items()}
    attributes = {"vertex": _vertex_attributes(poly), "face": face}
    document = VtpDocument(provenance=_written(poly), data=data)
    return Contents(vertices, polygons, attributes, document)


def _polydata(data: bytes) -> Any:
    data = data.rstrip(b"\0 \t\r\n")
    if not re.search(rb"</VTKFile\s*>\Z", data[-100:]):
        raise MeshdepictError("is cut off: it doesn't end with </VTKFile>")
    file = parse_vtk(data)
    if file.kind != "PolyData":
        raise MeshdepictError(
            f"holds other VTK data than PolyData ({file.kind[:40]!r}); extract its surface first"
        )
    return polydata(file)


def _geometry(poly: Any) -> tuple[NDArray[Any], Polygons, NDArray[np.int64]]:
    """Return the points in double precision, the polygons, and the cell of each."""
    from meshdepict.shapes.exchange import polydata_geometry

    vertices, polygons, cell = polydata_geometry(poly)
    return vertices.astype(np.float64), polygons, cell


def _arrays(data: Any) -> dict[str, NDArray[Any]]:
    """Return the named arrays of numbers."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    arrays = [data.GetArray(at) for at in range(data.GetNumberOfArrays())]  # None: of text
    return {
        array.GetName(): vtk_to_numpy(array)
        for array in arrays
        if array is not None and array.GetName() and not array.IsA("vtkBitArray")
    }


def _color_name(poly: Any) -> str | None:
    """Return the name of the point array that holds colours: RGB, RGBA, or the active one."""
    arrays = _arrays(poly.GetPointData())
    active = poly.GetPointData().GetScalars()
    for name in ("RGB", "RGBA", active and active.GetName()):
        values = arrays.get(name or "")
        if values is not None and values.dtype == np.uint8 and values.shape[1:] in ((3,), (4,)):
            return name
    return None


def _vertex_attributes(poly: Any) -> dict[str, NDArray[Any]]:
    """Return the point arrays, colours as red, green and blue."""
    attributes: dict[str, NDArray[Any]] = {}
    color = _color_name(poly)
    for name, values in _arrays(poly.GetPointData()).items():
        triple = _TRIPLES["RGB"] if name == color else _TRIPLES.get(name)
        if triple and values.dtype == np.uint8 and values.ndim == 2:
            attributes |= dict(zip((*triple, "alpha"), values.T, strict=False))
        else:
            attributes[name] = values
    return attributes


# --- writing ----------------------------------------------------------------------------------


def encode(file: BinaryIO, mesh: Mesh, saving: Saving) -> None:
    """Write a mesh: the data that it was read from with new colours, or new data."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    polygons = mesh.polygons or as_polygons(mesh.faces)
    document = mesh.document
    if isinstance(document, VtpDocument) and document.describes(mesh.vertices, polygons):
        poly = _polydata(document.data)
    else:
        poly = _fresh(mesh, polygons)
    if saving.colors is not None:
        ours = isinstance(document, Document) and document.is_recolored
        for name in {*_TRIPLES, _color_name(poly)} - {None}:
            poly.GetPointData().RemoveArray(name)
        attributes = recolored(mesh.attributes["vertex"], saving, ours=ours)
    else:
        had = _vertex_attributes(poly)
        attributes = {k: v for k, v in mesh.attributes["vertex"].items() if k not in had}
    _add_arrays(poly.GetPointData(), _with_triples(attributes))
    if "RGB" in _arrays(poly.GetPointData()):
        poly.GetPointData().SetActiveScalars("RGB")
    if saving.comments or saving.colors is not None:
        _write_provenance(poly, saving.comments)
    writer: Any = vtkXMLPolyDataWriter()
    writer.SetInputData(poly)
    writer.SetWriteToOutputString(True)  # noqa: FBT003
    writer.SetDataModeToBinary()
    with vtk_errors() as errors:
        writer.Write()
    if errors:
        raise MeshdepictError(f"VTK could not write the mesh: {errors[0]}")
    text = writer.GetOutputString()
    file.write(text if isinstance(text, bytes) else text.encode())


def _fresh(mesh: Mesh, polygons: Polygons) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    points = vtkPoints()
    kind = exact_float(mesh.vertices)
    points.SetData(numpy_to_vtk(mesh.vertices.astype(kind), deep=True))
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(polygons.offsets, deep=True),
        numpy_to_vtkIdTypeArray(polygons.connectivity, deep=True),
    )
    poly = vtkPolyData()
    poly.SetPoints(points)
    poly.SetPolys(cells)
    _add_arrays(poly.GetCellData(), mesh.attributes["face"])
    return poly


def _with_triples(attributes: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return attributes with 8-bit red, green and blue in one array."""
    arrays = dict(attributes)
    for name, triple in _TRIPLES.items():
        if all(part in arrays and arrays[part].dtype == np.uint8 for part in triple):
            arrays[name] = np.stack([arrays.pop(part) for part in triple], axis=1)
    return arrays


def _add_arrays(data: Any, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Add arrays that aren't there yet."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for name, values in arrays.items():
        if data.HasArray(name):
            continue
        if values.dtype.kind not in "biuf":
            warnings.warn(
                f"the attribute {name!r} is left out: VTP holds numbers, not {values.dtype}",
                MeshdepictWarning,
                stacklevel=2,
            )
            continue
        table = values.reshape(len(values), -1) if values.ndim > 2 else values
        held = np.ascontiguousarray(table, _VTK_TYPES.get(table.dtype.char))
        array = numpy_to_vtk(held, deep=True)
        array.SetName(name)
        data.AddArray(array)


def _write_provenance(poly: Any, lines: tuple[str, ...]) -> None:
    from vtkmodules.vtkCommonCore import vtkStringArray

    poly.GetFieldData().RemoveArray(_FIELD)
    if lines:
        array = vtkStringArray()
        array.SetName(_FIELD)
        for line in lines:
            array.InsertNextValue(line)
        poly.GetFieldData().AddArray(array)
