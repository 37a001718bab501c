"""Derivatives of a Gaussian-smoothed grid at chosen voxels, slab by slab.

Wide Gaussians are taken in two steps of equal width: the first onto a grid just fine enough for
what it leaves, the second back to the voxels. A thinned-out grid of spacing H under two Gaussians
of width σ/√2 errs by exp(−π²σ²/2H²), so H = πσ / √(2 ln 1/ε), and a scale costs less the wider it
is. All matrices are those of the whole grid, whatever part of it is at hand, so that slabs and
blocks give its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import DTypeLike, NDArray

from meshdepict.voxels.gaussian_bands import Band, gaussian_band
from meshdepict.voxels.grid import Triple
from meshdepict.voxels.grid_samples import Samples

__all__ = ["BINDING", "GRADIENT", "Grid", "GridSums", "Piece", "halo", "reach_of"]

GRADIENT = ((0, 0, 1), (0, 1, 0), (1, 0, 0))  # orders along z, y, x of d/dx, d/dy, d/dz

# A gradient is told from what the sums round and cut off where it changes the values by this share
# of their range within one width. There the tolerance binds: an error of tolerance times this share
# turns it by the tolerance.
BINDING = 1e-3

_BLOCK = 1 << 24  # values of a slab, as floats
_THINNER = 0.8  # of the cells along an axis: it must be worth a second step
_DOUBLE = 1e-5  # below this tolerance single precision is too coarse


def reach_of(tolerance: float) -> float:
    """Return where Gaussians are cut off, in widths: exp(−reach²/2) = tolerance · BINDING."""
    return math.sqrt(-2 * math.log(tolerance * BINDING))


@dataclass(frozen=True)
class Piece:
    """A part of a grid's values, and where it lies in the whole.

    Attributes
    ----------
    values : (z, y, x) array
    corner : (z, y, x)
        Where it begins.
    shape : (nz, ny, nx)
        Of the whole grid.
    range : (low, high)
        Of the whole grid's values, which are scaled to −1 … 1.
    """

    values: NDArray[Any]
    corner: Triple
    shape: Triple
    range: tuple[float, float]

    @property
    def half_range(self) -> float:
        """What a scaled value of 1 stands for."""
        low, high = self.range
        return (high / 2 - low / 2) or 1.0

    def read(self, low: Triple, high: Triple, kind: DTypeLike) -> NDArray[Any]:
        """Return scaled values of a box of the whole grid's voxels as contiguous floats."""
        box = tuple(slice(a - c, b - c) for a, b, c in zip(low, high, self.corner, strict=True))
        part = np.asarray(self.values[box])
        # Compiled loops would read on beyond a block that is too small.
        assert part.shape == tuple(b - a for a, b in zip(low, high, strict=True))
        middle = self.range[0] / 2 + self.range[1] / 2
        exact = part.dtype.itemsize <= 2 or part.dtype == np.float32
        scaled = np.subtract(
            part, middle, dtype=kind if exact else np.float64, casting="unsafe", order="C"
        )
        scaled /= scaled.dtype.type(self.half_range)
        return np.ascontiguousarray(scaled, kind)

    def at(self, samples: Samples) -> NDArray[Any]:
        """Return the values (n,) at samples, as they are."""
        values = np.asarray(self.values)
        shape = (values.shape[0], values.shape[1], values.shape[2])
        return values.reshape(-1)[samples.flat(shape, self.corner)]


class Grid(Protocol):
    """What sums are taken over: a `Piece`, or samples with zeros between."""

    @property
    def shape(self) -> Triple:
        """Size of the whole grid."""

    def read(self, low: Triple, high: Triple, kind: DTypeLike) -> NDArray[Any]:
        """Return values of a box of the whole grid's voxels as contiguous floats."""


class GridSums:
    """Smoothed derivatives of a grid at chosen voxels.

    Parameters
    ----------
    grid : Piece or another Grid
        With all that the samples' Gaussians reach (see `halo`).
    samples : Samples
        At least one.
    tolerance : float
        Largest angle in radians by which a gradient turns, where it changes the values by 1e-3 of
        their range within one width.
    """

    def __init__(self, grid: Grid, samples: Samples, tolerance: float) -> None:
        self.grid, self.samples = grid, samples
        self.reach = reach_of(tolerance)
        self.kind = np.float32 if tolerance >= _DOUBLE else np.float64

    def derivatives(
        self,
        widths: NDArray[np.float64],
        orders: tuple[Triple, ...],
        out: NDArray[np.float32],
        done: Callable[[float], None] | None = None,
    ) -> None:
        """Find derivatives of the scaled values, per voxel.

        Parameters
        ----------
        widths : (3,) array
            In voxels, along z, y, x.
        orders : tuple of (order in z, order in y, order in x)
        out : (len(orders), n) array
        done : callable, optional
            Told the share of the work after each part of it.
        """
        from meshdepict.voxels.gaussian_gradient import at_voxels

        first, second = _two_steps(self.grid.shape, widths, self.reach, 1 + np.max(orders))
        read = self.grid.read if first is None else self._thinned(first, second)
        low, high, samples = self.samples.low, self.samples.high, self.samples
        ranges = [band.inputs(a, b) for band, a, b in zip(second, low, high, strict=True)]
        plane = math.prod(b - a for a, b in ranges[1:])
        for begin, end in _slabs(high[0] - low[0], plane, second[0].taps):
            z0, z1 = begin + low[0], end + low[0]
            z_low, z_high = second[0].inputs(z0, z1)
            start = (z_low, ranges[1][0], ranges[2][0])
            block = read(start, (z_high, ranges[1][1], ranges[2][1]), self.kind)
            bands = _rows(second, (z0, *low[1:]), (z1, *high[1:]), start, self.kind)
            at_voxels(block, bands, orders, samples.rows[begin:end], samples.columns, out)
            if done:
                done((end - begin) / (high[0] - low[0]))

    def _thinned(
        self, first: list[Band], second: list[Band]
    ) -> Callable[[Triple, Triple, Any], NDArray[Any]]:
        """Smooth onto the coarser grid, as far as the samples need it; return its reader."""
        from meshdepict.voxels.gaussian_gradient import resample

        ends = zip(second, self.samples.low, self.samples.high, strict=True)
        ranges = [band.inputs(a, b) for band, a, b in ends]
        corner, high = ([span[side] for span in ranges] for side in (0, 1))
        thin = np.empty([b - a for a, b in ranges], self.kind)
        inputs = [band.inputs(a, b) for band, (a, b) in zip(first, ranges, strict=True)]
        plane = math.prod(b - a for a, b in inputs[1:])
        step = max(1.0, np.diff(first[0].start).mean()) if len(first[0].start) > 1 else 1.0
        for begin, end in _slabs(len(thin), plane * step, first[0].taps / step):
            z0, z1 = begin + corner[0], end + corner[0]
            z_low, z_high = first[0].inputs(z0, z1)
            start = (z_low, inputs[1][0], inputs[2][0])
            block = self.grid.read(start, (z_high, inputs[1][1], inputs[2][1]), self.kind)
            bands = _rows(first, (z0, *corner[1:]), (z1, *high[1:]), start, self.kind)
            resample(block, bands, thin[begin:end])

        def read(low: Triple, high: Triple, kind: DTypeLike) -> NDArray[Any]:
            box = tuple(slice(a - c, b - c) for a, b, c in zip(low, high, corner, strict=True))
            return np.ascontiguousarray(thin[box], kind)

        return read


def halo(shape: Triple, widths: NDArray[np.float64], tolerance: float) -> Triple:
    """Return how far (z, y, x) the numbers of a voxel reach, in voxels, for widths (k, 3).

    Next to the border matrices take more on the other side, but no more than a box of at least
    this size has within it and its halo.
    """
    far = np.zeros(3, np.int64)
    for width in widths:
        first, second = _two_steps(shape, width, reach_of(tolerance), 2)
        for axis, band in enumerate(second):
            low, high = band.start, band.start + band.taps - 1
            if first is not None:
                low, high = first[axis].start[low], first[axis].start[high] + first[axis].taps - 1
            here, last = np.arange(shape[axis]), shape[axis] - 1
            inside = (low > 0) & (high < last)
            reach = np.maximum(here - low, high - here)[inside]
            far[axis] = max(far[axis], reach.max() if len(reach) else last)
    return int(far[0]), int(far[1]), int(far[2])


def _two_steps(
    shape: Triple, widths: NDArray[np.float64], reach: float, orders: int
) -> tuple[list[Band] | None, list[Band]]:
    """Return the matrices onto a coarser grid, if one is worth it, and from there to voxels."""
    first, second = [], []
    for count, width in zip(shape, widths.tolist(), strict=True):
        fewer = math.ceil(count * reach / (math.pi * width)) if width > 0 else count
        fewer = fewer if fewer <= _THINNER * count else count
        half = width / math.sqrt(2) if fewer < count else 0.0
        rest = math.sqrt(width**2 - half**2) * fewer / count
        first.append(gaussian_band(count, fewer, half, reach=reach))
        second.append(gaussian_band(fewer, count, rest, reach=reach, orders=orders))
    same = all(
        band.taps == 1 and len(band.start) == n for band, n in zip(first, shape, strict=True)
    )
    return (None if same else first), second


def _rows(
    bands: list[Band], low: Iterable[int], high: Iterable[int], start: Triple, kind: DTypeLike
) -> tuple[Band, Band, Band]:
    """Return the rows of a box of outputs, for a block of inputs that begins at `start`."""
    parts = zip(bands, low, high, start, strict=True)
    z, y, x = (band.rows(a, b, first, kind) for band, a, b, first in parts)
    return z, y, x


def _slabs(count: int, plane: float, taps: float) -> Iterator[tuple[int, int]]:
    """Cut slices into slabs that hold, with the slices around that they need, about a block."""
    step = max(1, int(_BLOCK / max(plane, 1) - taps), int(min(taps, 8)))
    for begin in range(0, count, step):
        yield begin, min(begin + step, count)
