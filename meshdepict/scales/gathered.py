"""Samples of a raster that is never at hand as a whole, gathered from its windows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.shape import Shape

__all__ = ["GatheredSamples", "Part"]

Part: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float32]]
"""Positions (k, 3) and normals (scales + 1, 3, k) of some samples."""


class GatheredSamples(ScaleSpace):
    """Positions and normals of some samples, which stand for all.

    Parameters
    ----------
    shape : Shape
        What they are of, as far as it is known.
    parts : sequence of Part
        Samples of windows, of none or some.
    widths, ratio, tolerance
        Those of all parts.
    """

    def __init__(
        self,
        shape: Shape,
        parts: Sequence[Part],
        widths: NDArray[np.float64],
        ratio: float,
        *,
        tolerance: float,
    ) -> None:
        nothing = np.empty((0, 3)), np.empty((len(widths), 3, 0), np.float32)
        places, sets = zip(nothing, *parts, strict=True)
        points, planes = np.concatenate(places), np.concatenate(sets, axis=2)
        super().__init__(
            shape, points, widths, ratio, planes[0], planes=planes, facing=0, tolerance=tolerance
        )
        for scale in range(1, len(widths)):
            self._take(scale)

    @property
    def vertical(self) -> NDArray[np.float64]:
        """Up."""
        return np.array([0.0, 0.0, 1.0])
