"""The sky in cells: directions as numbers of an octahedral map, and what an environment is there.

The sphere is unfolded onto a square by way of the octahedron; its faces' corners are the axes.
Neighbouring directions have neighbouring cells, 0.8° wide on average, and a direction fits into two
bytes. Rays from a sample are 13° apart at 64: a cell more or less is nothing.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.environment import LUMINANCE, Environment
from meshdepict.threads import kernel

if TYPE_CHECKING:
    from meshdepict.scene.light import Light

__all__ = ["ACROSS", "cell", "cell_directions", "parted_sky", "sky_colors"]

ACROSS = 256
"""Cells along a side of the square."""

_SKY_ROWS = 64  # of the picture that the mean is taken of
_LAMP = 3.0  # times the mean: what is brighter is a lamp
_LAMPS = 32  # lights that stand for all lamps: half as many rays as of the sky
_colors: WeakKeyDictionary[Environment, tuple[int, NDArray[np.float32]]] = WeakKeyDictionary()
_parts: WeakKeyDictionary[Environment, tuple[Environment, list[Light]]] = WeakKeyDictionary()


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


def sky_colors(environment: Environment, rays: int) -> NDArray[np.float32]:
    """Return the radiance (cells, 3) of an environment in each cell.

    It is blurred by half the distance of so many cosine-weighted rays: what is narrower would be
    met by one ray of a sample and by none of its neighbour's, and be speckle. Those of the last
    number of rays are kept as long as the environment.
    """
    former, colors = _colors.get(environment, (0, None))
    if colors is None or former != rays:
        colors = environment.lookup(cell_directions(), blur=math.sqrt(math.pi / rays) / 2)
        colors.setflags(write=False)
        _colors[environment] = rays, colors
    return colors


def parted_sky(environment: Environment) -> tuple[Environment, list[Light]]:
    """Return an environment without what is much brighter than its mean, and lights for that.

    A lamp's light comes from a few directions, which a few rays of each sample meet or miss; it
    needs shadow rays of its own. The parts are kept as long as the environment.
    """
    if environment not in _parts:
        _parts[environment] = _parted(environment)
    return _parts[environment]


def _parted(environment: Environment) -> tuple[Environment, list[Light]]:
    flux, _ = environment.reduced(_SKY_ROWS)
    mean = float((flux[..., :3].sum(axis=(0, 1)) @ LUMINANCE) / flux[..., 3].sum())
    brightness = environment.pixels @ LUMINANCE.astype(np.float32)
    share = np.minimum(1, _LAMP * mean / np.maximum(brightness, np.float32(1e-30)))[..., None]
    if (share >= 1).all():
        return environment, []
    dim, bright = (
        Environment(environment.pixels * part, name=environment.name, up=environment.up)
        for part in (share, 1 - share)
    )
    return dim, [light for light in bright.lights(_LAMPS) if light.color.any()]
