"""A raster of heights that is not in memory: what views and widths need to know of it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.scene.vectors import frozen
from meshdepict.shapes.raster_place import RasterPlace

__all__ = ["RasterExtent"]

Floats = NDArray[np.float64]


class RasterExtent(RasterPlace):
    """The box about a raster of heights; a shape as far as the eye is concerned.

    Parameters
    ----------
    rows, columns, transform, crs, degrees, unit
        See `RasterPlace`.
    heights : (lowest, highest)
        In metres.
    name : str
        Of what it is.
    """

    kind = "height field"
    length_unit = "m"

    def __init__(
        self,
        rows: int,
        columns: int,
        transform: ArrayLike,
        *,
        crs: str = "",
        degrees: bool = False,
        unit: float = 1.0,
        heights: tuple[float, float] = (0.0, 0.0),
        name: str = "",
    ) -> None:
        super().__init__(rows, columns, transform, crs=crs, degrees=degrees, unit=unit)
        self.heights, self.name = heights, name

    @property
    def identity(self) -> str:
        """Size and name."""
        columns, rows = self.size
        return f"{columns} x {rows} cells of {self.name}".removesuffix(" of ")

    @cached_property
    def outline(self) -> Floats:
        """(8, 3) corners of the box about the centres of all cells."""
        columns, rows = self.size
        y, x = np.array([0.0, rows - 1.0]), np.array([0.0, columns - 1.0])
        if self.degrees:  # the widest row may be any
            y = np.arange(float(rows))
        east, north = self.place(np.repeat(y, 2), np.tile(x, len(y)))
        low = np.array([east.min(), north.min(), self.heights[0]])
        high = np.array([east.max(), north.max(), self.heights[1]])
        ends = np.stack([low, high])
        which = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)])
        return frozen(np.stack([ends[which[:, axis], axis] for axis in range(3)], axis=1))

    @cached_property
    def centre(self) -> Floats:
        """(3,) middle of that box."""
        return frozen(self.outline.min(axis=0) / 2 + self.outline.max(axis=0) / 2)

    @cached_property
    def diagonal(self) -> float:
        """Its diagonal, in metres."""
        return float(np.linalg.norm(self.outline.max(axis=0) - self.outline.min(axis=0)))

    def recentred(self, points: Floats) -> Floats:
        """Return positions (…, 3) relative to the centre, in diagonals."""
        moved: Floats = (points - self.centre) / (self.diagonal or 1.0)
        return moved
