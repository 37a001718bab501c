"""Procedural ground as lidar sees it: what to shade, and to measure, without a survey.

All in metres, over 400 m × 400 m: a river winds from west to east between terraces; on the northern
one old fields have banks as high as a knee, and a mound with a ditch stands among them.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.options import Range, check
from meshdepict.shapes.height_field import HeightField

__all__ = ["BANK", "MOUND", "SIDE", "TERRACES", "terrain", "terrain_height"]

Floats = NDArray[np.float64]

SIDE = 400.0
"""Metres from side to side."""

MOUND = (150.0, 300.0), 0.8, 0.3
"""Middle of the mound, east and north; its height and its ditch's depth."""

BANK = 0.35
"""Height of a field's bank."""

TERRACES = (35.0, 3.0), (80.0, 2.5)
"""How far from the river each terrace begins, and how high its step is."""

_RIVER = 7.0, 2.5  # half width and depth
_STEP = 6.0  # that a terrace's slope is long
_FIELDS = (42.0, 64.0), 12.0  # sizes of a field, and by how many degrees it is turned
_BANK_WIDTH = 1.5
_SWELLS = 6  # of the ground, from 0.4 m on, each with half the height and length of the one before


def terrain(
    size: Annotated[tuple[int, int], Range(2, 40_000, help="cells along x and y")] = (400, 400),
) -> HeightField:
    """Return ground with a river bed, terraces, banks of old fields and a low mound.

    Parameters
    ----------
    size : (int, int)
        Columns and rows. The ground is 400 m wide either way; cells follow, oblongs where the two
        numbers differ.

    Returns
    -------
    HeightField
        float32, in metres from (0, 0) to (400, 400), in no coordinate reference system.

    Raises
    ------
    MeshdepictError
        For a size out of its range.
    """
    columns, rows = check(terrain, {"size": size}, "terrain")["size"]
    along, down = SIDE / columns, SIDE / rows
    x = along * (np.arange(columns) + 0.5)
    y = SIDE - down * (np.arange(rows) + 0.5)
    z = np.empty((rows, columns), np.float32)
    for row in range(rows):  # a line at a time: large ones would fill the memory ten times over
        z[row] = terrain_height(x, y[row])
    return HeightField(
        z, transform=(along, 0, 0, 0, -down, SIDE), attributes={"description": "procedural terrain"}
    )


def terrain_height(x: ArrayLike, y: ArrayLike) -> Floats:
    """Return the height of that ground at places x east and y north of its corner, in metres."""
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    away = y - _river(x)
    half, depth = _RIVER
    z = 250 - 0.004 * x - depth * np.exp(-((away / half) ** 2))
    for begin, height in TERRACES:
        z = z + height * _smooth_step((np.abs(away) - begin) / _STEP)
    z += 0.06 * np.log1p(np.exp((np.abs(away) - 180) / 12)) * 12  # the valley's sides
    for k in range(_SWELLS):
        turn, length = 2.4 * k, 160 / 2**k
        along, across = _turned(x, y, turn)
        z += 0.4 / 2**k * np.sin(along * 2 * np.pi / length) * np.cos(across * 4.9 / length + k)
    fields = _smooth_step((away - 95) / 10) * BANK * _banks(x, y)
    (east, north), height, ditch = MOUND
    distance = np.hypot(x - east, y - north)
    clear = _smooth_step((distance - 20) / 6)  # nobody ploughed there
    mound = height * np.exp(-((distance / 8) ** 2)) - ditch * np.exp(
        -(((distance - 15) / 2.5) ** 2)
    )
    return z + clear * fields + mound


def _river(x: Floats) -> Floats:
    """Return how far north the river is."""
    return 120 + 28 * np.sin(2 * np.pi * x / 290 + 0.6)


def _banks(x: Floats, y: Floats) -> Floats:
    """Return 1 on the crests of banks round fields, 0 within those."""
    sizes, turn = _FIELDS
    found = np.zeros(np.broadcast(x, y).shape)
    for place, size in zip(_turned(x, y, np.radians(turn)), sizes, strict=True):
        off = (place + size / 2) % size - size / 2
        found = np.maximum(found, np.exp(-((off / _BANK_WIDTH) ** 2)))
    return found


def _turned(x: Floats, y: Floats, turn: float) -> tuple[Floats, Floats]:
    return np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x


def _smooth_step(t: Floats) -> Floats:
    """Return 0 up to 0, 1 from 1 on, and without a corner between."""
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)
