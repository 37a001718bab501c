"""Where a raster of heights lies: its cells, from six numbers of its file to metres."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.heights.cell_lookup import cells_at
from meshdepict.heights.cells import Transform, checked_transform, metric_steps, place_of
from meshdepict.options import real
from meshdepict.scene.vectors import frozen

__all__ = ["RasterPlace"]

Floats = NDArray[np.float64]


class RasterPlace:
    """The cells of a raster on the map, whether or not their heights are at hand.

    Parameters
    ----------
    rows, columns : int
    transform : (6,) array_like
        See `HeightField`.
    crs : str
    degrees : bool
    unit : float

    Attributes
    ----------
    size : (columns, rows)
    transform, crs, degrees, unit
    steps : (rows or 1, 2, 2) ndarray of float64
        Metres [east, north] per step [to the next column, to the next row]; in degrees row by row.

    Raises
    ------
    MeshdepictError
        For sheared or empty cells, and degrees that are none.
    """

    def __init__(
        self,
        rows: int,
        columns: int,
        transform: ArrayLike,
        *,
        crs: str = "",
        degrees: bool = False,
        unit: float = 1.0,
    ) -> None:
        if not isinstance(crs, str) or not isinstance(degrees, bool):
            raise MeshdepictError("crs is a text, WKT for instance, and degrees True or False")
        metres = real(unit)
        if metres is None or not 0 < metres < 1e12:
            raise MeshdepictError(f"unit={unit!r} is not how many metres a unit has")
        self.size = columns, rows
        self.transform: Transform = checked_transform(transform)
        self.crs, self.degrees, self.unit = crs, degrees, 1.0 if degrees else metres
        self.steps = frozen(metric_steps(self.transform, rows, degrees=degrees, unit=self.unit))

    @cached_property
    def spacing(self) -> tuple[float, float]:
        """Metres along a row and down a column from cell to cell, in the middle row."""
        along, down = np.linalg.norm(self.steps[len(self.steps) // 2], axis=0)
        return float(along), float(down)

    @cached_property
    def widest(self) -> float:
        """Metres along a row from cell to cell that no row has more of, nor one at the equator.

        A window of a raster has the same.
        """
        from meshdepict.heights.cells import METRES_PER_DEGREE

        a, _, _, d, _, _ = self.transform
        return float(np.hypot(a, d)) * (METRES_PER_DEGREE if self.degrees else self.unit)

    @cached_property
    def edge_length(self) -> float:
        """Metres from cell to cell, the shorter way."""
        return min(self.spacing)

    def moved(self, row: int, column: int) -> Transform:
        """Return the transform of a window that begins at a cell."""
        a, b, c, d, e, f = self.transform
        return a, b, c + a * column + b * row, d, e, f + d * column + e * row

    def place(self, rows: Floats, columns: Floats) -> tuple[Floats, Floats]:
        """Return east and north in metres of the centres of cells."""
        return place_of(
            self.transform, rows, columns, degrees=self.degrees, unit=self.unit,
            middle=self._middle,
        )  # fmt: skip

    def cells_at(self, east: Floats, north: Floats) -> tuple[Floats, Floats]:
        """Return rows and columns at places in metres: a cell's centre has half ones."""
        return cells_at(
            self.transform, east, north, degrees=self.degrees, unit=self.unit, middle=self._middle
        )

    @property
    def _middle(self) -> float:
        """Where x, along every row, metres east are counted from in degrees."""
        wide, high = self.size
        a, b, c, *_ = self.transform
        return a * wide / 2 + b * high / 2 + c
