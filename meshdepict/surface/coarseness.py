"""How much of a surface is triangles too large for the normals at their corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["coarse_share"]

_LONG = 3  # median edges: decimated scans, whose triangles are alike, have none so long
_TILTED = np.radians(30)  # from the triangle's normal to that of a corner


def coarse_share(
    points: NDArray[np.float64],
    faces: NDArray[np.int64],
    normals: NDArray[np.float64],
    *,
    edge: float,
) -> float:
    """Return the share of the area in large triangles whose corners have quite other normals.

    What is interpolated between these says more about the triangulation than about the surface.

    Parameters
    ----------
    points : (n, 3) array
    faces : (m, 3) array
        Outward.
    normals : (n, 3) array
        Unit, of the vertices.
    edge : float
        The median length of an edge.
    """
    corners = points[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    cross = np.cross(sides[:, 0], sides[:, 1])
    area = np.linalg.norm(cross, axis=1)
    least = np.einsum("mi,mci->mc", cross, normals[faces]).min(axis=1)
    long = (np.einsum("msi,msi->ms", sides, sides) > (_LONG * edge) ** 2).any(axis=1)
    coarse = long & (least < np.cos(_TILTED) * area)
    return float(area[coarse].sum() / (area.sum() or 1.0))
