"""The sRGB curve and its 256 levels: where linear light becomes what a file or screen stores."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["linear_to_srgb", "quantise", "srgb_levels", "srgb_to_linear"]

Floats = NDArray[np.floating[Any]]
Bytes = NDArray[np.uint8]

# Where the two branches of the curve meet. IEC 61966-2-1 rounds it to 0.0031308, which leaves a
# step of 3e-8 downwards; with all digits the curve is continuous and its inverse exact.
_KNEE = 0.0031306684425005883
_SLOPE = 12.92


def srgb_to_linear(x: ArrayLike) -> Floats:
    """Return the linear value of display values in [0, 1] (IEC 61966-2-1); others are clipped.

    float32 stays float32, everything else becomes float64. NaN becomes 0.
    """
    x = _unit(x)
    return np.where(x <= _SLOPE * _KNEE, x / _SLOPE, ((x + 0.055) / 1.055) ** 2.4).astype(x.dtype)


def linear_to_srgb(x: ArrayLike) -> Floats:
    """Return the display value of linear values in [0, 1] (IEC 61966-2-1); others are clipped.

    float32 stays float32, everything else becomes float64. NaN becomes 0.
    """
    x = _unit(x)
    root = x ** (1 / 2.4)
    steep = root + 0.055 * (root - 1)  # 1.055 root − 0.055, but exactly 1 at 1
    return np.where(x <= _KNEE, x * _SLOPE, steep).astype(x.dtype)


def quantise(x: ArrayLike) -> Bytes:
    """Return the nearest of 256 levels for values in [0, 1]: 0 → 0, 1 → 255, halves upwards.

    Values outside are clipped; NaN becomes 0.
    """
    x = _unit(x)
    return (x * x.dtype.type(255) + x.dtype.type(0.5)).astype(np.uint8)


def _unit(x: ArrayLike) -> Floats:
    """Clip to [0, 1] as floats; NaN becomes 0."""
    x = np.asarray(x)
    x = x if x.dtype == np.float32 else x.astype(np.float64)
    return np.minimum(np.fmax(x, x.dtype.type(0)), x.dtype.type(1))


# --- linear values to levels, by table ------------------------------------------------------

# Two levels are at least 1/(255 · 12.92) apart, so a bin of 1/4096 holds at most one threshold
# between levels: the level at the bin's start is right, or one too low.
_BINS = 4096


@cache
def _thresholds() -> tuple[Bytes, Floats]:
    """Return the level at the start of each bin, and the linear value where each level begins."""
    begins = np.append(srgb_to_linear((np.arange(256) - 0.5) / 255), np.inf)
    begins[0] = -np.inf
    starts = np.searchsorted(begins, np.arange(_BINS + 1) / _BINS, side="right") - 1
    return starts.astype(np.uint8), begins


def srgb_levels(x: Floats) -> Bytes:
    """``quantise(linear_to_srgb(x))``, several times faster."""
    x = _unit(x)
    starts, begins = _thresholds()
    levels = np.take(starts, (x * _BINS).astype(np.int32))
    next_begins = np.take(begins[1:].astype(x.dtype), levels)
    levels += x >= next_begins
    return levels
