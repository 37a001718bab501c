"""A height field's ground as a mesh, for rays, windows and formats that know triangles alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.mesh import Mesh

if TYPE_CHECKING:
    from meshdepict.shapes.height_field import HeightField

__all__ = ["ground_mesh"]


def ground_mesh(field: HeightField) -> Mesh:
    """Return a mesh whose vertices are the samples of a height field, in their order.

    Between four cells that hold heights stand two triangles, parted along the diagonal whose ends
    differ less, between three of them one; all look up.

    Raises
    ------
    MeshdepictError
        Where nowhere three neighbours hold a height.
    """
    index = field.index[1:-1, 1:-1]
    # Round a square of cells: north-west, south-west, south-east, north-east, counter-clockwise
    # where rows go south and columns east; the other way round in a mirrored raster.
    corners = np.stack(
        [index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    if np.linalg.det(field.steps[0]) > 0:
        corners = corners[:, ::-1]
    there = corners >= 0
    squares = corners[there.all(axis=1)]
    heights = field.points[:, 2]
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
    return Mesh(field.points, faces, winding="keep", length_unit=field.length_unit)
