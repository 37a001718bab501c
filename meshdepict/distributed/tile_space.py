"""Scale spaces of a part of a mesh: its vertices with normals that somebody has smoothed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.distributed.tiling import Extent
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace

__all__ = ["TileSpace"]


class TileSpace(ScaleSpace):
    """Some vertices of a mesh; `shape` is where all of it lies.

    Parameters
    ----------
    extent : Extent
    points : (n, 3) array
    planes : (scales + 1, 3, n) array of float32
        Normals at all scales.
    widths, ratio, facing, tolerance
        As of every `ScaleSpace`.
    """

    def __init__(
        self,
        extent: Extent,
        points: NDArray[np.float64],
        planes: NDArray[np.float32],
        widths: NDArray[np.float64],
        ratio: float,
        *,
        facing: int,
        tolerance: float,
    ) -> None:
        super().__init__(
            extent, points, widths, ratio, planes[0], facing=facing, tolerance=tolerance
        )
        self._found = planes

    @property
    def unit_points(self) -> NDArray[np.float64]:
        """(n, 3) vertices in diagonals from the centre of the whole."""
        shape: Any = self.shape
        found: NDArray[np.float64] = shape.recentred(self.points)
        return found

    def _smoother(self) -> Fill:
        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            out[:] = self._found[scale]

        return fill
