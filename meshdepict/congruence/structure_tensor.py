"""Structure tensors: in which direction, and how strongly, an image varies about each pixel."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.threads import kernel

__all__ = ["StructureTensor", "reach", "structure_tensor"]

Floats = NDArray[np.floating[Any]]

_WIDTHS = 3.0  # where Gaussians end: 0.3 % of their mass lie beyond
_FAINT = 1e-9  # of the largest eigenvalue: an image that varies less has no direction there


class StructureTensor(NamedTuple):
    """Symmetric 2×2 tensors [[xx, xy], [xy, yy]]: x to the right, y down the image."""

    xx: Floats
    xy: Floats
    yy: Floats

    @property
    def energy(self) -> Floats:
        """Mean of the eigenvalues: half the mean squared gradient."""
        return (self.xx + self.yy) / 2

    @property
    def direction(self) -> Floats:
        """Eigenvector of the larger eigenvalue (…, 2), unit: across the bands of the image.

        x where the image varies alike in all directions; zero where it hardly varies at all, its
        larger eigenvalue being at most 1e-9 of the largest.
        """
        half = (self.xx - self.yy) / 2
        radius = np.sqrt(half**2 + self.xy**2)  # half the difference of the eigenvalues
        long = radius + np.abs(half)
        # Two ways to write the same line; the longer vector has no cancellation.
        length = np.sqrt(long**2 + self.xy**2)
        length[length == 0] = 1
        x = np.where(half < 0, self.xy, long) / length
        y = np.where(half < 0, long, self.xy) / length
        x[radius == 0] = 1
        larger = self.energy + radius
        faint = larger <= _FAINT * larger.max(initial=0)
        x[faint] = y[faint] = 0
        return np.stack([x, y], axis=-1)


def reach(width: float) -> int:
    """Return how many pixels on either side a Gaussian of this width takes in: 3 widths."""
    return math.ceil(_WIDTHS * width)


def structure_tensor(
    image: ArrayLike, *, gradient_width: float = 1.0, width: float = 5.0
) -> StructureTensor:
    """Average the outer products of an image's gradients about each pixel (Bigün 1987).

    Parameters
    ----------
    image : (h, w) array_like of float
    gradient_width : float
        Gaussian whose derivatives give the gradients, in pixels.
    width : float
        Gaussian that averages, in pixels.

    Returns
    -------
    StructureTensor
        Three (h − 2m, w − 2m) arrays of float32, for the pixels whose whole window lies in the
        image: m = reach(gradient_width) + reach(width), 18 unless given. Empty where none does.
    """
    image = np.ascontiguousarray(image, np.float64)
    # Gradients in double precision: a faint relief on a steep slope must not drown in rounding.
    gx, gy = (gradient.astype(np.float32) for gradient in _gradient(image, gradient_width))
    weights = _gaussian(width).astype(np.float32)
    products = (gx * gx, gx * gy, gy * gy)
    return StructureTensor(*(_filtered(_filtered(p, weights, 0), weights, 1) for p in products))


def _gradient(image: Floats, width: float) -> tuple[Floats, Floats]:
    """Return the derivatives along x and y of the image under a Gaussian, per pixel."""
    smooth = _gaussian(width)
    steps = np.arange(len(smooth))
    slope = steps * smooth / (2 * np.sum(steps**2 * smooth))  # exact for a ramp
    along_x = _filtered(_filtered(image, smooth, 0), slope, 1, odd=True)
    along_y = _filtered(_filtered(image, smooth, 1), slope, 0, odd=True)
    return along_x, along_y


def _gaussian(width: float) -> Floats:
    """Return the centre and one side of a Gaussian of unit sum."""
    side = np.exp(-0.5 * (np.arange(reach(width) + 1) / width) ** 2)
    return side / (2 * side.sum() - side[0])


def _filtered(image: Floats, weights: Floats, axis: int, *, odd: bool = False) -> Floats:
    """Correlate along an axis with a kernel, given by its centre and one side, where it fits.

    An odd kernel changes its sign on the other side; being applied to differences, it gives
    exactly zero where the image is constant.
    """
    shape = list(image.shape)
    shape[axis] = max(shape[axis] - 2 * (len(weights) - 1), 0)
    result = np.empty(shape, image.dtype)
    down, right = (1, 0) if axis == 0 else (0, 1)
    _correlate(image, weights, down, right, image.dtype.type(-1 if odd else 1), result)
    return result


@kernel()
def _correlate(image, weights, down, right, sign, result):  # type: ignore[no-untyped-def]
    far = len(weights) - 1
    height, width = result.shape
    for y in range(height):
        row = result[y]
        centre = image[y + far * down, far * right :]
        for x in range(width):
            row[x] = weights[0] * centre[x]
        for k in range(1, far + 1):  # each a sweep along whole rows, which becomes vector code
            before = image[y + (far - k) * down, (far - k) * right :]
            after = image[y + (far + k) * down, (far + k) * right :]
            for x in range(width):
                row[x] += weights[k] * (after[x] + sign * before[x])
