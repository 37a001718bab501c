"""The ground as a mesh, for rays, windows and formats that know triangles alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.mesh import Mesh

__all__ = ["ground_mesh"]


def ground_mesh(
    points: NDArray[np.float64], index: NDArray[np.int32], *, mirrored: bool, length_unit: str
) -> Mesh:
    """Return a mesh of the cells of a raster that hold a height, a vertex each.

    Between four cells that hold heights stand two triangles, parted along the diagonal whose ends
    differ less, between three of them one; all look up.

    Parameters
    ----------
    points : (n, 3) array
        Of the cells.
    index : (rows, columns) array of int
        The point at each cell, negative where there is none.
    mirrored : bool
        Whether rows go north while columns go east.
    length_unit : str

    Raises
    ------
    MeshdepictError
        Where nowhere three neighbours hold a height.
    """
    # Round a square of cells: north-west, south-west, south-east, north-east.
    corners = np.stack(
        [index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    if mirrored:
        corners = corners[:, ::-1]
    there = corners >= 0
    squares = corners[there.all(axis=1)]
    heights = points[:, 2]
    other = np.abs(heights[squares[:, 0]] - heights[squares[:, 2]]) > np.abs(
        heights[squares[:, 1]] - heights[squares[:, 3]]
    )
    squares[other] = np.roll(squares[other], 1, axis=1)
    three = corners[there.sum(axis=1) == 3]
    parts: list[NDArray[np.int32]] = [
        squares[:, [0, 1, 2]], squares[:, [0, 2, 3]], three[three >= 0].reshape(-1, 3)
    ]  # fmt: skip
    faces = np.concatenate(parts)
    if not len(faces):
        raise MeshdepictError(
            "the heights are no surface: nowhere do three neighbouring cells all hold one"
        )
    return Mesh(points, faces, winding="keep", length_unit=length_unit)
