"""Values between the vertices of a mesh: interpolated over triangles as graphics cards do it."""

from __future__ import annotations

import numpy as np

from meshdepict.threads import kernel

__all__ = ["bends_between", "unit_between"]

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


@kernel("contracted")
def bends_between(k1, k2, d1, d2, corners, weights, a, b, out, begin, end):  # type: ignore[no-untyped-def]
    """Interpolate shape operators; take their parts in tangent planes.

    Parameters
    ----------
    k1, k2 : (v,) array
        Principal curvatures of the vertices.
    d1, d2 : (v, 3) array
        Their directions.
    corners, weights : (n, 3) arrays
        Vertices and barycentric coordinates.
    a, b : (n, 3) array
        Axes of the samples' tangent planes.
    out : (3, n) array
        The numbers aa, ab and bb of each; filled in from sample ``begin`` to before ``end``.
    """
    for i in range(begin, end):
        aa = ab = bb = 0.0
        for corner in range(3):
            vertex = corners[i, corner]
            for which in range(2):
                k = k1[vertex] if which == 0 else k2[vertex]
                along = across = 0.0
                for axis in range(3):
                    direction = d1[vertex, axis] if which == 0 else d2[vertex, axis]
                    along += direction * a[i, axis]
                    across += direction * b[i, axis]
                bend = weights[i, corner] * k
                aa += bend * along * along
                ab += bend * along * across
                bb += bend * across * across
        out[0, i], out[1, i], out[2, i] = aa, ab, bb
