"""A knapped core: a flint nodule, most of its skin struck off in flakes."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.samples.arguments import MOST, checked
from meshdepict.samples.roughness import roughness
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.icosahedron import icosphere

__all__ = ["knapped_core"]

Floats = NDArray[np.float64]

_HALF = np.array([32.0, 44.0, 26.0])  # mm
_RIPPLE = 0.045, 3.2  # height and wavelength of the waves that run out from a blow
_BULB = 9.0, 0.5  # reach and depth of the swelling under a blow


def knapped_core(
    vertices: Annotated[int, Range(12, MOST)] = 160_000,
    *,
    flakes: Annotated[int, Range(0, 500)] = 34,
    ripples: Annotated[float, Range(0, 5)] = 1.0,
) -> Mesh:
    """Return a flint core about the origin, 88 mm high, seen by its ridges, scars and ripples.

    Each flake leaves a scar, hollow like a shell, between sharp ridges; faint waves run through
    it from where it was struck, from the top or the bottom. At the back some of the rough skin is
    left.

    Parameters
    ----------
    vertices : int
        About how many; see `sphere` for how near.
    flakes : int
        How many were struck off.
    ripples : float
        Height of the waves, 1 for what flint shows.

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, flakes, ripples = checked(
        knapped_core, vertices=vertices, flakes=flakes, ripples=ripples
    )
    directions, faces = icosphere(vertices)
    reach = 1 / np.linalg.norm(directions / _HALF, axis=1)
    skin = directions * reach[:, None]
    reach = reach * (1 + 0.03 * roughness(skin, 30.0, octaves=2, seed=31))
    reach = reach + 0.22 * roughness(skin, 3.0, octaves=4, falloff=0.65, seed=32)
    draw = np.random.default_rng(31)
    for _ in range(flakes):
        reach = _struck_off(directions, reach, draw, ripples)
    return Mesh(directions * reach[:, None], faces)


def _struck_off(
    directions: Floats, reach: Floats, draw: np.random.Generator, ripples: float
) -> Floats:
    """Return how far the core reaches after one more flake, a ball's cap hollowed out of it."""
    round_, up = draw.uniform(-2.3, 2.3), draw.uniform(-0.75, 0.75)  # 0 is the front
    towards = np.array([np.sin(round_), 0.0, np.cos(round_)]) * np.sqrt(1 - up * up)
    towards[1] = up
    surface = reach[np.argmax(directions @ towards)]
    hollow, depth = draw.uniform(28, 70), draw.uniform(1.6, 4.2)
    centre = (surface - depth + hollow) * towards
    struck = np.array([0.35 * centre[0], np.copysign(44.0, up + 0.05), 0.35 * centre[2]])
    middle = directions @ centre
    inside = middle**2 - (centre @ centre - hollow**2)
    meets = np.flatnonzero((inside > 0) & (middle > 0))
    at = middle[meets] - np.sqrt(inside[meets])
    away = np.linalg.norm(directions[meets] * at[:, None] - struck, axis=1)
    height, length = _RIPPLE
    begin, swell = _BULB
    at = at + ripples * height * np.sin(2 * np.pi * away / length) * np.exp(-away / 40)
    at = at + swell * np.exp(-((away / begin) ** 2))
    left = reach.copy()
    left[meets] = np.minimum(reach[meets], np.maximum(at, 0.3 * reach[meets]))
    return left
