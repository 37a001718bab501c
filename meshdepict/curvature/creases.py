"""Creases: how far normals turn between neighbouring vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.welded import Welded
from meshdepict.threads import each, kernel, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["neighbour_cosines"]


def neighbour_cosines(mesh: Mesh, normals: NDArray[Any]) -> NDArray[np.float32]:
    """Return for each vertex the least cosine between its normal and a neighbour's: (n,), ≤ 1.

    Parameters
    ----------
    mesh : Mesh
        Vertices at one position have the neighbours of all of them.
    normals : (n, 3) array
        Unit vectors.
    """
    surface = Welded(mesh)
    unit = np.ascontiguousarray(surface.gathered(normals), np.float32)
    least = np.ones(len(unit), np.float32)
    pieces = thread_count() if len(unit) > 10_000 else 1
    # As in `tensor`: each thread owns a span of vertices.
    each(lambda a, b: _span(surface.faces, unit, a, b, least), spans(len(unit), pieces))
    return surface.spread(least)


@kernel()
def _span(faces, normals, begin, end, least):  # type: ignore[no-untyped-def]
    for f in range(len(faces)):
        for side in range(3):
            a, b = faces[f, side], faces[f, (side + 1) % 3]
            own_a, own_b = begin <= a < end, begin <= b < end
            if own_a or own_b:
                cosine = (
                    normals[a, 0] * normals[b, 0]
                    + normals[a, 1] * normals[b, 1]
                    + normals[a, 2] * normals[b, 2]
                )
                if own_a:
                    least[a] = min(least[a], cosine)
                if own_b:
                    least[b] = min(least[b], cosine)
