"""Accessibility (Miller, SIGGRAPH 1994): how large a ball can touch the surface."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["accessibility", "accessible_radii"]

Floats = NDArray[np.float64]

# A ball shrinks by more than this at a step, or it has the final size: rounding of squares.
_SHRINKS = 1e-9
_APART = 1e-5  # diagonals: nearer points are one, as where gaps are closed


def accessible_radii(points: Floats, normals: NDArray[Any], cap: float) -> Floats:
    """Return the radius of the largest ball that touches each point from outside.

    The ball at x_i with its centre on the normal holds no other point:
    ``r_i = min over x_j with n·d > 0 of ‖d‖² / (2 n·d)``, d = x_j − x_i, at most the cap. Found
    exactly: the point nearest to the centre of a ball that is too large gives the next, smaller
    ball, until none is nearer than the surface point itself.

    Parameters
    ----------
    points, normals : (n, 3) array
        Unit normals.
    cap : float
        Largest radius, > 0, in the units of the points.

    Returns
    -------
    (n,) array
    """
    from scipy.spatial import KDTree

    from meshdepict.surface.welding import same_position
    from meshdepict.threads import thread_count

    # A tree of points at one place would ask each of them about all others.
    label = same_position(points)
    places = points if label is None else points[np.unique(label, return_index=True)[1]]
    tree = KDTree(places)
    radii = np.full(len(points), float(cap))
    moving = np.arange(len(points))
    while len(moving):
        centre = points[moving] + radii[moving, None] * normals[moving]
        _, nearest = tree.query(centre, workers=thread_count())
        d = places[nearest] - points[moving]
        above = np.einsum("ij,ij->i", normals[moving], d)
        squared = np.einsum("ij,ij->i", d, d)
        # Of several points at one place, as along seams, none is in another's way.
        apart = squared > _APART**2
        smaller = apart & (squared < (1 - _SHRINKS) * 2 * radii[moving] * above)
        moving = moving[smaller]
        radii[moving] = squared[smaller] / (2 * above[smaller])
    return radii


@method(local=False, lights="none", ground="paper", source="Accessibility (Miller 1994)")
def accessibility(
    space: ScaleSpace,
    light: object,
    *,
    cap: Annotated[
        float,
        Range(1e-6, 10, help="radius shaded white, in diagonals of the object", soft=(0.005, 0.2)),
    ] = 0.05,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by the size of the largest ball that can touch a point: pits and cracks are dark."""
    del light
    radii = accessible_radii(space.unit_points, space.normals_at(0), cap)
    return exposed((radii / cap).astype(np.float32), exposure)
