"""The body of an OFF BINARY file."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.surface.polygons import Polygons

__all__ = ["read_binary"]


def read_binary(data: bytes) -> tuple[NDArray[Any], Polygons]:
    """Read counts, float points, and per face its number of corners and the corners.

    Geomview's are big-endian and have the number of colour components after the corners, other
    programs' are little-endian without: the length of the file tells.
    """
    for order in "<>":
        words = np.frombuffer(data, order + "i4", len(data) // 4)
        if len(words) < 3:
            break
        points, faces = int(words[0]), int(words[1])
        first = 3 + 3 * points
        if points < 0 or faces < 0 or first + faces > len(words):
            continue
        for colored in (False, True):
            polygons = _binary_faces(words[first:], faces, colored=colored)
            if polygons:
                vertices = words[3:first].view(order + "f4").reshape(-1, 3)
                return vertices, polygons
    raise MeshdepictError("is cut off or wrong as OFF BINARY: its length doesn't fit its counts")


def _binary_faces(words: NDArray[np.int32], count: int, *, colored: bool) -> Polygons | None:
    """Return the faces if they fill the words exactly."""
    listed = words.tolist()
    starts: list[int] = []
    sizes: list[int] = []
    at = 0
    for _ in range(count):
        if at >= len(listed) or listed[at] < 0:
            return None
        starts.append(at + 1)
        sizes.append(listed[at])
        at += 1 + listed[at]
        if colored:
            if at >= len(listed) or listed[at] < 0:
                return None
            at += 1 + listed[at]
    if at != len(listed):
        return None
    offsets = np.concatenate(([0], np.cumsum(sizes, dtype=np.int64)))
    corner = np.arange(offsets[-1]) + np.repeat(np.array(starts, np.int64) - offsets[:-1], sizes)
    return Polygons(words[corner].astype(np.int64), offsets)
