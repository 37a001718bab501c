"""A golf ball, the subject of the first figure of Exaggerated Shading."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range
from meshdepict.samples.arguments import LENGTH, MOST, checked
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.icosahedron import icosphere, lattice_points

__all__ = ["golf_ball"]

Floats = NDArray[np.float64]

# A dimple's rim is rounded where its depth, as a share of the middle's, would be within ± _FILLET
# (about one edge of the default ball), and ends at _REACH of half the way to the nearest neighbour.
_FILLET = 0.25
_REACH = 0.99


def golf_ball(
    vertices: Annotated[int, Range(12, MOST)] = 40_000,
    *,
    dimples: Annotated[int, Range(12, 100_000, help="10 (h² + hk + k²) + 2")] = 392,
    depth: Annotated[float, Range(0, 0.1, unit="radii")] = 0.012,
    radius: Annotated[float, LENGTH] = 1.0,
) -> Mesh:
    """Return a golf ball about the origin, the subject of ES fig. 1.

    The dimples are spherical caps with rounded rims. Their centres form an icosahedral lattice
    as on real balls: all have six neighbours but twelve, which have five. Each is as wide as its
    nearest neighbour allows.

    Parameters
    ----------
    vertices : int
        About how many; see `sphere` for how near. A dimple takes 30 to look round, so the default
        number of dimples wants 12,000.
    dimples : int
        One of 12, 32, 42, …, 252, 272, 282, 312, 362, 372, 392, 432, ….
    depth : float
        Depth of a dimple's middle, in radii. Real ones have about 0.012 (0.25 mm).
    radius : float
        Radius of the ball before the dimples are pressed in, in world units.

    Raises
    ------
    MeshdepictError
        For an argument out of its range, or a number of dimples without an icosahedral lattice.
    """
    vertices, dimples, depth, radius = checked(
        golf_ball, vertices=vertices, dimples=dimples, depth=depth, radius=radius
    )
    try:
        centres = lattice_points(dimples)
    except MeshdepictError as error:
        raise MeshdepictError(f"golf_ball: dimples={dimples}: {error}") from None
    points, faces = icosphere(vertices)
    points *= radius * (1 - depth * _pressed(points, centres))[:, None]
    return Mesh(points, faces)


def _pressed(points: Floats, centres: Floats) -> Floats:
    """How far a dimple presses each point of the unit sphere in, as a share of its depth."""
    from scipy.spatial import cKDTree

    tree = cKDTree(centres)
    rim = _REACH / 2 * np.asarray(tree.query(centres, k=2)[0])[:, 1]
    distance, nearest = tree.query(points, workers=-1)
    # Chords: 1 − (distance/radius)² over a sphere is a cap of another sphere, to 1 % of its depth.
    profile = 1 - (1 + _FILLET) * (distance / rim[nearest]) ** 2
    rounded = np.clip(profile + _FILLET, 0, 2 * _FILLET) ** 2 / (4 * _FILLET)
    return np.where(profile > _FILLET, profile, rounded)
