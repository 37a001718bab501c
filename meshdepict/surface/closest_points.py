"""Points of a surface that are closest to others: among the triangles round the nearest vertex."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.welding import same_position
from meshdepict.threads import kernel, thread_count

__all__ = ["ClosestPoints"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class ClosestPoints:
    """What finds, for places near a surface, the point of it that is closest.

    Parameters
    ----------
    points : (n, 3) array
    faces : (m, 3) array of int
    """

    def __init__(self, points: Floats, faces: Ints) -> None:
        from scipy.spatial import KDTree

        self._points, self._faces = points, faces
        # Vertices at one place, as along seams, are one: triangles of all of them are round it.
        label = same_position(points)
        one = faces if label is None else label[faces]
        self._used, first = np.unique(one, return_index=True)
        self._tree: Any = KDTree(points[faces.reshape(-1)[first]])
        flat = one.reshape(-1)
        order = np.argsort(flat, kind="stable")
        self._around = (order // 3).astype(np.int64)
        self._begin = np.searchsorted(flat[order], np.arange(len(points) + 1)).astype(np.int64)

    def at(self, places: Floats) -> tuple[NDArray[np.int32], Floats]:
        """Return triangles (n,) and barycentric coordinates (n, 3) of the closest points."""
        _, nearest = self._tree.query(places, workers=thread_count())
        vertex = self._used[nearest]
        triangle = np.empty(len(places), np.int32)
        weights = np.empty((len(places), 3))
        _closest(
            self._points, self._faces, self._begin, self._around, vertex,
            np.ascontiguousarray(places), triangle, weights,
        )  # fmt: skip
        return triangle, weights


@kernel()
def _closest(points, faces, begin, around, vertex, places, triangle, weights):  # type: ignore[no-untyped-def]
    share = np.empty(3)
    for i in range(len(places)):
        least = np.inf
        for k in range(begin[vertex[i]], begin[vertex[i] + 1]):
            f = around[k]
            _within_triangle(
                places[i], points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]], share
            )
            squared = 0.0
            for axis in range(3):
                at = (
                    share[0] * points[faces[f, 0], axis]
                    + share[1] * points[faces[f, 1], axis]
                    + share[2] * points[faces[f, 2], axis]
                )
                squared += (at - places[i, axis]) ** 2
            if squared < least:
                least = squared
                triangle[i] = f
                weights[i] = share


@kernel()
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel()
def _within_triangle(p, a, b, c, share):  # type: ignore[no-untyped-def]
    """Fill in the barycentric coordinates of a triangle's point closest to p (Ericson 2005)."""
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = _dot(ab, ap), _dot(ac, ap)
    bp, cp = p - b, p - c
    d3, d4 = _dot(ab, bp), _dot(ac, bp)
    d5, d6 = _dot(ab, cp), _dot(ac, cp)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    share[:] = 0.0
    if d1 <= 0 and d2 <= 0:
        share[0] = 1
    elif d3 >= 0 and d4 <= d3:
        share[1] = 1
    elif d6 >= 0 and d5 <= d6:
        share[2] = 1
    elif vc <= 0 and d1 >= 0 and d3 <= 0:
        t = d1 / (d1 - d3) if d1 != d3 else 0.0
        share[0], share[1] = 1 - t, t
    elif vb <= 0 and d2 >= 0 and d6 <= 0:
        t = d2 / (d2 - d6) if d2 != d6 else 0.0
        share[0], share[2] = 1 - t, t
    elif va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        whole = (d4 - d3) + (d5 - d6)
        t = (d4 - d3) / whole if whole != 0 else 0.0
        share[1], share[2] = 1 - t, t
    else:
        whole = va + vb + vc
        share[1], share[2] = vb / whole, vc / whole
        share[0] = 1 - share[1] - share[2]
