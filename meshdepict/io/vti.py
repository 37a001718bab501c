"""VTI, VTK's XML image data."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.limits import check_claim
from meshdepict.files.vtk_errors import vtk_errors
from meshdepict.io.volume_contents import VolumeContents, printable, several_values
from meshdepict.io.vtk_xml import Element, VtkXml, parse_vtk
from meshdepict.shapes.exchange import image_of
from meshdepict.voxels.length_unit import length_unit

if TYPE_CHECKING:
    from meshdepict.voxels.grid import Grid

__all__ = ["read_vti", "write_vti"]

_WRONG = "is cut off or wrong as VTI"


def read_vti(path: Path) -> VolumeContents:
    """Return the active or only scalars of a VTI file; values of cells stand at their centres.

    Raises
    ------
    MeshdepictError
        For a file that is cut off or wrong, other data than an image's, and none or several arrays
        without an active one: one clause whose subject is the file.
    """
    file = parse_vtk(path.read_bytes())
    if file.kind != "ImageData":
        kind = printable(file.kind)[:40] or "VTK data of no kind"
        raise MeshdepictError(f"holds {kind}, not image data of a regular grid")
    image = file.root.first("ImageData")
    whole = _extent(image, "WholeExtent")
    pieces = image.all("Piece")
    if not pieces:
        raise MeshdepictError("holds no piece of an image")
    at_cells, name = _scalars(pieces[0])
    low = whole[:, 0] + (0.5 if at_cells else 0.0)
    counts = np.maximum(whole[:, 1] - whole[:, 0] + (0 if at_cells else 1), 1)
    parts = []
    for piece in pieces:
        extent = _extent(piece, "Extent")
        if (extent[:, 0] < whole[:, 0]).any() or (extent[:, 1] > whole[:, 1]).any():
            raise MeshdepictError(f"{_WRONG}: a piece lies outside of the whole")
        parts.append((extent, _values(file, piece, extent, name, at_cells=at_cells)))
    values = _together(parts, whole, counts, file.size, at_cells=at_cells)
    spacing = _numbers(image, "Spacing", (1, 1, 1))
    direction = _numbers(image, "Direction", (1, 0, 0, 0, 1, 0, 0, 0, 1)).reshape(3, 3)
    with np.errstate(invalid="ignore", over="ignore"):  # `Volume` refuses what is not finite
        origin = _numbers(image, "Origin", (0, 0, 0)) + direction @ (low * spacing)
    place = {"spacing": spacing, "origin": origin, "direction": direction}
    unit = length_unit(_field(file, image, "length_unit"))
    return VolumeContents(values, place, _field(file, image, "unit") == "HU", unit)


def _scalars(piece: Element) -> tuple[bool, str]:
    """Return whether the values are at cells, and the name of their array."""
    for kind, at_cells in (("PointData", False), ("CellData", True)):
        data = piece.first(kind)
        names = [array.attributes.get("Name", "") for array in data.all("DataArray")]
        active = data.attributes.get("Scalars")
        if active in names:
            return at_cells, str(active)
        if len(names) == 1:
            return at_cells, names[0]
        if len(names) > 1:
            listed = ", ".join(map(printable, names[:9]))
            raise MeshdepictError(
                f"has several arrays ({listed}) and none is marked as the scalars"
            )
    raise MeshdepictError("has no values at its voxels")


def _values(
    file: VtkXml, piece: Element, extent: NDArray[np.int64], name: str, *, at_cells: bool
) -> NDArray[Any]:
    """Return the values (z, y, x) of a piece."""
    data = piece.first("CellData" if at_cells else "PointData")
    found = [array for array in data.all("DataArray") if array.attributes.get("Name", "") == name]
    if not found:
        raise MeshdepictError(f"{_WRONG}: a piece lacks the array {printable(name)[:40]!r}")
    parts = found[0].attributes.get("NumberOfComponents", "1")
    if parts != "1":
        if not re.fullmatch(r"\d{1,6}", parts):
            raise MeshdepictError(f"{_WRONG}: an array has {printable(parts)[:20]!r} components")
        raise several_values(int(parts))
    shape = [int(n) for n in np.maximum(extent[:, 1] - extent[:, 0] + (0 if at_cells else 1), 1)]
    values = file.array(found[0], math.prod(shape))
    if len(values) > math.prod(shape):
        raise MeshdepictError(f"{_WRONG}: an array holds more values than its header claims")
    return values.reshape(shape[::-1])


def _together(
    parts: list[tuple[NDArray[np.int64], NDArray[Any]]], whole: NDArray[np.int64],
    counts: NDArray[np.int64], size: int, *, at_cells: bool,
) -> NDArray[Any]:  # fmt: skip
    """Return the values of all pieces, which have to fill the whole."""
    if len(parts) == 1 and (parts[0][0] == whole).all():
        return parts[0][1]
    shape = [int(n) for n in counts[::-1]]
    check_claim(9 * math.prod(shape), size, "voxels")
    values, there = np.zeros(shape, parts[0][1].dtype), np.zeros(shape, bool)
    for extent, part in parts:
        low = extent[::-1, 0] - whole[::-1, 0]
        box = tuple(slice(int(a), int(a) + n) for a, n in zip(low, part.shape, strict=True))
        values[box], there[box] = part, True
    if not there.all():
        raise MeshdepictError(f"{_WRONG}: its pieces don't fill the whole")
    return values


def _extent(element: Element, name: str) -> NDArray[np.int64]:
    """Return an extent as (3, 2) numbers: first and last along x, y and z."""
    words = element.attributes.get(name, "").split()
    if len(words) != 6 or not all(re.fullmatch(r"-?\d{1,10}", word) for word in words):
        raise MeshdepictError(f"{_WRONG}: its {name} is not six whole numbers")
    extent = np.array([int(word) for word in words], np.int64).reshape(3, 2)
    if (extent[:, 1] < extent[:, 0]).any():
        raise MeshdepictError("is empty: it has no voxels")
    return extent


def _numbers(element: Element, name: str, default: tuple[float, ...]) -> NDArray[np.float64]:
    text = element.attributes.get(name)
    try:
        numbers = [float(word) for word in text.split()] if text is not None else default
    except ValueError:
        numbers = ()
    if len(numbers) != len(default):
        raise MeshdepictError(f"{_WRONG}: its {name} is not {len(default)} numbers")
    return np.array(numbers, np.float64)


def _field(file: VtkXml, image: Element, name: str) -> str:
    """Return a text of the field data, "" where there is none."""
    for data in (*image.all("FieldData"), *file.root.all("FieldData")):
        for array in (*data.all("Array"), *data.all("DataArray")):
            if array.attributes.get("Name") == name and array.attributes.get("type") == "String":
                return file.words(array, 1)[0][:1000]
    return ""


def write_vti(path: Path, values: NDArray[Any], grid: Grid, comments: Sequence[str] = ()) -> None:
    """Write scalar or RGBA values on a volume's grid, wholly or not at all."""
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    image = image_of(values, grid, comments)
    writer: Any = vtkXMLImageDataWriter()
    with atomic_write(path) as file:
        writer.SetFileName(file.name)
        writer.SetInputData(image)
        writer.SetHeaderTypeToUInt64()
        with vtk_errors() as errors:
            complete = writer.Write()
        if errors or not complete:
            raise OSError(f"VTK: {errors[0] if errors else 'writing failed'}")
