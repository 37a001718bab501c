"""Shapes whose curvature is known at every point: a sphere, a torus."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range
from meshdepict.samples.arguments import LENGTH, MOST, checked
from meshdepict.samples.sheets import grid_faces
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.icosahedron import icosphere

__all__ = ["sphere", "torus"]


def sphere(
    vertices: Annotated[int, Range(12, MOST)] = 10_000, *, radius: Annotated[float, LENGTH] = 1.0
) -> Mesh:
    """Return a sphere about the origin of nearly equal triangles.

    A subdivided icosahedron: 10 f² + 2 vertices with f whole, so the count lies within
    3.2 √vertices of the wanted one, and is exact for 12, 42, 92, 162, ….

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    vertices, radius = checked(sphere, vertices=vertices, radius=radius)
    points, faces = icosphere(vertices)
    return Mesh(points * radius, faces)


def torus(
    vertices: Annotated[int, Range(9, MOST)] = 10_000,
    *,
    major: Annotated[float, LENGTH] = 1.0,
    minor: Annotated[float, LENGTH] = 0.4,
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
    vertices, major, minor = checked(torus, vertices=vertices, major=major, minor=minor)
    if minor >= major:
        raise MeshdepictError(f"torus: minor={minor!r} must be smaller than major={major!r}")
    tube = max(3, round((vertices * minor / major) ** 0.5))
    axis = max(3, round(vertices / tube))
    u = np.repeat(np.arange(axis) * (2 * np.pi / axis), tube)
    v = np.tile(np.arange(tube) * (2 * np.pi / tube), axis)
    ring = major + minor * np.cos(v)
    points = np.stack((ring * np.cos(u), ring * np.sin(u), minor * np.sin(v)), axis=1)
    numbers = np.arange(axis * tube).reshape(axis, tube)
    return Mesh(points, grid_faces(np.pad(numbers, (0, 1), mode="wrap")))
