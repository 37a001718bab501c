"""Values between the vertices of a mesh: interpolated over triangles as graphics cards do it."""

from __future__ import annotations

import numpy as np

from meshdepict.threads import kernel

__all__ = ["unit_between"]

_SHORT = 1e-12  # squared length of a mean of unit vectors that cancel


@kernel("contracted")
def unit_between(vectors, corners, weights, out, begin, end):  # type: ignore[no-untyped-def]
    """Interpolate unit vectors and make them unit again; where they cancel, the nearest corner's.

    Parameters
    ----------
    vectors : (v, 3) array
        Of the vertices.
    corners, weights : (n, 3) arrays
        Vertices and barycentric coordinates.
    out : (3, n) array
        Filled in from sample ``begin`` to before ``end``.
    """
    for i in range(begin, end):
        a, b, c = corners[i, 0], corners[i, 1], corners[i, 2]
        u, v, w = weights[i, 0], weights[i, 1], weights[i, 2]
        x = u * vectors[a, 0] + v * vectors[b, 0] + w * vectors[c, 0]
        y = u * vectors[a, 1] + v * vectors[b, 1] + w * vectors[c, 1]
        z = u * vectors[a, 2] + v * vectors[b, 2] + w * vectors[c, 2]
        squared = x * x + y * y + z * z
        if squared <= _SHORT:
            nearest = a
            if v > u or w > u:
                nearest = b if v >= w else c
            x, y, z = vectors[nearest, 0], vectors[nearest, 1], vectors[nearest, 2]
            squared = x * x + y * y + z * z
        length = np.sqrt(squared)
        out[0, i], out[1, i], out[2, i] = x / length, y / length, z / length
