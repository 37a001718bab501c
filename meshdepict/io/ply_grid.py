"""Range grids: PLY files of a scanner, whose points lie in rows and columns instead of on faces."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.ply_header import Header
from meshdepict.io.ply_rows import Ragged
from meshdepict.surface.polygons import whole_numbers

__all__ = ["grid_of", "grid_triangles"]

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

_SIZE = re.compile(rb"\s*obj_info\s+num_(cols|rows)\s+(\d{1,9})\s*")

# Where a scanner's view jumps from one thing to another behind it, neighbours in the grid are none
# on the surface. A surface that is seen at 84° has sides ten times as long as one seen straight.
_JUMP = 10.0


def grid_of(header: Header, lists: Ragged) -> Ints:
    """Return the vertex at each of (rows, columns) places of a grid, −1 where none was seen.

    Raises
    ------
    MeshdepictError
        Where the header doesn't say how many columns and rows there are, or not as many as hold
        the element.
    """
    sizes = {m[1]: int(m[2]) for m in map(_SIZE.fullmatch, header.lines) if m}
    columns, rows = (sizes.get(name, 0) for name in (b"cols", b"rows"))
    count = len(lists.offsets) - 1
    length = np.diff(lists.offsets)
    if columns * rows != count or (length > 1).any():
        raise MeshdepictError(
            "holds a range grid, but its header doesn't say (as obj_info num_cols and num_rows) "
            f"into how many columns and rows its {count:,} points fall; make a mesh of it first"
        )
    index = np.full(count, -1, np.int64)
    index[length == 1] = whole_numbers(lists.values)
    return index.reshape(rows, columns)


def grid_triangles(vertices: Floats, grid: Ints) -> Ints:
    """Return the (m, 3) triangles between neighbours of a grid, seen from +z as scanners have it.

    Four neighbours make two triangles along their shorter diagonal, three make one.
    """
    index = np.where((grid >= 0) & (grid < len(vertices)), grid, -1)
    a, b, c, d = (
        index[row : len(index) - 1 + row, column : index.shape[1] - 1 + column].reshape(-1)
        for row, column in ((0, 0), (0, 1), (1, 1), (1, 0))
    )
    first = (_length(vertices, a, c) <= _length(vertices, b, d)) & (a >= 0) & (c >= 0)
    first |= (b < 0) | (d < 0)
    halves = (
        np.where(first, (a, b, c), (a, b, d)),
        np.where(first, (a, c, d), (b, c, d)),
    )
    triangles = np.stack(halves, axis=0).transpose(2, 0, 1).reshape(-1, 3)
    triangles = triangles[(triangles >= 0).all(axis=1)]
    if len(triangles) == 0:
        return triangles
    corners = vertices[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    near = longest <= _JUMP * np.median(longest)
    triangles, corners = triangles[near], corners[near]
    towards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2].sum()
    return triangles[:, ::-1] if towards < 0 else triangles


def _length(vertices: Floats, i: Ints, j: Ints) -> Floats:
    length: Floats = np.linalg.norm(vertices[i] - vertices[j], axis=1)
    return length
