"""Which axis points up: named views, panoramas and turntables all stand upright by it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["UPS", "upright"]

_TURNS = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),  # the front is seen from −y
    # Standing on the head: half a turn about the line of sight of the front.
    "-y": ((-1, 0, 0), (0, -1, 0), (0, 0, 1)),
    "-z": ((-1, 0, 0), (0, 0, -1), (0, -1, 0)),
    # Lying on a side: a quarter turn about the same line.
    "x": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "-x": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
}
UPS = tuple(_TURNS)
"""Axes that can point up."""


def upright(up: object) -> NDArray[np.float64]:
    """Return the rotation (3, 3) that takes a frame whose y is up into the world.

    Raises
    ------
    MeshdepictError
        For anything but y, z and x, and their negatives.
    """
    if not isinstance(up, str) or up not in _TURNS:
        raise MeshdepictError(f"up={up!r} is not one of {', '.join(UPS)}")
    return np.array(_TURNS[up], np.float64)
