"""How a raster is cut in windows that give the whole's numbers, and fit into memory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import as_text
from meshdepict.heights.smoothing import alignment, halo
from meshdepict.scales.reads import Reads
from meshdepict.shapes.raster_place import RasterPlace

__all__ = ["Cut", "Window", "cut_for"]

_TILE = 512  # cells: that many are stored together
_USUAL = 1 << 30  # bytes that a window takes at most, unless more is needed


class Window(NamedTuple):
    """Cells that are wanted, and those that are looked at for them."""

    rows: slice
    columns: slice
    outer_rows: slice
    outer_columns: slice

    @property
    def inner(self) -> tuple[slice, slice]:
        """Where the wanted ones are among those looked at."""
        top, left = self.outer_rows.start, self.outer_columns.start
        return (
            slice(self.rows.start - top, self.rows.stop - top),
            slice(self.columns.start - left, self.columns.stop - left),
        )


class Cut(NamedTuple):
    """Windows of a raster.

    Attributes
    ----------
    rows, columns : int
        Of the raster.
    side : int
        Of a window, in cells.
    down, across : int
        How far around a window cells are looked at.
    align : int
        At whose multiples all begins.
    """

    rows: int
    columns: int
    side: int
    down: int
    across: int
    align: int

    def __len__(self) -> int:
        """Return the number of windows."""
        return -(-self.rows // self.side) * -(-self.columns // self.side)

    def windows(self) -> Iterator[Window]:
        """Yield all windows, row by row."""
        for top in range(0, self.rows, self.side):
            for left in range(0, self.columns, self.side):
                rows = slice(top, min(top + self.side, self.rows))
                columns = slice(left, min(left + self.side, self.columns))
                yield self.around(rows, columns)

    def around(self, rows: slice, columns: slice) -> Window:
        """Return a window with what is looked at for it."""
        return Window(
            rows, columns,
            _wider(rows, self.down, self.align, self.rows),
            _wider(columns, self.across, self.align, self.columns),
        )  # fmt: skip


def cut_for(
    place: RasterPlace,
    widths: NDArray[np.float64],
    reads: Reads,
    *,
    tolerance: float,
    around: float,
    memory: float,
) -> Cut:
    """Return the windows for what a method reads of a raster.

    Parameters
    ----------
    place : RasterPlace
    widths : (scales + 1,) array
        In metres.
    reads : Reads
    tolerance : float
    around : float
        Cells around one that the method looks at beside; infinite for all of the raster.
    memory : float
        Bytes that a window may take.

    Raises
    ------
    MeshdepictError
        Where a window with all that it needs takes more.
    """
    columns, rows = place.size
    bytes_each = 12 * (len(reads.sets) + 1) + 56 * len(reads.curvature | reads.seen) + 140
    if rows * columns * bytes_each <= min(memory, _USUAL):
        return Cut(rows, columns, max(rows, columns), 0, 0, 1)
    if not around < max(rows, columns):
        needed = rows * columns * bytes_each
        if needed > memory:
            raise MeshdepictError(
                f"the method looks at all {rows * columns:,} cells at once, which take "
                f"{as_text(needed)} of memory, and {as_text(memory)} are allowed: allow more with "
                "--max-memory, take a method or options that look no further than a radius, or a "
                "coarser model"
            )
        return Cut(rows, columns, max(rows, columns), 0, 0, 1)
    width = float(max((widths[scale] for scale in reads.sets | reads.means), default=0.0))
    narrow, down = place.widest, place.spacing[1]
    along = float(np.linalg.norm(place.steps[..., 0], axis=1).min())
    beside = [2 + math.ceil(around)] * 2
    align = 1
    if width > 0:
        beside[0] += halo(width / down, tolerance)
        beside[1] += halo(width / along, tolerance, width / narrow)
        align = max(alignment(width / down), alignment(width / narrow))
    unit = max(align, _TILE)

    def taken(side: int) -> float:
        high, wide = (
            min(side + 2 * a + align, n) for a, n in zip(beside, (rows, columns), strict=True)
        )
        return float(high) * wide * bytes_each

    side = unit
    while taken(2 * side) <= min(memory, _USUAL) or (
        side < 2 * max(beside) and taken(2 * side) <= memory
    ):
        side *= 2
    while taken(side) > memory and side > align:
        side = max(side // 2, align)
    if taken(side) > memory:
        looks, less = "the method looks at", "let it look less far (its radius or rings)"
        if width > 0:
            looks, less = f"widths of {width:.4g} m look at", "take smaller widths"
        raise MeshdepictError(
            f"a window of {side:,} cells with the {max(beside):,} around it that {looks} takes "
            f"{as_text(taken(side))} of memory, and {as_text(memory)} are allowed: allow more "
            f"with --max-memory, or {less}"
        )
    return Cut(rows, columns, side, beside[0], beside[1], align)


def _wider(span: slice, around: int, align: int, count: int) -> slice:
    start = max(0, span.start - around) // align * align
    return slice(start, min(count, span.stop + around))
