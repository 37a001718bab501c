"""Samples at the pixels of a picture: where they are, as a list and as a picture."""

from __future__ import annotations

import dataclasses
import operator
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import real_array
from meshdepict.images.pixels import depth_ratio, depth_steps, pixel_sizes, positions
from meshdepict.scene.vectors import frozen

if TYPE_CHECKING:
    from meshdepict.scene.view import View

__all__ = ["PixelSamples", "check_size", "finite"]

Floats = NDArray[np.float64]

_MOST = 16_384  # pixels across
_LARGEST = 1e150  # of depths, as of coordinates: beyond it squares overflow
_DEEPEST = 1e30  # pixels: in single precision a number whose differences are, too


class PixelSamples:
    """What is known of a picture's pixels without their normals; see `GBuffer`, which is one.

    Parameters
    ----------
    view : View
    mask : (height, width) array_like
    depths : (n,) array_like
        Along the view's axis, of the pixels of the mask, row by row from the top left.
    """

    def __init__(self, view: View, mask: ArrayLike, depths: ArrayLike) -> None:
        if not hasattr(view, "parallel_scale"):
            raise MeshdepictError(f"view={view!r} is no View")
        try:
            self.mask = frozen(np.array(mask, bool))
        except (TypeError, ValueError):
            raise MeshdepictError("a mask has rows and columns of the same length") from None
        if self.mask.ndim != 2:
            raise MeshdepictError(f"a mask has rows and columns, not the shape {self.mask.shape}")
        self.size = check_size((self.mask.shape[1], self.mask.shape[0]))
        count = int(np.count_nonzero(self.mask))
        if not count:
            raise MeshdepictError("the mask is empty: no pixel shows a surface")
        self.view = dataclasses.replace(view, height_px=self.size[1])
        self.depths = finite(depths, (count,), "depths")
        if view.parallel_scale is None and self.depths.min() <= 0:
            raise MeshdepictError(
                f"{int((self.depths <= 0).sum()):,} depths are not positive, so behind the eye of "
                "a perspective view: give distances from the eye, or a parallel view"
            )
        self._check_reach()

    def _check_reach(self) -> None:
        """Refuse depths that leave no room for computing, in the world or in pixels."""
        low, high = float(self.depths.min()), float(self.depths.max())
        nearest = 1 / _LARGEST if self.view.parallel_scale is None else -_LARGEST
        if not nearest <= low <= high <= _LARGEST:
            raise MeshdepictError(
                f"depths from {low:g} to {high:g} leave no room for computing: they may be "
                f"{nearest:g} to {_LARGEST:g}"
            )
        if self.view.parallel_scale is not None:
            pixel = 2 * self.view.parallel_scale / self.size[1]
            if high - low > _DEEPEST * pixel:
                raise MeshdepictError(
                    f"depths from {low:g} to {high:g} are more than {_DEEPEST:g} pixels of "
                    f"{pixel:g} apart: leave out of the mask what shows no surface"
                )

    @cached_property
    def points(self) -> Floats:
        """(n, 3) world positions of the samples."""
        rows, columns = np.nonzero(self.mask)
        return frozen(positions(self.view, self.size[0], columns, rows, self.depths))

    @property
    def outline(self) -> Floats:
        """World positions (n, 3) that a fitted view has to show: the samples'."""
        return self.points

    @cached_property
    def edge_length(self) -> float:
        """World size of a pixel; in a perspective view where half of the samples are nearer."""
        return float(np.median(self.pixel_sizes))

    def image(self, values: ArrayLike, *, background: ArrayLike = 0) -> NDArray[Any]:
        """Return values of the samples, (n,) or (n, k), as a picture (height, width[, k]).

        ``background`` fills the pixels without a surface.

        Raises
        ------
        MeshdepictError
            For another number of values.
        """
        values = np.asarray(values)
        if values.ndim not in (1, 2) or len(values) != len(self.depths):
            raise MeshdepictError(
                f"values of shape {values.shape} are not one for each of {len(self.depths):,} "
                "samples"
            )
        picture = np.empty((*self.mask.shape, *values.shape[1:]), values.dtype)
        picture[...] = background
        picture[self.mask] = values
        return picture

    @property
    def depth(self) -> Floats:
        """(height, width) depth in world units; 0 without a surface."""
        return self.image(self.depths)

    # --- what filters and curvature need ----------------------------------------------------

    @cached_property
    def index(self) -> NDArray[np.int32]:
        """(height + 2, width + 2): the sample at a pixel, −1 if none, −2 beyond the picture."""
        index = np.full((self.size[1] + 2, self.size[0] + 2), -2, np.int32)
        index[1:-1, 1:-1] = -1
        index[1:-1, 1:-1][self.mask] = np.arange(len(self.depths), dtype=np.int32)
        return frozen(index)

    @cached_property
    def _box(self) -> tuple[slice, slice]:
        """The rows and columns that the mask's pixels are in."""
        lines = (np.flatnonzero(self.mask.any(axis=axis)) for axis in (1, 0))
        rows, columns = (slice(int(line[0]), int(line[-1]) + 1) for line in lines)
        return rows, columns

    def cropped(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values (…, n) of samples as the part (…, h, w) of the picture that has any."""
        mask = self.mask[self._box]
        picture = np.zeros((*values.shape[:-1], *mask.shape), values.dtype)
        picture[..., mask] = values
        return picture

    def uncropped(self, picture: NDArray[Any]) -> NDArray[Any]:
        """Return the values (…, n) of samples from what `cropped` returned."""
        return picture[..., self.mask[self._box]]

    @cached_property
    def pixel_sizes(self) -> Floats:
        """(n,) world size of a pixel at the samples."""
        return frozen(pixel_sizes(self.view, self.depths))

    @cached_property
    def depth_steps(self) -> Floats:
        """(n,) depth with the pixel as its unit; see `pixels.depth_steps`."""
        return frozen(depth_steps(self.view, self.depths))

    def depth_ratio(self, steps: ArrayLike) -> Floats:
        """Return |Δ ln depth| of differences of `depth_steps`; see `pixels.depth_ratio`."""
        return depth_ratio(self.view, steps)


def check_size(size: Any) -> tuple[int, int]:
    """Return a picture's width and height, or raise `MeshdepictError`."""
    try:
        width, height = (operator.index(length) for length in size)
    except (TypeError, ValueError):
        width = height = 0
    if not (1 <= width <= _MOST and 1 <= height <= _MOST):
        raise MeshdepictError(
            f"size={size!r} is not a width and a height from 1 to {_MOST:,} pixels"
        )
    return width, height


def finite(values: ArrayLike, shape: tuple[int, ...], what: str) -> Floats:
    """Return a read-only copy of numbers, one or several per pixel, or raise `MeshdepictError`."""
    array = real_array(values)
    if array is None:
        raise MeshdepictError(f"{what} must be real numbers, one or several per pixel")
    if array.shape != shape:
        raise MeshdepictError(
            f"{what} have the shape {array.shape}; the mask has {shape[0]} pixels"
        )
    if not np.isfinite(array).all():
        raise MeshdepictError(
            f"{what} of {int((~np.isfinite(array)).sum()):,} pixels are not finite"
        )
    return frozen(array)
