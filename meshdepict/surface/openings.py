"""Which parts of a surface are open, so that both of their sides are real."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected
from meshdepict.surface.edges import cleaned, is_balanced

__all__ = ["open_faces"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def open_faces(points: Floats, faces: Ints) -> NDArray[np.bool_]:
    """Tell of each face whether its component has a boundary: an edge with one face alone.

    Parameters
    ----------
    points : (n, 3) array
        Those at bit-identical positions count as one: a seam is no boundary.
    faces : (m, 3) array of int

    Returns
    -------
    (m,) array of bool
        Degenerate faces are closed: they have no side.
    """
    if is_balanced(faces, len(points)):
        return np.zeros(len(faces), bool)
    mesh = cleaned(points, faces)
    edges = mesh.edges
    shared = np.repeat(edges.count > 1, edges.count)
    first = np.repeat(edges.face[edges.start], edges.count)
    part = connected(len(mesh.faces), first[shared], edges.face[shared])
    opened = np.zeros(len(mesh.faces), bool)
    opened[part[edges.face[edges.start[edges.count == 1]]]] = True  # by component
    found = np.zeros(len(faces), bool)
    proper = mesh.place >= 0
    found[proper] = opened[part][mesh.place[proper]]
    return found
