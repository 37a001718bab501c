"""Samples of a raster that is never at hand as a whole, gathered from its windows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.shape import Shape

if TYPE_CHECKING:
    from meshdepict.scales.normal_sets import Fill
    from meshdepict.shapes.height_field import HeightField

__all__ = ["GatheredSamples"]


class GatheredSamples(ScaleSpace):
    """Some samples, which stand for all; what is asked of them is asked of window after window.

    Parameters
    ----------
    shape : Shape
        What they are of, as far as it is known.
    parts : callable () → iterator of ScaleSpace
        Samples of windows, made anew each time, since they aren't kept.
    widths, ratio, tolerance
        Those of all parts.
    """

    _means_of_smoothing = ("_parts",)

    def __init__(
        self,
        shape: Shape,
        parts: Callable[[], Iterator[ScaleSpace]],
        widths: NDArray[np.float64],
        ratio: float,
        *,
        tolerance: float,
    ) -> None:
        nobody = np.empty((3, 0), np.float32)
        super().__init__(
            shape, np.empty((0, 3)), widths, ratio, nobody, facing=0, tolerance=tolerance
        )
        self._parts = parts

    @property
    def vertical(self) -> NDArray[np.float64]:
        """Up."""
        return np.array([0.0, 0.0, 1.0])

    def typical(self) -> ScaleSpace:
        """Return the samples with their normals."""
        return self._met

    @cached_property
    def _met(self) -> ScaleSpace:
        found = [(part.points, part.planes) for part in self._parts()]
        nothing = np.empty((0, 3)), np.empty((len(self.widths), 3, 0), np.float32)
        places, sets = zip(nothing, *found, strict=True)
        return _Met(self, np.concatenate(places), np.concatenate(sets, axis=2))

    def ball_shares(self, radii: Sequence[float]) -> NDArray[np.float64]:
        """Return those of the samples; ``radii`` in diagonals of the whole."""
        found = [
            part.ball_shares([r * self.shape.diagonal / part.shape.diagonal for r in radii])
            for part in self._parts()
        ]
        return np.concatenate([np.empty((len(radii), 0)), *found], axis=1)

    def from_heights(self, find: Callable[[HeightField], NDArray[Any]]) -> NDArray[Any]:
        """Return what is found of each window's heights, at the samples."""
        return np.concatenate([part.from_heights(find) for part in self._parts()])


class _Met(ScaleSpace):
    """Gathered samples with positions and normals."""

    def __init__(
        self, whole: GatheredSamples, points: NDArray[np.float64], planes: NDArray[np.float32]
    ) -> None:
        super().__init__(
            whole.shape, points, whole.widths, whole.ratio, planes[0],
            facing=0, tolerance=whole.tolerance,
        )  # fmt: skip
        self._whole, self._gathered = whole, planes

    @property
    def vertical(self) -> NDArray[np.float64]:
        """Up."""
        return self._whole.vertical

    def ball_shares(self, radii: Sequence[float]) -> NDArray[np.float64]:
        """Return those of the samples."""
        return self._whole.ball_shares(radii)

    def from_heights(self, find: Callable[[HeightField], NDArray[Any]]) -> NDArray[Any]:
        """Return what is found at the samples."""
        return self._whole.from_heights(find)

    def _smoother(self) -> Fill:
        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            out[:] = self._gathered[scale]

        return fill
