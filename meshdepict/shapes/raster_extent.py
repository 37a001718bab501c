"""The box about a raster of heights: what views and widths need to know of it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.scene.vectors import frozen
from meshdepict.shapes.raster_place import RasterPlace

__all__ = ["RasterBox", "RasterExtent"]

Floats = NDArray[np.float64]


class RasterBox(RasterPlace):
    """A raster whose heights lie in a box; a shape as far as the eye is concerned."""

    kind = "height field"
    length_unit = "m"

    def _filled(self) -> tuple[Floats, Floats, float, float]:
        """Return the rows and columns that hold heights, the lowest and the highest height."""
        raise NotImplementedError

    @cached_property
    def _box(self) -> tuple[Floats, Floats]:
        """Least and largest coordinates (3,)."""
        rows, columns, low, high = self._filled()
        y, x = np.repeat(rows[[0, -1]], 2), np.tile(columns[[0, -1]], 2)
        if self.degrees:  # the widest row may be any
            y, x = np.repeat(rows, 2), np.tile(columns[[0, -1]], len(rows))
        east, north = self.place(y, x)
        return (
            np.array([east.min(), north.min(), low]),
            np.array([east.max(), north.max(), high]),
        )

    @cached_property
    def outline(self) -> Floats:
        """(8, 3) corners of the box."""
        ends = np.stack(self._box)
        which = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)])
        return frozen(np.stack([ends[which[:, axis], axis] for axis in range(3)], axis=1))

    @cached_property
    def centre(self) -> Floats:
        """(3,) middle of the box."""
        low, high = self._box
        return frozen(low / 2 + high / 2)

    @cached_property
    def diagonal(self) -> float:
        """Its diagonal, in metres."""
        low, high = self._box
        largest = float((high - low).max())
        return largest and largest * float(np.linalg.norm((high - low) / largest))

    def recentred(self, points: Floats) -> Floats:
        """Return positions (…, 3) relative to the centre, in diagonals."""
        moved: Floats = (points - self.centre) / (self.diagonal or 1.0)
        return moved


class RasterExtent(RasterBox):
    """A raster of heights that is not in memory.

    Parameters
    ----------
    rows, columns, transform, crs, degrees, unit
        See `RasterPlace`.
    filled : (rows, columns, lowest, highest), optional
        Which rows and columns hold heights, rising, and between what, in metres; all of them and
        level unless given.
    name : str
        Of what it is.
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
        filled: tuple[Floats, Floats, float, float] | None = None,
        name: str = "",
    ) -> None:
        super().__init__(rows, columns, transform, crs=crs, degrees=degrees, unit=unit)
        self.name, self._known = name, filled

    @property
    def identity(self) -> str:
        """Size and name."""
        columns, rows = self.size
        return f"{columns} x {rows} cells of {self.name}".removesuffix(" of ")

    def _filled(self) -> tuple[Floats, Floats, float, float]:
        if self._known is not None:
            return self._known
        columns, rows = self.size
        return np.arange(float(rows)), np.arange(float(columns)), 0.0, 0.0
