"""Blurred copies of an equirectangular picture: what a lobe sees that is wider than a pixel.

The blur is Gaussian-like, a von Mises–Fisher lobe. Widths are √2 apart; each copy has as many rows
as show its width without loss.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["WIDEST", "Blurs", "blurred", "levels", "rows_of", "source_rows", "width_of"]

Floats = NDArray[Any]

WIDEST = 1.6  # radians
_TEXELS = 9.0  # of a copy are π widths: one is 0.35 of the width, and the nearest will do
_SOURCE = 0.2  # of a width is the most that a pixel of what is blurred measures
_REACH = 5.0  # widths: e^−12 of the middle


class Blurs(NamedTuple):
    """Copies of a picture, one after the other, from the widest blur to the narrowest.

    Attributes
    ----------
    texels : (n, 3) array of float32
        Radiance of all copies, row by row.
    starts, rows, columns : (k,) arrays of int32
        Where each begins in them, and its size. Copy j is blurred by `width_of(j)`.
    """

    texels: NDArray[np.float32]
    starts: NDArray[np.int32]
    rows: NDArray[np.int32]
    columns: NDArray[np.int32]


def width_of(level: int) -> float:
    """Return a level's width in radians."""
    return WIDEST * 2 ** (-level / 2)


def levels(width: float) -> int:
    """Return how many levels are at least as wide as this, one if none is."""
    return 1 + max(0, math.floor(2 * math.log2(WIDEST / width) + 1e-9))


def rows_of(width: float) -> int:
    """Return the number of rows that show a blur of this width."""
    return max(8, math.ceil(_TEXELS / width))


def source_rows(width: float) -> int:
    """Return the number of rows of the picture that this blur is made of, at least."""
    return max(8, math.ceil(math.pi / (_SOURCE * width)))


def blurred(flux: NDArray[np.float32], width: float, rows: int) -> NDArray[np.float32]:
    """Return radiance averaged over a lobe about each direction of a coarser picture.

    Between two rows the lobe depends on the difference of longitude alone, so each pair of rows is
    a circular convolution.

    Parameters
    ----------
    flux : (h, w, 4) array
        Radiance times solid angle, and the solid angle, as `Environment.reduced` returns them.
    width : float
        In radians.
    rows : int

    Returns
    -------
    (rows, 2 rows, 3) array
    """
    height, columns = flux.shape[:2]
    here = (np.arange(height) + 0.5) * (math.pi / height)
    turn = np.cos(2 * math.pi / columns * np.arange(columns))
    spectra = np.fft.rfft(flux[..., :3], axis=1)
    kept = min(spectra.shape[1], rows + 1)
    angle = flux[:, 0, 3].astype(np.float64)
    number = np.arange(kept)
    # Middles of pixels lie half a pixel beside 0, and the pixels differ in size.
    shift = np.exp(1j * math.pi * number * (0.5 / rows - 1 / columns))
    out = np.empty((rows, 2 * rows, 3), np.float32)
    for row, polar in enumerate((np.arange(rows) + 0.5) * (math.pi / rows)):
        near = np.flatnonzero(np.abs(here - polar) <= _REACH * width + math.pi / height)
        across = np.sin(polar) * np.sin(here[near])[:, None]
        along = np.cos(polar) * np.cos(here[near])[:, None]
        lobe = np.fft.rfft(np.exp((along + across * turn - 1) / width**2), axis=1).real
        found = np.einsum("rm,rmc->mc", lobe[:, :kept], spectra[near, :kept])
        line = found * shift[:, None] * (2 * rows / columns / (lobe[:, 0] @ angle[near]))
        out[row] = np.fft.irfft(line, 2 * rows, axis=0)
    return np.maximum(out, 0)
