"""Roughness of stone and clay: gradient noise of several sizes, the same bits every time."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

__all__ = ["roughness"]

Floats = NDArray[np.float64]

_GRADIENTS = np.array([d for d in product((-1, 0, 1), repeat=3) if np.abs(d).sum() == 2], float)
_SPREAD = 0.27  # standard deviation of one octave
_TURN = np.array(
    [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]
)  # lattices don't line up


def roughness(
    points: Floats, wavelength: float, *, octaves: int = 5, falloff: float = 0.5, seed: int = 0
) -> Floats:
    """Return smooth noise at points in space, of mean about 0 and standard deviation about 1.

    Parameters
    ----------
    points : (n, 3) array
    wavelength : float
        Of the largest bumps, in the unit of the points.
    octaves : int
        How many sizes, each half as long as the one before.
    falloff : float
        Height of each size, relative to the one before.
    seed : int
        Another noise for each.
    """
    found = np.zeros(len(points))
    place = points / wavelength
    for k in range(octaves):
        found += falloff**k * _octave(place, seed * 64 + k)
        place = 2 * (place @ _TURN.T)
    total = sum(falloff ** (2 * k) for k in range(octaves)) ** 0.5
    return found / (_SPREAD * total)


def _octave(place: Floats, seed: int) -> Floats:
    cell = np.floor(place)
    within = place - cell
    fade = within**3 * (within * (6 * within - 15) + 10)
    lattice = cell.astype(np.int64)
    found = np.zeros(len(place))
    for corner in product((0, 1), repeat=3):
        off = within - np.array(corner)
        weight = _share(fade, corner)
        gradient = _GRADIENTS[_scrambled(lattice + np.array(corner), seed) % len(_GRADIENTS)]
        found += weight * np.einsum("ij,ij->i", gradient, off)
    return found


def _share(fade: Floats, corner: tuple[int, ...]) -> Floats:
    x, y, z = (fade[:, k] if corner[k] else 1 - fade[:, k] for k in range(3))
    return x * y * z


def _scrambled(lattice: NDArray[np.int64], seed: int) -> NDArray[np.uint32]:
    """Return a number for each lattice point, without pattern: a multiplicative hash."""
    x, y, z = (lattice & 0xFFFFFFFF).astype(np.uint32).T
    number = x * np.uint32(0x8DA6B343) ^ y * np.uint32(0xD8163841) ^ z * np.uint32(0xCB1AB31F)
    number ^= np.uint32(seed * 0x9E3779B1 & 0xFFFFFFFF)
    for shift, factor in ((16, 0x7FEB352D), (15, 0x846CA68B)):
        number = (number ^ (number >> np.uint32(shift))) * np.uint32(factor)
    return number ^ (number >> np.uint32(16))
