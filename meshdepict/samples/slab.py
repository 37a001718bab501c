"""A closed slab with rounded corners and edges: the body of tablets and coins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.icosahedron import icosphere

__all__ = ["slab"]

Floats = NDArray[np.float64]


def slab(
    vertices: int, half: tuple[float, float, float], *, corner: float, edge: float
) -> tuple[Floats, NDArray[np.int64], Floats]:
    """Return a superellipsoid of about so many vertices, wound outwards.

    A sphere's points, drawn out until ((|x/a|^c + |y/b|^c)^(e/c) + |z/h|^e) = 1: triangles on the
    two faces stay nearly alike.

    Parameters
    ----------
    vertices : int
        See `meshdepict.samples.sphere` for how near.
    half : (float, float, float)
        a, b and h, half the lengths along x, y and z.
    corner : float
        c, how square the outline is; 2 is round.
    edge : float
        e, how sharp the edges between faces and sides are; 2 is a pillow.

    Returns
    -------
    points : (n, 3) array
    faces : (m, 3) array
    face_share : (n,) array
        How much a point belongs to a face: 1 on the front, −1 on the back, between on the sides.
    """
    directions, faces = icosphere(vertices)
    x, y, z = np.abs(directions).T
    across = (x**corner + y**corner) ** (1 / corner)
    reach = (across**edge + z**edge) ** (-1 / edge)
    points = directions * reach[:, None] * np.array(half)
    return points, faces, np.sign(directions[:, 2]) * (z * reach)
