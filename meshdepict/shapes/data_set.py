"""What this program asks of PyVista's data sets, for the type checker."""

from __future__ import annotations

from collections.abc import MutableMapping
from typing import TYPE_CHECKING, Any, Protocol

from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkCellData, vtkPointData

__all__ = ["DataSet", "Faces", "ImageData", "PolyData"]


class Arrays(MutableMapping[str, Any]):
    """Arrays by name; one of them may be the scalars that are shown."""

    active_scalars_name: str | None

    def set_array(self, data: ArrayLike, name: str) -> None:
        """Take an array as it is."""


class DataSet(Protocol):
    """Any ``pyvista.DataSet``."""

    points: NDArray[Any]

    @property
    def point_data(self) -> Arrays:
        """An array has a row for each point."""

    @property
    def cell_data(self) -> Arrays:
        """An array has a row for each cell."""

    @property
    def field_data(self) -> MutableMapping[str, Any]:
        """Arrays about the whole."""

    @property
    def n_cells(self) -> int:
        """Number of cells."""

    def set_active_scalars(self, name: str, preference: str = "cell") -> object:
        """Show an array."""

    def GetPointData(self) -> vtkPointData:  # noqa: N802
        """As VTK has it."""

    def GetCellData(self) -> vtkCellData:  # noqa: N802
        """As VTK has it."""

    def Modified(self) -> None:  # noqa: N802
        """Say that something changed."""


class Faces(Protocol):
    """A ``vtkPolyData``, PyVista's or VTK's own."""

    def GetPoints(self) -> vtkPoints:  # noqa: N802
        """None where there are none."""

    def GetPolys(self) -> vtkCellArray:  # noqa: N802
        """Polygons."""

    def GetStrips(self) -> vtkCellArray:  # noqa: N802
        """Triangle strips."""

    def GetNumberOfVerts(self) -> int:  # noqa: N802
        """Of cells that are points."""

    def GetNumberOfLines(self) -> int:  # noqa: N802
        """Of cells that are lines."""


class PolyData(DataSet, Faces, Protocol):
    """A ``pyvista.PolyData``."""

    def SetPolys(self, cells: vtkCellArray) -> None:  # noqa: N802
        """Have other polygons."""


class ImageData(DataSet, Protocol):
    """A ``pyvista.ImageData``."""

    @property
    def dimensions(self) -> tuple[int, int, int]:
        """Points along x, y and z."""

    @property
    def extent(self) -> tuple[int, ...]:
        """First and last index along x, y and z."""

    @property
    def spacing(self) -> tuple[float, float, float]:
        """From point to point."""

    @property
    def origin(self) -> tuple[float, float, float]:
        """Where the point (0, 0, 0) is."""

    @property
    def direction_matrix(self) -> NDArray[Any]:
        """(3, 3), a column for each axis."""

    @property
    def active_scalars_name(self) -> str | None:
        """Of the array that is shown."""

    @property
    def array_names(self) -> list[str]:
        """Of all arrays."""

    def copy(self, deep: bool = True) -> ImageData:  # noqa: FBT001, FBT002
        """Return another one, with arrays of its own or the same."""

    def cell_centers(self) -> PolyData:
        """Return the middles of cells as points."""
