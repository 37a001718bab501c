"""Frames that tangent-space normal maps refer to, after MikkTSpace (Mikkelsen 2008)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["corner_tangents"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def corner_tangents(
    points: Floats, faces: Ints, normals: Floats, texcoords: Floats
) -> tuple[Floats, Floats]:
    """Return where texture coordinates grow along u, at the corners of triangles.

    A face's direction, laid into the plane of the corner's normal, and averaged by the angle there
    over the faces that share vertex, coordinates and handedness. The third axis of a frame is
    sign · normal × tangent, which looks along v.

    Parameters
    ----------
    points, normals : (n, 3) array
    faces : (m, 3) array of int
    texcoords : (m, 3, 2) array

    Returns
    -------
    tangents : (m, 3, 3) array
        Unit.
    signs : (m,) array
        −1 where the chart is mirrored.
    """
    a, b, c = (points[corner] for corner in faces.T)
    du, dv = np.moveaxis(texcoords[:, 1:] - texcoords[:, :1], 2, 0)
    double = du[:, 0] * dv[:, 1] - du[:, 1] * dv[:, 0]
    signs = np.where(double < 0, -1.0, 1.0)
    along = signs[:, None] * ((b - a) * dv[:, 1:] - (c - a) * dv[:, :1])
    corners = np.stack([a, b, c], axis=1)
    at = normals[faces]
    tangents = np.empty_like(at)
    for corner in range(3):
        normal = at[:, corner]
        here = corners[:, corner]
        sides = [corners[:, (corner + k) % 3] - here for k in (1, 2)]
        one, other = (_unit(_flattened(side, normal)) for side in sides)
        angle = np.arccos(np.clip((one * other).sum(axis=1), -1, 1))
        tangents[:, corner] = _unit(_flattened(along, normal)) * angle[:, None]
    key = np.column_stack([faces.reshape(-1), texcoords.reshape(-1, 2), np.repeat(signs, 3)])
    _, group = np.unique(key, axis=0, return_inverse=True)
    group = group.reshape(-1)
    rows = tangents.reshape(-1, 3)
    totals: Floats = np.stack([np.bincount(group, row) for row in rows.T], axis=1)
    sums = _unit(totals[group])
    lost = (sums == 0).all(axis=1)
    if lost.any():  # no area in the atlas: any direction does
        normal = at.reshape(-1, 3)[lost]
        sums[lost] = _unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)]))
    return sums.reshape(tangents.shape), signs


def _flattened(vectors: Floats, normals: Floats) -> Floats:
    """Return vectors without their parts along normals."""
    return vectors - (vectors * normals).sum(axis=1, keepdims=True) * normals


def _unit(vectors: Floats) -> Floats:
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    vectors = vectors / np.where(largest > 0, largest, 1)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)
