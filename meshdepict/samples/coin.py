"""A coin with an ear of barley, as Metapontum struck them: raised in front, sunk behind."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.samples.arguments import MOST, checked
from meshdepict.samples.capitals import distance_to_strokes, strokes
from meshdepict.samples.roughness import roughness
from meshdepict.samples.slab import slab
from meshdepict.shapes.mesh import Mesh

__all__ = ["coin"]

Floats = NDArray[np.float64]

_RADIUS, _THICK = 12.0, 1.3  # mm, thick: half
_GRAINS = 8  # on either side of the ear
_BEADS = 56
_BORDER = 0.86  # radius of the ring of beads, in radii


def coin(
    vertices: Annotated[int, Range(12, MOST)] = 200_000,
    *,
    relief: Annotated[float, Range(0, 1, unit="mm")] = 0.42,
    wear: Annotated[float, Range(0, 1)] = 0.5,
) -> Mesh:
    """Return a coin of 24 mm about the origin: an ear of barley, letters, a ring of beads.

    Parameters
    ----------
    vertices : int
        About how many; see `sphere` for how near. The beads want 60,000.
    relief : float
        How high the ear stood when it was struck.
    wear : float
        How much of what stands highest has gone.

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, relief, wear = checked(coin, vertices=vertices, relief=relief, wear=wear)
    points, faces, share = slab(vertices, (_RADIUS, _RADIUS, _THICK), corner=2.0, edge=9.0)
    height = np.zeros(len(points))
    for side in (1, -1):  # the same picture from both sides: raised, then sunk
        seen = np.flatnonzero(side * share > 0.6)
        x, y = side * points[seen, 0] / _RADIUS, points[seen, 1] / _RADIUS
        height[seen] = _struck(x, y) * (1 if side > 0 else -0.75)
    cap = 1.05 - 0.8 * wear
    worn = np.where(height > 0, cap * np.tanh(height / cap), height)
    bump = 0.012 * roughness(points, 1.2, octaves=3, seed=21)
    bump += 0.05 * roughness(points, 9.0, octaves=2, seed=22)
    points[:, 2] += np.sign(share) * np.minimum(np.abs(share), 1) * (relief * worn + bump)
    return Mesh(points, faces)


def _struck(x: Floats, y: Floats) -> Floats:
    """Return the height of the picture at places of a disc of radius 1; the ear stands 1 high."""
    height = np.zeros(len(x))

    def grain(at: tuple[float, float], turn: float, half: tuple[float, float], top: float) -> None:
        along = np.cos(turn) * (x - at[0]) + np.sin(turn) * (y - at[1])
        across = np.cos(turn) * (y - at[1]) - np.sin(turn) * (x - at[0])
        inside = 1 - (along / half[0]) ** 2 - (across / half[1]) ** 2
        np.maximum(height, top * np.sqrt(np.maximum(inside, 0)), out=height)

    pieces: list[list[tuple[float, float]]] = [[(0, -0.72), (0, 0.6)]]
    for k in range(_GRAINS):
        up = -0.34 + 0.105 * k
        for side in (-1, 1):
            lift = np.pi / 2 - side * np.radians(24)
            grain((side * 0.085, up), lift, (0.115, 0.055), 1.0)
            begin = np.array([side * 0.085, up]) + 0.1 * np.array([np.cos(lift), np.sin(lift)])
            tip = begin + (0.30 - 0.012 * k) * np.array(
                [np.cos(lift - side * 0.12), np.sin(lift - side * 0.12)]
            )
            pieces.append([tuple(begin), tuple(tip)])
    grain((0.0, 0.55), np.pi / 2, (0.12, 0.05), 1.0)
    lines = distance_to_strokes(x, y, [np.array(piece) for piece in pieces], 0.03)
    height = np.maximum(height, 0.5 * np.maximum(1 - (lines / 0.03) ** 2, 0))
    for word, at, turn in (("META", (-0.52, 0.36), -90), ("PONT", (0.52, 0.36), -90)):
        written, _ = strokes(word, "coin")
        turned = np.radians(turn)
        matrix = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
        placed = 0.19 * (written - np.array([0, 0.5])) @ matrix.T + np.array(at)
        away = distance_to_strokes(x, y, placed, 0.042)
        height = np.maximum(height, 0.7 * np.maximum(1 - (away / 0.042) ** 2, 0))
    angle = np.arctan2(y, x)
    bead = 2 * np.pi / _BEADS
    off = (angle + bead / 2) % bead - bead / 2
    ring = np.hypot(_BORDER * off, np.hypot(x, y) - _BORDER)
    beads = 0.55 * np.sqrt(np.maximum(1 - (ring / 0.036) ** 2, 0))
    return np.maximum(height, beads)
