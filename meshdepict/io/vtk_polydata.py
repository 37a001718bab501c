"""VTK's polygon data, made of arrays that were decoded and looked at here, not by VTK."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.vtk_xml import WRONG, Element, VtkXml, natural

__all__ = ["polydata"]

_CELLS = ("Verts", "Lines", "Polys", "Strips")  # in the order of their data
_ACTIVE = ("Scalars", "Vectors", "Normals", "TCoords", "Tensors", "GlobalIds", "PedigreeIds")


def polydata(file: VtkXml) -> Any:
    """Return a file's ``vtkPolyData``, its pieces together.

    Raises
    ------
    MeshdepictError
        For arrays that hold less than is claimed, and offsets that lead out of them: one clause
        whose subject is the file.
    """
    whole = file.root.first(file.kind)
    pieces = [_piece(file, piece) for piece in whole.all("Piece")]
    found = pieces[0] if len(pieces) == 1 else _joined(pieces)
    for data in (*file.root.all("FieldData"), *whole.all("FieldData")):
        for element in data.arrays():
            array = _array(file, element, natural(element, "NumberOfTuples"))
            found.GetFieldData().AddArray(array)
    return found


def _joined(pieces: list[Any]) -> Any:
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData

    if not pieces:
        return vtkPolyData()
    joining: Any = vtkAppendPolyData()
    for piece in pieces:
        joining.AddInputData(piece)
    joining.Update()
    return joining.GetOutput()


def _piece(file: VtkXml, piece: Element) -> Any:
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkPolyData

    poly = vtkPolyData()
    count = natural(piece, "NumberOfPoints")
    if count:
        arrays = piece.first("Points").arrays()
        if not arrays:
            raise MeshdepictError(f"{WRONG}: it has no array of points")
        array = _array(file, arrays[0], count)
        if arrays[0].components() != 3:
            raise MeshdepictError(f"{WRONG}: its points have other than three coordinates")
        points = vtkPoints()
        points.SetData(array)
        poly.SetPoints(points)
    cells = 0
    for role in _CELLS:
        number = natural(piece, f"NumberOf{role}")
        cells += number
        if number:
            getattr(poly, f"Set{role}")(_cells(file, piece.first(role), number))
    for name, target, length in (
        ("PointData", poly.GetPointData(), count), ("CellData", poly.GetCellData(), cells),
    ):  # fmt: skip
        data = piece.first(name)
        for element in data.arrays():
            target.AddArray(_array(file, element, length))
        for word in _ACTIVE:
            if target.HasArray(active := data.attributes.get(word, "")):
                target.SetActiveAttribute(active, getattr(vtkDataSetAttributes, word.upper()))
    return poly


def _cells(file: VtkXml, element: Element, number: int) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    named = {array.attributes.get("Name", ""): array for array in element.arrays()}
    if not {"connectivity", "offsets"} <= set(named):
        raise MeshdepictError(f"{WRONG}: its {element.name} lack connectivity or offsets")
    offsets, connectivity = (
        _indices(file, named[name], least)
        for name, least in (("offsets", number), ("connectivity", 0))
    )
    offsets = np.concatenate(([0], offsets[:number]))
    if (np.diff(offsets) < 0).any() or offsets[-1] > len(connectivity):
        raise MeshdepictError(
            f"is wrong as VTK's XML: the offsets of its {element.name} don't fit their connectivity"
        )
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_to_vtkIdTypeArray(connectivity[: offsets[-1]].copy(), deep=True),
    )
    return cells


def _indices(file: VtkXml, element: Element, least: int) -> NDArray[np.int64]:
    values = file.array(element, least)
    if values.dtype.kind not in "iu":
        raise MeshdepictError(
            f"{WRONG}: its array {element.called()!r} holds floats where whole numbers are due"
        )
    return values.astype(np.int64)


def _array(file: VtkXml, element: Element, tuples: int) -> Any:
    """Return an array of VTK's type, with its name and those of its components."""
    parts = element.components()
    kind = element.attributes.get("type", "")
    if kind in ("String", "Bit"):
        array = (_bits if kind == "Bit" else _texts)(file, element, tuples, parts)
    else:
        array = _numbers(file, element, tuples, parts)
    if "Name" in element.attributes:
        array.SetName(element.attributes["Name"])
    for part in range(parts):
        if name := element.attributes.get(f"ComponentName{part}"):
            array.SetComponentName(part, name)
    return array


def _numbers(file: VtkXml, element: Element, tuples: int, parts: int) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkIdTypeArray

    values = file.array(element, tuples * parts)[: tuples * parts]
    table = np.ascontiguousarray(values).reshape(tuples, parts)
    kind = None
    if element.attributes.get("IdType") == "1" and table.dtype == np.int64:
        kind = vtkIdTypeArray().GetDataType()
    return numpy_to_vtk(table, deep=True, array_type=kind)


def _texts(file: VtkXml, element: Element, tuples: int, parts: int) -> Any:
    from vtkmodules.vtkCommonCore import vtkStringArray

    array = vtkStringArray()
    array.SetNumberOfComponents(parts)
    for word in file.words(element, tuples * parts):
        array.InsertNextValue(word)
    return array


def _bits(file: VtkXml, element: Element, tuples: int, parts: int) -> Any:
    from vtkmodules.vtkCommonCore import vtkBitArray

    array = vtkBitArray()
    array.SetNumberOfComponents(parts)
    for bit in file.array(element, tuples * parts)[: tuples * parts].tolist():
        array.InsertNextValue(bit)
    return array
