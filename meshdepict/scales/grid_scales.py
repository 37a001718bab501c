"""The scale space of a grid: gradients of the Gaussian-filtered values at the voxels shown (ES §4).

Normals are −∇f/‖∇f‖: outwards from what is dense. Scale 0 is the central difference, as in VTK.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.grid_smoothing import GridSmoothing
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace
from meshdepict.voxels.grid_normals import (
    Scattered,
    gradients_to_world,
    in_voxels,
    least_gradient,
)
from meshdepict.voxels.grid_samples import Samples
from meshdepict.voxels.grid_sums import GRADIENT, GridSums, Piece

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.voxels.grid import Grid

__all__ = ["GridSpace", "opacity_of", "typical_slices"]

_PART = 1 << 20  # points to be placed at a time

_MIDDLE, _ENOUGH = 16, 8_000  # slices at least and samples that are enough to judge by

_MEAN = 0.1  # tolerance of averages: Gaussians cut off at 1e-4 of their height


class GridSpace(ScaleSpace):
    """Samples at the voxels of a volume that are shown, or beside such, and have a gradient.

    Renderers interpolate between voxels: at the border of what is shown half of the colour is that
    of voxels without opacity, which would draw black seams if they were not shaded, too.

    Attributes
    ----------
    shape : Volume
    voxels : (n,) array of int64
        Where each sample is in ``shape.values.ravel()``.
    gradient : (n,) array of float64
        ‖∇f‖ at scale 0, in values per world unit.
    flat : Samples
        More such voxels, without a gradient at any scale, and so without a normal.
    transfer : TransferFunction or None
        What decides which voxels are shown.
    """

    shape: Grid

    def __init__(
        self,
        smoothing: GridSmoothing,
        flat: Samples,
        gradient: NDArray[np.float64],
        widths: NDArray[np.float64],
        ratio: float,
        planes: NDArray[np.float32],
        first: NDArray[np.int8],
        *,
        transfer: TransferFunction | None,
    ) -> None:
        shape, self.samples = smoothing.grid, smoothing.samples
        points = self.samples.indices().astype(np.float64)
        for part in np.array_split(points, len(points) // _PART + 1):
            part[:] = shape.to_world(part)
        super().__init__(
            shape, points, widths, ratio, planes[0], planes=planes, facing=0,
            tolerance=smoothing.tolerance,
        )  # fmt: skip
        self.flat, self.gradient, self.transfer = flat, gradient, transfer
        self._sums, self._piece = smoothing.sums, smoothing.piece
        self._grid_smoothing, self._first = smoothing, first

    @cached_property
    def voxels(self) -> NDArray[np.int64]:
        """Where each sample is in the flat array of values."""
        return self.samples.flat(self._piece.shape)

    @property
    def shaded_share(self) -> float:
        """Samples over all voxels of the volume."""
        return self.count / self.shape.n_samples

    @cached_property
    def base_color(self) -> NDArray[np.float32]:
        """Linear colour (n, 3) that the transfer function gives each sample; white without one."""
        return self.color_at(self.samples)

    @cached_property
    def alpha(self) -> NDArray[np.uint8]:
        """Opacity of each sample (n,), 255 without a transfer function; 0 only beside the shown."""
        return self.opacity_at(self.samples, self.gradient)

    def color_at(self, samples: Samples) -> NDArray[np.float32]:
        """Return the linear colour (n, 3) of some samples; white without a transfer function."""
        from meshdepict.color.srgb import srgb_to_linear

        if self.transfer is None:
            return np.ones((len(samples), 3), np.float32)
        return srgb_to_linear(self.transfer.color(self._piece.at(samples)))

    def opacity_at(self, samples: Samples, gradient: NDArray[Any]) -> NDArray[np.uint8]:
        """Return the opacity (n,) of some samples, given the slopes of the density there."""
        from meshdepict.color.srgb import quantise

        if self.transfer is None:
            return np.full(len(samples), 255, np.uint8)
        opacity = opacity_of(self.transfer, self.shape, self._piece, samples, gradient)
        return np.maximum(quantise(opacity), opacity > 0)

    def between(self, begin: int, end: int) -> ScaleSpace:
        """Return the samples of some slices along z."""
        slices = self.samples.indices()[:, 2]
        here = (slices >= begin) & (slices < end)
        return _Slices(self, here)

    def typical(self) -> ScaleSpace:
        """Return the samples of the middle slices, as many of them as have enough."""
        return typical_slices(self.between, self.shape.counts[0])

    # --- what grids do in their own way -----------------------------------------------------

    def mean(self, values: NDArray[Any], width: float) -> NDArray[np.float64]:
        """Return ``Σ_j G(x_i − x_j) c_j / Σ_j G(x_i − x_j)`` over the samples j."""
        samples, shape = self.samples, self._piece.shape
        widths = in_voxels(width, self.shape)
        sums = np.empty((2, 1, len(samples)), np.float32)
        for out, weights in zip(sums, (np.ones(len(samples)), values), strict=True):
            grid = GridSums(Scattered(samples, weights, shape), samples, _MEAN)
            grid.derivatives(widths, ((0, 0, 0),), out)
        mass, total = sums[:, 0].astype(np.float64)
        some = mass > 0
        return np.where(some, total / np.where(some, mass, 1), values)

    def _smoother(self) -> Fill:
        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            self._grid_smoothing.fill(float(self.widths[scale]), out, done)
            self._fall_back(scale)

        return fill

    def _fall_back(self, scale: int) -> None:
        planes = np.asarray(self._room)
        self._grid_smoothing.fall_back(scale, planes, set(self._sets), self.widths, self._first)

    def adopt(self, scales: Iterable[int]) -> None:
        """Take over sets of normals that are zero where there is no gradient."""
        for scale in sorted(scales):
            self._fall_back(scale)
            self._take(scale)

    def _made_from(self, scale: int) -> tuple[int, ...]:
        return ()  # but where there is no gradient, which is rare

    def _principal(self, scale: int) -> PrincipalCurvatures:
        from meshdepict.curvature.grid import HESSIAN, isosurface_curvatures

        spacing = self.shape.spacing
        found = np.empty((9, self.count), np.float32)
        widths = in_voxels(float(self.widths[scale]), self.shape)
        self._sums.derivatives(widths, (*GRADIENT, *HESSIAN), found)
        floor = least_gradient(float(self.widths[scale]), self.shape)
        return isosurface_curvatures(
            found,
            self.planes_at(scale),
            gradients_to_world(self.shape),
            floor,
            float(spacing.min()),
        )

    def _turns(self, scale: int) -> NDArray[np.float32]:
        from meshdepict.curvature.grid import grid_neighbour_cosines

        return grid_neighbour_cosines(self.samples, self.planes_at(scale))


class _Slices(ChosenSamples):
    """The samples of some slices, which stand for the whole."""

    def typical(self) -> ScaleSpace:
        return self


def typical_slices(between: Callable[[int, int], ScaleSpace], count: int) -> ScaleSpace:
    """Return the samples of the middle slices, as many slices as hold enough samples.

    Parameters
    ----------
    between : callable (begin, end) → ScaleSpace
        The samples of some slices.
    count : int
        Slices that there are.
    """
    thick = _MIDDLE
    while True:
        begin = max(0, (count - thick) // 2)
        found = between(begin, min(begin + thick, count))
        if thick >= count or len(found.points) >= _ENOUGH:
            return found
        thick *= 2


def opacity_of(
    transfer: TransferFunction, shape: Grid, piece: Piece, samples: Samples, gradient: NDArray[Any]
) -> NDArray[np.float32]:
    """Return the opacity (n,) of samples, given the slopes of the density there."""
    with np.errstate(over="ignore"):  # an infinite slope is as steep as they come
        return transfer.opacity(piece.at(samples), gradient * shape.units_per_mm)
