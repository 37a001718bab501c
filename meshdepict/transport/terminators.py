"""Where rays from within a triangle start, so that it hides no light that its normals show.

Normals interpolated between the vertices pretend a curved surface, and the triangle lies below it:
rays that leave there towards a low light meet the neighbours, and whole triangles turn black where
shading says that the light arrives. So they start on the surface that the normals pretend.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.transport.rays import OFFSET, ray_scene, started

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["lifts_to_patches", "smooth_starts"]

Floats = NDArray[np.float64]

# Least cosine between a triangle and its vertices' normals that are a curved surface's: more than
# an icosahedron's 0.79, less than the 0.71 where two planes meet at a right angle, whose mean says
# nothing of what is between.
_CURVED = 0.75


def lifts_to_patches(
    points: Floats,
    normals: NDArray[Any],
    corners: NDArray[Any],
    weights: NDArray[Any],
    *,
    turned: NDArray[np.bool_] | bool = False,
) -> Floats:
    """Return how far (n, 3) the surface that normals pretend lies above places in triangles.

    A place is projected onto the planes through its triangle's vertices at right angles to their
    normals, where it lies below these, and the three are interpolated: Hanika, Hacking the shadow
    terminator, Ray Tracing Gems II, 2021. Along hollows, and where normals are far from the
    triangle's, nothing is lifted.

    Parameters
    ----------
    points, normals : (v, 3) arrays
        Of the vertices.
    corners, weights : (n, 3) arrays
        Of the places: vertices and barycentric coordinates.
    turned : bool or (n,) array
        Whether the other side is meant.
    """
    at, up = points[corners], np.asarray(normals[corners], np.float64)
    facet = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    facet /= np.maximum(np.linalg.norm(facet, axis=1, keepdims=True), np.finfo(float).tiny)
    cosines = np.einsum("nci,ni->nc", up, facet)  # all below 0 where a file winds the other way
    curved = np.maximum(cosines.min(axis=1), -cosines.max(axis=1)) > _CURVED
    share = np.asarray(weights, np.float64)
    place = np.einsum("nc,nci->ni", share, at)
    above = np.einsum("nci,nci->nc", place[:, None] - at, up)
    above = np.where(np.asarray(turned)[..., None], np.maximum(above, 0), np.minimum(above, 0))
    lifts = -np.einsum("nc,nc,nci->ni", share, above, up)
    return np.where(curved[:, None], lifts, 0.0)


def smooth_starts(
    mesh: Mesh,
    points: Floats,
    lifts: Floats,
) -> Floats:
    """Return where rays from points (n, 3) start: lifted, unless something is in between.

    What stands on a surface keeps its shadow there.

    Parameters
    ----------
    mesh : Mesh
        What rays can meet.
    points, lifts : (n, 3) arrays
        World positions, and how far these are lifted.
    """
    lifted = points + lifts
    starts, goals = mesh.recentred(points), mesh.recentred(lifted)
    away = goals - starts
    length = np.linalg.norm(away, axis=1)
    far = np.flatnonzero(length > 2 * OFFSET)
    if len(far):
        along = away[far] / length[far, None]
        met = ray_scene(mesh).run(
            started(starts[far], along), along.astype(np.float32), query="OCCLUDED",
            dists=length[far].astype(np.float32),
        )  # fmt: skip
        kept = far[met >= 0]
        lifted[kept] = points[kept]
    return lifted
