"""Procedural shapes for demonstrations, tests and benchmarks: the same bits every time.

Every function takes the wanted number of vertices and returns the mesh whose own count is the
nearest that its layout has (each docstring says how near). All windings point outwards or up.
`ct_phantom` is a volume, `terrain` a height field; `tablet` has a texture.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range, check
from meshdepict.shapes.landscape import terrain, terrain_height
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.phantom import ct_phantom
from meshdepict.shapes.tablet import tablet
from meshdepict.surface.icosahedron import icosphere, lattice_points

__all__ = [
    "ct_phantom", "golf_ball", "radiating_ridges", "ridge_height", "sphere", "tablet",
    "terrain", "terrain_height", "torus", "wavy_sheet",
]  # fmt: skip

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_MOST = 100_000_000  # vertices; more would outgrow any memory they could be shaded in
_LENGTH = Range(1e-100, 1e100)

# A dimple's rim is rounded where its depth, as a share of the middle's, would be within ± _FILLET
# (about one edge of the default ball), and ends at _REACH of half the way to the nearest neighbour.
_FILLET = 0.25
_REACH = 0.99


def golf_ball(
    vertices: Annotated[int, Range(12, _MOST)] = 40_000,
    *,
    dimples: Annotated[int, Range(12, 100_000, help="10 (h² + hk + k²) + 2")] = 392,
    depth: Annotated[float, Range(0, 0.1, unit="radii")] = 0.012,
    radius: Annotated[float, _LENGTH] = 1.0,
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
    vertices, dimples, depth, radius = _checked(
        golf_ball, vertices=vertices, dimples=dimples, depth=depth, radius=radius
    )
    try:
        centres = lattice_points(dimples)
    except MeshdepictError as error:
        raise MeshdepictError(f"golf_ball: dimples={dimples}: {error}") from None
    points, faces = icosphere(vertices)
    points *= radius * (1 - depth * _pressed(points, centres))[:, None]
    return Mesh(points, faces)


def sphere(
    vertices: Annotated[int, Range(12, _MOST)] = 10_000, *, radius: Annotated[float, _LENGTH] = 1.0
) -> Mesh:
    """Return a sphere about the origin of nearly equal triangles.

    A subdivided icosahedron: 10 f² + 2 vertices with f whole, so the count lies within
    3.2 √vertices of the wanted one, and is exact for 12, 42, 92, 162, ….

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, radius = _checked(sphere, vertices=vertices, radius=radius)
    points, faces = icosphere(vertices)
    return Mesh(points * radius, faces)


def torus(
    vertices: Annotated[int, Range(9, _MOST)] = 10_000,
    *,
    major: Annotated[float, _LENGTH] = 1.0,
    minor: Annotated[float, _LENGTH] = 0.4,
) -> Mesh:
    """Return a torus round the z axis: a tube of radius `minor` along a circle of radius `major`.

    A closed grid of a × b vertices, its cells about square on the average. With a wanted count of
    at least 9 major/minor, the count lies within half of the vertices round the tube, √(vertices ·
    minor/major), of the wanted one.

    Raises
    ------
    MeshdepictError
        For an argument out of its range, or a tube thicker than its circle.
    """
    vertices, major, minor = _checked(torus, vertices=vertices, major=major, minor=minor)
    if minor >= major:
        raise MeshdepictError(f"torus: minor={minor!r} must be smaller than major={major!r}")
    tube = max(3, round((vertices * minor / major) ** 0.5))
    axis = max(3, round(vertices / tube))
    u = np.repeat(np.arange(axis) * (2 * np.pi / axis), tube)
    v = np.tile(np.arange(tube) * (2 * np.pi / tube), axis)
    ring = major + minor * np.cos(v)
    points = np.stack((ring * np.cos(u), ring * np.sin(u), minor * np.sin(v)), axis=1)
    numbers = np.arange(axis * tube).reshape(axis, tube)
    return Mesh(points, _grid_faces(np.pad(numbers, (0, 1), mode="wrap")))


def wavy_sheet(
    vertices: Annotated[int, Range(4, _MOST)] = 10_000,
    *,
    size: Annotated[float, _LENGTH] = 2.0,
    amplitude: Annotated[float, Range(0, 1e100)] = 0.05,
    waves: Annotated[float, Range(0, 10_000)] = 4.0,
) -> Mesh:
    """Return the square sheet z = amplitude · sin(2π · waves · x / size), normals up.

    ``amplitude=0`` is a plane. The count is as near as with `radiating_ridges`.

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, size, amplitude, waves = _checked(
        wavy_sheet, vertices=vertices, size=size, amplitude=amplitude, waves=waves
    )
    x, y, faces = _square(vertices, size / 2)
    return Mesh(np.stack((x, y, amplitude * np.sin(2 * np.pi * waves * (x / size))), axis=1), faces)


def radiating_ridges(
    vertices: Annotated[int, Range(4, _MOST)] = 40_000,
    *,
    ridges: Annotated[int, Range(0, 1000)] = 24,
    hill: Annotated[float, Range(0, 10)] = 0.35,
    relief: Annotated[float, Range(0, 1)] = 0.04,
) -> Mesh:
    """Return the height field of ES fig. 3 as a sheet: ridges radiating from a central hill.

    Parameters
    ----------
    vertices : int
        About how many; the sheet has a square number, within √vertices + 1 of the wanted one.
    ridges, hill, relief
        See `ridge_height`, which gives z over the square −1 ≤ x, y ≤ 1.

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, ridges, hill, relief = _checked(
        radiating_ridges, vertices=vertices, ridges=ridges, hill=hill, relief=relief
    )
    x, y, faces = _square(vertices, 1.0)
    z = ridge_height(x, y, ridges=ridges, hill=hill, relief=relief)
    return Mesh(np.stack((x, y, z), axis=1), faces)


def ridge_height(
    x: ArrayLike, y: ArrayLike, *, ridges: int = 24, hill: float = 0.35, relief: float = 0.04
) -> Floats:
    """Return the height of a hill with ridges radiating from it, at (x, y) in [−1, 1]².

    Parameters
    ----------
    x, y : array_like
        Place east and north of the hill's top.
    ridges : int
        How many, evenly spaced in azimuth; one runs east.
    hill : float
        Height of the hill, a Gaussian of width 0.3.
    relief : float
        Height of a full-grown ridge above the valleys beside it. Ridges begin on the hill, where
        there is room for them, and are full grown at a distance of 0.4.
    """
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    distance = np.hypot(x, y)
    grown = np.clip((distance - 0.05) / 0.35, 0, 1)
    grown = grown * grown * (3 - 2 * grown)
    crest = 0.5 + 0.5 * np.cos(ridges * np.arctan2(y, x))
    return hill * np.exp(-0.5 * (distance / 0.3) ** 2) + relief * grown * crest


def _checked(function: Callable[..., Mesh], **given: Any) -> Iterable[Any]:
    return check(function, given, function.__name__).values()


# --- grids ----------------------------------------------------------------------------------


def _grid_faces(numbers: Ints) -> Ints:
    """Two triangles per cell of an (a, b) grid of vertex numbers, first axis × second outwards."""
    corner, right = numbers[:-1, :-1], numbers[1:, :-1]
    across, up = numbers[1:, 1:], numbers[:-1, 1:]
    return np.stack((corner, right, across, corner, across, up), axis=-1).reshape(-1, 3)


def _square(vertices: int, half: float) -> tuple[Floats, Floats, Ints]:
    """Grid x, y over [−half, half]² and its faces."""
    side = max(2, round(vertices**0.5))
    along = np.linspace(-half, half, side)
    faces = _grid_faces(np.arange(side * side).reshape(side, side))
    return np.repeat(along, side), np.tile(along, side), faces


# --- dimples --------------------------------------------------------------------------------


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
