"""Rounding of normals on the unfolded octahedron, compiled: the best of four steps for each."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["nearest_places"]


def nearest_places(normals: NDArray[np.float32], half: int) -> NDArray[np.float32]:
    """Return `octahedral.fold` of normals (n, 3): the place (n, 2) that turns each least.

    Parameters
    ----------
    normals : (n, 3) array of float32
    half : int
        Steps from the middle of the square to its edge.
    """
    places = np.empty((len(normals), 2), np.float32)
    pieces = thread_count() if len(normals) > 20_000 else 1
    each(lambda a, b: _fold(normals, float(half), places, a, b), spans(len(normals), pieces))
    return places


@kernel()
def _fold(normals, half, places, begin, end):  # type: ignore[no-untyped-def]
    for i in range(begin, end):
        x, y, z = float(normals[i, 0]), float(normals[i, 1]), float(normals[i, 2])
        size = max(abs(x) + abs(y) + abs(z), 1e-30)
        px, py = x / size, y / size
        if z < 0:
            px, py = math.copysign(1 - abs(py), px), math.copysign(1 - abs(px), py)
        left, lower = math.floor((px + 1) * half), math.floor((py + 1) * half)
        most = -2.0
        for a in range(2):
            for b in range(2):
                u, v = min(left + a, 2 * half), min(lower + b, 2 * half)
                cosine = _cosine(u / half - 1, v / half - 1, x, y, z)
                if cosine > most:
                    most = cosine
                    places[i, 0], places[i, 1] = u, v


@kernel(inline=True)
def _cosine(px, py, x, y, z):  # type: ignore[no-untyped-def]
    """Return the cosine between (x, y, z) and what a place stands for."""
    pz = 1 - abs(px) - abs(py)
    below = max(-pz, 0.0)
    px = px + below if px < 0 else px - below
    py = py + below if py < 0 else py - below
    return (px * x + py * y + pz * z) / math.sqrt(px * px + py * py + pz * pz)
