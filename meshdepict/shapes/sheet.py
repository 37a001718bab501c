"""A grid of heights as a sheet of four-cornered cells, left out where a height is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.mesh import Mesh

if TYPE_CHECKING:
    from meshdepict.shapes.data_set import ImageData

__all__ = ["SCALARS", "Sheet", "checked_heights", "height_sheet", "scalar_array"]

SCALARS = "depict_scalars"  # the field that names what was shaded, of an image that shows colours


class Sheet(NamedTuple):
    """A mesh, and which samples of the grid are its vertices, (samples,) bool."""

    mesh: Mesh
    there: NDArray[np.bool_]


def scalar_array(image: ImageData, name: str | None = None) -> tuple[str, str]:
    """Return where the scalars of a ``pyvista.ImageData`` are: "point" or "cell", and the name.

    Parameters
    ----------
    image : pyvista.ImageData
    name : str, optional
        Of the array; unless given, what a former bake shaded, else the active scalars, else the
        only array.

    Raises
    ------
    MeshdepictError
        Where there are none, or none of that name.
    """
    if name is None and SCALARS in image.field_data:
        name = str(image.field_data[SCALARS][0])
    if name is None:
        name = image.active_scalars_name or (
            image.array_names[0] if len(image.array_names) == 1 else None
        )
    for where, data in (("point", image.point_data), ("cell", image.cell_data)):
        if name in data:
            return where, str(name)
    names = ", ".join([*image.point_data, *image.cell_data]) or "none"
    wanted = "no active scalars" if name is None else f"no array {name!r}"
    raise MeshdepictError(
        f"the image has {wanted} to shade: name one with scalars=… (it has {names})"
    )


def checked_heights(image: ImageData, where: str, name: str) -> NDArray[np.float64]:
    """Return an array of a ``pyvista.ImageData`` as heights.

    Raises
    ------
    MeshdepictError
        For heights that aren't one number each.
    """
    data = image.point_data if where == "point" else image.cell_data
    heights = np.asarray(data[name])
    if heights.ndim != 1 or heights.dtype.kind not in "biuf":
        raise MeshdepictError(f"{name!r} has not one number for each {where}: it holds no heights")
    return heights.astype(np.float64)


def height_sheet(image: ImageData, where: str, name: str) -> Sheet:
    """Return the sheet of a ``pyvista.ImageData`` with one layer of points.

    Parameters
    ----------
    image : pyvista.ImageData
    where, name : str
        As `scalar_array` returns them; heights of cells stand at the cells' centres.

    Raises
    ------
    MeshdepictError
        For heights that aren't one number each, and where no cell has four of them.
    """
    heights = checked_heights(image, where, name)
    grid = image if where == "point" else image.cell_centers()
    flat = image.dimensions.index(1)
    directions = np.asarray(image.direction_matrix)
    there = np.isfinite(heights)
    points = np.asarray(grid.points, dtype=np.float64)[there]
    points += heights[there, None] * directions[:, flat]
    shape = [n - (where == "cell") for axis, n in enumerate(image.dimensions) if axis != flat]
    number = np.where(there, np.cumsum(there) - 1, -1).reshape(shape[::-1])
    corners = (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    cells = np.stack(corners, axis=-1).reshape(-1, 4)
    cells = cells[(cells >= 0).all(axis=1)]
    if not len(cells):
        raise MeshdepictError(
            f"the heights {name!r} are no surface: nowhere do four neighbours all have one"
        )
    # Towards larger heights; with y for heights, x and z turn the other way round.
    if (flat == 1) != (np.linalg.det(directions) < 0):
        cells = cells[:, ::-1]
    return Sheet(Mesh(points, cells, winding="keep"), there)
