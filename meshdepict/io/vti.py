"""VTI, VTK's XML image data."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.vtk_errors import vtk_errors
from meshdepict.shapes.exchange import image_contents, image_of

if TYPE_CHECKING:
    from meshdepict.voxels.grid import Grid

__all__ = ["read_vti", "write_vti"]


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
    with vtk_errors() as errors:
        reader.Update()
    if errors:
        raise MeshdepictError(f"is cut off or wrong as VTI: {errors[0]}")
    return image_contents(pv.wrap(reader.GetOutput()))


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
