"""The sky in cells: directions as numbers of an octahedral map, and what an environment is there.

The sphere is unfolded onto a square by way of the octahedron; its faces' corners are the axes.
Neighbouring directions have neighbouring cells, 0.8° wide on average, and a direction fits into two
bytes. Rays from a sample are 13° apart at 64: a cell more or less is nothing.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.equirectangular import bilinear, to_picture
from meshdepict.threads import kernel

if TYPE_CHECKING:
    from meshdepict.scene.environment import Environment

__all__ = ["ACROSS", "cell", "cell_directions", "sky_colors"]

ACROSS = 256
"""Cells along a side of the square."""


@kernel(inline=True)
def cell(x, y, z):  # type: ignore[no-untyped-def]
    """Return the number of the cell that a direction, not zero, falls into."""
    length = abs(x) + abs(y) + abs(z)
    u, v = x / length, y / length
    if z < 0:
        u, v = math.copysign(1 - abs(v), x), math.copysign(1 - abs(u), y)
    column = min(int((u + 1) * (ACROSS / 2)), ACROSS - 1)
    row = min(int((v + 1) * (ACROSS / 2)), ACROSS - 1)
    return row * ACROSS + column


@functools.cache
def cell_directions() -> NDArray[np.float64]:
    """Return the unit vectors (cells, 3) to the middles of the cells."""
    along = (np.arange(ACROSS) + 0.5) * (2 / ACROSS) - 1
    v, u = (part.ravel() for part in np.meshgrid(along, along, indexing="ij"))
    z = 1 - np.abs(u) - np.abs(v)
    below = z < 0
    x = np.where(below, np.copysign(1 - np.abs(v), u), u)
    y = np.where(below, np.copysign(1 - np.abs(u), v), v)
    found = np.stack([x, y, z], axis=1)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    found.setflags(write=False)
    return found


def sky_colors(environment: Environment) -> NDArray[np.float32]:
    """Return the radiance (cells, 3) of an environment in each cell.

    Its picture is first averaged over blocks about as large as the cells, so that a small sun falls
    between none.
    """
    flux, _ = environment.reduced(ACROSS)
    radiance = flux[..., :3] / np.maximum(flux[..., 3:], 1e-30)
    directions = to_picture(cell_directions(), environment.up)
    return np.asarray(bilinear(radiance.astype(np.float32), directions), np.float32)
