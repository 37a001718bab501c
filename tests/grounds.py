"""Ground whose slopes and horizons are known: planes, hills and cones, on rasters laid any way."""

from __future__ import annotations

import numpy as np

AXES = {
    "squares": np.array([[[2.0, 0], [0, -2.0]]]),
    "oblongs": np.array([[[2.0, 0], [0, -3.0]]]),
    "south up": np.array([[[2.0, 0], [0, 2.0]]]),
    "turned": np.array([[[1.6, 1.2], [1.2, -1.6]]]),
}
"""Metres (east, north) of a step along [column, row]."""


def placed(steps: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """East and north of cells' centres, (2, rows, cols), from the middle of the raster."""
    rows, cols = shape
    row, col = np.mgrid[:rows, :cols] + 0.0
    return np.einsum("ij,jrc->irc", steps[0], np.stack([col - cols / 2, row - rows / 2]))


def plane(steps: np.ndarray, shape: tuple[int, int], east: float, north: float) -> np.ndarray:
    """Heights of a plane of two slopes."""
    x, y = placed(steps, shape)
    return east * x + north * y


def hill(
    east: np.ndarray, north: np.ndarray, *, width: float, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Heights of a Gaussian hill, and its gradient (2, …)."""
    z = height * np.exp(-(east**2 + north**2) / (2 * width**2))
    return z, np.stack([-east, -north]) * z / width**2
