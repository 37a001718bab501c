"""Terrain from straight above: the cells of its raster are the picture, without any triangles."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.figure import LARGEST, Figure
from meshdepict.drawing.framing import is_fitted
from meshdepict.scene.view import View
from meshdepict.shapes.height_field import HeightField

if TYPE_CHECKING:
    from meshdepict.drawing.painted import Painted
    from meshdepict.scene.shape import Shape

__all__ = ["cell_pixels", "draw_cells", "draw_map", "is_map", "one_cell_a_pixel"]

Bytes = NDArray[np.uint8]

_SMALL = 500  # pixels across, up to which cells become squares of more than one
_FEWEST, _MOST = 3, 8  # samples along a pixel's side
_AT_ONCE = 1 << 22  # samples


def is_map(shape: Shape, view: View) -> TypeGuard[HeightField]:
    """Whether a view shows terrain from straight above, in parallel."""
    above = view.parallel_scale is not None and view.towards_eye[2] > 1 - 1e-12
    return isinstance(shape, HeightField) and above


def cell_pixels(shape: Shape, view: View, figure: Figure) -> int:
    """Return how many pixels the side of a cell has in a picture of the raster itself, or 0.

    That is what a figure without size, scale and scale bar shows of a map with north up: a cell is
    a pixel, and of rasters that are small a square of several. A raster that is turned against
    north is drawn as any object.
    """
    if not is_map(shape, view) or not is_fitted(view, shape) or view.frame[1][1] < 1 - 1e-12:
        return 0
    if figure.pixels or figure.pixels_per_unit or figure.scale_bar or _turns(shape) is None:
        return 0
    longest = max(shape.size)
    return max(1, _SMALL // longest) if longest <= LARGEST else 0


def one_cell_a_pixel(shape: HeightField, view: View, side: int) -> View:
    """Return the view of a picture with so many pixels along a cell's side."""
    rows = shape.size[1]
    return replace(view, parallel_scale=rows * shape.edge_length / 2, height_px=rows * side)


def draw_cells(baked: Painted, side: int) -> Bytes:
    """Return the raster in its colours, north up: (height, width, 4) colour and coverage."""
    shape = baked.shape
    assert isinstance(shape, HeightField)
    raster, turns = _painted(baked), _turns(shape)
    assert turns is not None  # as `cell_pixels` sees to
    lying, east, north = turns
    if lying:
        raster = raster.swapaxes(0, 1)
    raster = raster[::north, ::east]
    return np.repeat(np.repeat(raster, side, axis=0), side, axis=1)


def draw_map(baked: Painted, view: View, size: tuple[int, int]) -> Bytes:
    """Draw the cells that a map shows, sharp, and averaged where several fall on a pixel.

    Parameters
    ----------
    baked : Painted
        Of a height field.
    view : View
        For which `is_map` holds.
    size : (int, int)
        Width and height in pixels.

    Returns
    -------
    (height, width, 4) array of uint8
        Colour times coverage, and coverage.
    """
    shape = baked.shape
    assert isinstance(shape, HeightField)
    assert view.parallel_scale is not None
    (width, height), pixel = size, 2 * view.parallel_scale / size[1]
    finer = min(max(_FEWEST, math.ceil(pixel / shape.edge_length)), _MOST)
    raster = _painted(baked)
    high, wide = raster.shape[:2]
    right, up, _ = view.frame
    across = (np.arange(width * finer) + 0.5) * (pixel / finer) - pixel * width / 2
    picture = np.empty((height, width, 4), np.uint8)
    lines = max(1, _AT_ONCE // (width * finer * finer))
    for top in range(0, height, lines):
        count = min(lines, height - top)
        down = pixel * height / 2 - (np.arange(count * finer) + 0.5 + top * finer) * (pixel / finer)
        east = view.focus[0] + right[0] * across + up[0] * down[:, None]
        north = view.focus[1] + right[1] * across + up[1] * down[:, None]
        rows, columns = (np.floor(cell) for cell in shape.cells_at(east, north))
        there = (rows >= 0) & (rows < high) & (columns >= 0) & (columns < wide)
        cells = np.zeros((*there.shape, 4), np.uint8)
        cells[there] = raster[rows[there].astype(np.intp), columns[there].astype(np.intp)]
        sums = cells.reshape(count, finer, width, finer, 4).sum(axis=(1, 3), dtype=np.uint32)
        picture[top : top + count] = (sums + finer**2 // 2) // finer**2
    return picture


def _painted(baked: Painted) -> Bytes:
    """Return colour and coverage of every cell of the raster."""
    shape = baked.shape
    assert isinstance(shape, HeightField)
    covered = np.column_stack((baked.colors, np.full(len(baked.colors), 255, np.uint8)))
    raster: NDArray[Any] = shape.image(covered)
    return raster


def _turns(shape: HeightField) -> tuple[bool, int, int] | None:
    """Return whether columns run north, and the steps along them that go east, and south.

    None where they run neither east nor north.
    """
    step = shape.steps[len(shape.steps) // 2]
    step = np.where(np.abs(step) < 1e-9 * np.abs(step).max(), 0, step)
    if step[0, 1] == 0 == step[1, 0]:
        lying, east, north = False, step[0, 0], step[1, 1]
    elif step[0, 0] == 0 == step[1, 1]:
        lying, east, north = True, step[0, 1], step[1, 0]
    else:
        return None
    return lying, 1 if east > 0 else -1, 1 if north < 0 else -1
