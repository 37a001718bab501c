"""VTI, VTK's XML image data, and the way between `Volume` and ``pyvista.ImageData``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.io.vtp import _vtk_errors

if TYPE_CHECKING:
    from meshdepict.shapes.volume import Volume

__all__ = ["image_contents", "image_of", "read_vti", "write_vti"]


def read_vti(path: Path) -> tuple[NDArray[Any], dict[str, Any], str | None]:
    """Return values, place (the keywords of `Volume`) and unit of a VTI file.

    Raises
    ------
    MeshdepictError
        For a file that is cut off or wrong, and as `image_contents`: without the file's name.
    """
    import pyvista as pv
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader: Any = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    with _vtk_errors() as errors:
        reader.Update()
    if errors:
        raise MeshdepictError(f"is cut off or wrong as VTI: {errors[0]}")
    return image_contents(pv.wrap(reader.GetOutput()))


def write_vti(
    path: Path, values: NDArray[Any], volume: Volume, comments: Sequence[str] = ()
) -> None:
    """Write scalar or RGBA values on a volume's grid, wholly or not at all."""
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    image = image_of(values, volume)
    if comments:
        image.field_data["meshdepict"] = list(comments)
    writer: Any = vtkXMLImageDataWriter()
    with atomic_write(path) as file:
        writer.SetFileName(file.name)
        writer.SetInputData(image)
        writer.SetHeaderTypeToUInt64()
        with _vtk_errors() as errors:
            complete = writer.Write()
        if errors or not complete:
            raise OSError(f"VTK: {errors[0] if errors else 'writing failed'}")


def image_of(values: NDArray[Any], volume: Volume) -> Any:
    """Return ``pyvista.ImageData`` with scalars "values" or colours "RGBA" on a volume's grid."""
    import pyvista as pv

    image = pv.ImageData(
        dimensions=volume.values.shape[::-1],
        spacing=volume.spacing,
        origin=volume.origin,
        direction_matrix=volume.direction,
    )
    if values.ndim == 4:
        image.point_data["RGBA"] = values.reshape(-1, 4)
    else:
        image.point_data["values"] = values.reshape(-1)
        image.field_data["unit"] = [volume.unit]
    return image


def image_contents(image: Any) -> tuple[NDArray[Any], dict[str, Any], str | None]:
    """Return values, place (the keywords of `Volume`) and unit of image data.

    Raises
    ------
    MeshdepictError
        For other data than ``ImageData``, and for none or several arrays without an active one.
    """
    import pyvista as pv

    if not isinstance(image, pv.ImageData):
        raise MeshdepictError(f"holds {type(image).__name__}, not image data of a regular grid")
    values, at_cells = _scalars(image)
    if values.ndim > 1:
        raise MeshdepictError(f"has {values.shape[1]} values in a voxel, not one")
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
    return np.asarray(values).reshape(shape[::-1]), place, unit


def _scalars(image: Any) -> tuple[NDArray[Any], bool]:
    for data, at_cells in ((image.point_data, False), (image.cell_data, True)):
        if data.active_scalars_name:
            return data[data.active_scalars_name], at_cells
        if len(data) == 1:
            return data[data.keys()[0]], at_cells
        if len(data) > 1:
            raise MeshdepictError(
                f"has several arrays ({', '.join(data.keys())}) and none is marked as the scalars"
            )
    raise MeshdepictError("has no values at its voxels")
