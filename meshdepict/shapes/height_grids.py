"""Grids of PyVista that are terrain: one layer of points, evenly spaced in x and y.

Others with one layer are sheets: meshes with the grid's own cells.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.heights.cells import Transform, checked_transform
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.sheet import Sheet, checked_heights, height_sheet

__all__ = ["even_transform", "image_ground", "is_layer", "structured_ground"]

Floats = NDArray[np.float64]

_EVEN = 1e-3  # of a step, that points may lie beside the even ones; and what their type rounds to


def is_layer(data: Any) -> bool:
    """Whether this is an image or a structured grid of PyVista with one layer of points."""
    grid = hasattr(data, "direction_matrix") or (hasattr(data, "IsA") and _is_structured(data))
    return grid and sorted(data.dimensions)[:2] != [1, 1] and 1 in data.dimensions


def _is_structured(data: Any) -> bool:
    return bool(data.IsA("vtkStructuredGrid")) and hasattr(data, "dimensions")


def image_ground(image: Any, where: str, name: str) -> tuple[Mesh | HeightField, NDArray[np.bool_]]:
    """Return the terrain that an image's heights are, or the sheet, and which of them it has.

    Terrain stands on x and y, its heights along z; so do images that aren't turned out of them.

    Parameters
    ----------
    image : pyvista.ImageData
        With one layer of points.
    where, name : str
        Of the array, as `sheet.scalar_array` returns them.

    Raises
    ------
    MeshdepictError
        For heights that aren't one number each, and where no cell has four of them.
    """
    heights = checked_heights(image, where, name)
    flat = image.dimensions.index(1)
    axes = np.asarray(image.direction_matrix)
    if flat != 2 or not np.allclose(axes[:, 2], (0, 0, 1), rtol=0, atol=1e-12):
        return height_sheet(image, where, name)
    columns, rows = (n - (where == "cell") for n in image.dimensions[:2])
    grid = image if where == "point" else image.cell_centers()
    points = np.asarray(grid.points, np.float64).reshape(rows, columns, 3)
    z = points[..., 2] + heights.reshape(rows, columns)
    found = _terrain(points[..., 0], points[..., 1], z, repr(name))
    return height_sheet(image, where, name) if found is None else (found, found.valid.ravel())


def structured_ground(grid: Any) -> tuple[Mesh | HeightField, NDArray[np.bool_]]:
    """Return the terrain that a structured grid's one layer of points is, or the sheet.

    Parameters
    ----------
    grid : pyvista.StructuredGrid

    Raises
    ------
    MeshdepictError
        Where no cell has four points that are finite.
    """
    columns, rows = (n for n in grid.dimensions if n != 1)
    points = np.asarray(grid.points, np.float64).reshape(rows, columns, 3)
    x, y, z = np.moveaxis(points, 2, 0)
    found = _terrain(x, y, z, "of the StructuredGrid", rounding=_rounding(np.asarray(grid.points)))
    if found is not None:
        return found, found.valid.ravel()
    there = np.isfinite(points).all(axis=2)
    number = np.where(there, np.cumsum(there).reshape(there.shape) - 1, -1)
    cells = _squares(number)
    _refuse_lines(len(cells), "of the StructuredGrid")
    return Sheet(Mesh(points[there], cells, winding="keep"), there.ravel())


def even_transform(x: Floats, y: Floats, *, rounding: float = 0.0) -> Transform | None:
    """Return the transform of cells whose centres are at x and y (rows, columns); None if uneven.

    Parameters
    ----------
    x, y : (rows, columns) arrays
        Of two rows and two columns at least.
    rounding : float
        How far numbers may be off, because of their type.
    """
    rows, columns = x.shape
    if min(rows, columns) < 2 or not (np.isfinite(x).all() and np.isfinite(y).all()):
        return None
    a, b = (x[0, -1] - x[0, 0]) / (columns - 1), (x[-1, 0] - x[0, 0]) / (rows - 1)
    d, e = (y[0, -1] - y[0, 0]) / (columns - 1), (y[-1, 0] - y[0, 0]) / (rows - 1)
    row, column = np.arange(rows)[:, None], np.arange(columns)
    step = min(np.hypot(a, d), np.hypot(b, e))
    off = max(
        np.abs(x - (x[0, 0] + a * column + b * row)).max(),
        np.abs(y - (y[0, 0] + d * column + e * row)).max(),
    )
    if off > _EVEN * step + rounding or off > step / 10:
        return None
    try:
        return checked_transform((a, b, x[0, 0] - (a + b) / 2, d, e, y[0, 0] - (d + e) / 2))
    except MeshdepictError:  # sheared, or all in one place
        return None


def _terrain(
    x: Floats, y: Floats, z: Floats, what: str, *, rounding: float = 0.0
) -> HeightField | None:
    transform = even_transform(x, y, rounding=rounding)
    if transform is None:
        return None
    there = np.isfinite(z)
    _refuse_lines(len(_squares(np.where(there, 0, -1))), what)
    return HeightField(np.where(there, z, 0.0), transform=transform, valid=there)


def _squares(number: NDArray[Any]) -> NDArray[Any]:
    """Return the cells (m, 4) between four points that have a number."""
    corners = (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    cells = np.stack(corners, axis=-1).reshape(-1, 4)
    return cells[(cells >= 0).all(axis=1)]


def _refuse_lines(cells: int, what: str) -> None:
    if not cells:
        raise MeshdepictError(
            f"the heights {what} are no surface: nowhere do four neighbours all have one"
        )


def _rounding(points: NDArray[Any]) -> float:
    """Return how far coordinates of a type may be off the numbers that were meant."""
    finite = points[np.isfinite(points)] if points.dtype.kind == "f" else points
    if points.dtype.kind != "f" or not finite.size:
        return 0.0
    return 2 * float(np.finfo(points.dtype).eps) * float(np.abs(finite).max())
