"""Square sheets, normals up: waves, and the ridges of Exaggerated Shading's third figure."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.options import Range
from meshdepict.samples.arguments import LENGTH, MOST, checked
from meshdepict.shapes.mesh import Mesh

__all__ = ["grid_faces", "radiating_ridges", "ridge_height", "square", "wavy_sheet"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def wavy_sheet(
    vertices: Annotated[int, Range(4, MOST)] = 10_000,
    *,
    size: Annotated[float, LENGTH] = 2.0,
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
    vertices, size, amplitude, waves = checked(
        wavy_sheet, vertices=vertices, size=size, amplitude=amplitude, waves=waves
    )
    x, y, faces = square(vertices, size / 2)
    return Mesh(np.stack((x, y, amplitude * np.sin(2 * np.pi * waves * (x / size))), axis=1), faces)


def radiating_ridges(
    vertices: Annotated[int, Range(4, MOST)] = 40_000,
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
    vertices, ridges, hill, relief = checked(
        radiating_ridges, vertices=vertices, ridges=ridges, hill=hill, relief=relief
    )
    x, y, faces = square(vertices, 1.0)
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


def grid_faces(numbers: Ints) -> Ints:
    """Two triangles per cell of an (a, b) grid of vertex numbers, first axis × second outwards."""
    corner, right = numbers[:-1, :-1], numbers[1:, :-1]
    across, up = numbers[1:, 1:], numbers[:-1, 1:]
    return np.stack((corner, right, across, corner, across, up), axis=-1).reshape(-1, 3)


def square(vertices: int, half: float) -> tuple[Floats, Floats, Ints]:
    """Grid x, y over [−half, half]² and its faces."""
    side = max(2, round(vertices**0.5))
    along = np.linspace(-half, half, side)
    faces = grid_faces(np.arange(side * side).reshape(side, side))
    return np.repeat(along, side), np.tile(along, side), faces
