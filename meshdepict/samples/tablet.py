"""A clay tablet with cuneiform signs: wedges pressed in by a stylus, in ruled lines."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.samples.arguments import MOST, checked
from meshdepict.samples.roughness import roughness
from meshdepict.samples.slab import slab
from meshdepict.shapes.mesh import Mesh

__all__ = ["tablet"]

Floats = NDArray[np.float64]

# In millimetres.
_HALF = 38.0, 50.0, 12.0
_RULING = 0.35, 0.7  # depth and half width of the lines between lines
_HEAD = 0.4  # a wedge's length before its deepest point, as a share of its width
_CLEAR = 0.8  # share of a face, across and up, that is written on

# A sign is a few wedges in a square of size 1: the head's place, where its tail points (degrees, 0
# to the right), its length. They are no writing, but made of what writing is made of.
_SIGNS = (
    ((0.1, 0.75, 0, 0.7), (0.1, 0.25, 0, 0.7), (0.5, 0.95, -90, 0.8)),
    ((0.2, 0.9, -90, 0.75), (0.5, 0.9, -90, 0.75), (0.8, 0.9, -90, 0.75)),
    ((0.15, 0.5, 0, 0.75), (0.7, 0.9, -90, 0.85)),
    ((0.1, 0.85, -40, 0.5), (0.1, 0.15, 40, 0.5), (0.65, 0.9, -90, 0.8)),
    ((0.35, 0.5, 180, 0.2), (0.65, 0.5, 180, 0.2), (0.9, 0.5, 180, 0.2)),
    ((0.05, 0.8, 0, 0.85), (0.05, 0.5, 0, 0.85), (0.05, 0.2, 0, 0.85), (0.8, 0.95, -90, 0.9)),
    ((0.1, 0.5, 0, 0.85), (0.3, 0.95, -90, 0.4), (0.6, 0.95, -90, 0.4), (0.45, 0.45, -90, 0.4)),
)


def tablet(
    vertices: Annotated[int, Range(12, MOST)] = 200_000,
    *,
    lines: Annotated[int, Range(0, 40)] = 9,
    depth: Annotated[float, Range(0, 5, unit="mm")] = 1.1,
) -> Mesh:
    """Return a clay tablet of 76 × 100 × 24 mm about the origin, written on its front.

    Each wedge is what the corner of a stylus leaves: a steep triangular head and a tail that gets
    shallow. The clay is a little rough, worn at its edges, and cracked.

    Parameters
    ----------
    vertices : int
        About how many; see `sphere` for how near. Wedges want 100,000.
    lines : int
        Of signs, from the top to the bottom.
    depth : float
        Of a wedge's head.

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, lines, depth = checked(tablet, vertices=vertices, lines=lines, depth=depth)
    points, faces, share = slab(vertices, _HALF, corner=5.0, edge=3.2)
    points *= (1 + 0.010 * roughness(points, 60.0, octaves=2, seed=11))[:, None]
    front = np.flatnonzero(share > 0.3)
    points[front, 2] -= _written(points[front, 0], points[front, 1], lines, depth)
    outwards = points / np.array(_HALF) ** 2
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    rough = 0.05 * roughness(points, 3.5, octaves=3, falloff=0.6, seed=12)
    rough += 0.30 * roughness(points, 24.0, octaves=2, seed=13)
    rough -= 0.6 * _crack(points)
    return Mesh(points + rough[:, None] * outwards, faces)


def _written(x: Floats, y: Floats, lines: int, depth: float) -> Floats:
    """Return how deep signs and rulings are at places of the front."""
    found = np.zeros(len(x))
    if not lines:
        return found
    wide, high = (2 * _CLEAR * side for side in _HALF[:2])
    pitch = high / lines
    ruled, half = _RULING
    for k in range(lines + 1):
        away = np.abs(y - (high / 2 - k * pitch))
        near = (away < half) & (np.abs(x) < 0.56 * wide)
        found[near] = ruled * min(1.0, depth) * (1 - away[near] / half)
    draw = np.random.default_rng(1700)
    size = 0.78 * pitch
    for k in range(lines):
        foot = high / 2 - (k + 0.5) * pitch - size / 2
        left = -wide / 2 + draw.uniform(0, 0.2) * size
        while left < wide / 2 - size:
            for head_x, head_y, turn, length in _SIGNS[draw.integers(len(_SIGNS))]:
                at = left + head_x * size, foot + head_y * size
                turned = np.radians(turn + draw.normal(0, 4))
                _press(found, x, y, at, turned, length * size, depth, 0.19 * size)
            left += size * draw.uniform(1.08, 1.35)
    return found


def _press(
    found: Floats, x: Floats, y: Floats, at: tuple[float, float], turn: float, length: float,
    depth: float, half: float,
) -> None:  # fmt: skip
    """Press one wedge in: a groove along `turn`, deepest at its head."""
    near = np.flatnonzero((np.abs(x - at[0]) < length + half) & (np.abs(y - at[1]) < length + half))
    x, y = x[near] - at[0], y[near] - at[1]
    along = np.cos(turn) * x + np.sin(turn) * y
    across = np.abs(np.cos(turn) * y - np.sin(turn) * x)
    bottom = np.minimum(1 - along / length, 1 + along / (2 * _HEAD * half))
    found[near] = np.maximum(found[near], depth * np.maximum(bottom - across / half, 0))


def _crack(points: Floats) -> Floats:
    """Return 1 in the middle of a crack that runs across a corner of the tablet."""
    line = points @ np.array([0.55, 0.83, 0.1]) - 24.0
    line += 2.2 * roughness(points, 18.0, octaves=4, falloff=0.55, seed=14)
    return np.exp(-((line / 0.45) ** 2))
