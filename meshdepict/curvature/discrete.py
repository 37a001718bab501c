"""Curvature from positions alone: mean-curvature normals and angle defects (Meyer et al. 2002).

Independent of everything that the other estimators rest on (normals, fits), hence their check.
"""

from __future__ import annotations

from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.frames import tangents
from meshdepict.curvature.welded import Welded

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["angle_defects", "discrete_curvatures", "mean_curvature_normals"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Below this height, as a share of its sides, a triangle's cotangents are rounding.
_FLAT = 1e-7


def angle_defects(mesh: Mesh) -> Floats:
    """Return what the angles round each vertex lack of 2π, of π on a border: (n,) radians.

    They add up to 2π times the Euler characteristic (Gauss–Bonnet). Vertices at one position
    share theirs evenly, as they share their area; one without faces has none.
    """
    surface = Welded(mesh)
    return surface.spread(_defects(surface) / surface.crowd)


def mean_curvature_normals(mesh: Mesh) -> Floats:
    """Return 2 H n at every vertex (n, 3) in 1/length, outward where the surface is convex.

    Borders have some too, but theirs is the border's own.
    """
    surface = Welded(mesh)
    return surface.spread(_per_area(_cotangent_sums(surface), surface)) / (mesh.diagonal or 1.0)


def discrete_curvatures(mesh: Mesh) -> tuple[Floats, Floats, Floats, Floats]:
    """Return k1, k2, d1, d2 from the mean and the Gaussian curvature of Meyer et al., §3.5.

    On a border, where both measure the border's bending, a vertex takes the mean of its inner
    neighbours' values. H² < K, which only the discretisation allows, is taken as an umbilic. The
    estimator knows no directions: d1, d2 are any tangent frame.
    """
    surface = Welded(mesh)
    normals = surface.gathered(mesh.normals)
    doubled = _per_area(_cotangent_sums(surface), surface)
    mean = np.einsum("ij,ij->i", doubled, normals) / 2
    gaussian = _per_area(_defects(surface), surface)
    mean, gaussian = _filled(np.stack([mean, gaussian]), surface)
    root = np.sqrt(np.maximum(mean * mean - gaussian, 0))
    larger = np.copysign(root, mean)
    unit = mesh.diagonal or 1.0
    d1 = tangents(normals)
    parts = ((mean + larger) / unit, (mean - larger) / unit, d1, np.cross(normals, d1))
    k1, k2, d1, d2 = (surface.spread(part) for part in parts)
    return k1, k2, d1, d2


def _cotangent_sums(surface: Welded) -> Floats:
    """Σ_j (cot α_ij + cot β_ij)(x_i − x_j) / 2 at every vertex i: 2 H n times its area."""
    total = np.zeros_like(surface.points)
    corners = surface.points[surface.faces]
    for at in range(3):
        # The cotangent at one corner belongs to the edge between the other two.
        b, c = (at + 1) % 3, (at + 2) % 3
        p, q = corners[:, b] - corners[:, at], corners[:, c] - corners[:, at]
        double, dot = _sine_and_cosine(p, q)
        squares = (p * p + q * q).sum(axis=1)
        proper = double > _FLAT * squares
        pull = (dot / np.where(proper, double, np.inf))[:, None] * (p - q) / 2
        for axis in range(3):
            for corner, sign in ((b, 1), (c, -1)):
                total[:, axis] += np.bincount(
                    surface.faces[:, corner], sign * pull[:, axis], minlength=len(total)
                )
    return total


def _defects(surface: Welded) -> Floats:
    proper = surface.proper_faces
    angles = np.zeros(len(surface.points))
    corners = surface.points[proper]
    for at in range(3):
        p, q = (corners[:, (at + k) % 3] - corners[:, at] for k in (1, 2))
        angle = np.arctan2(*_sine_and_cosine(p, q))
        angles += np.bincount(proper[:, at], angle, minlength=len(angles))
    full = np.zeros(len(angles))
    full[proper] = 2 * np.pi
    full[surface.border] = np.pi
    return full - angles


def _sine_and_cosine(p: Floats, q: Floats) -> tuple[Floats, Floats]:
    """Return ‖p × q‖ and p·q."""
    return np.linalg.norm(np.cross(p, q), axis=1), np.einsum("ij,ij->i", p, q)


def _per_area(sums: Floats, surface: Welded) -> Floats:
    """Divide sums by the vertices' areas; zero where there is none."""
    area = surface.areas.reshape(-1, *[1] * (sums.ndim - 1))
    some = area > 0
    return np.where(some, sums / np.where(some, area, 1.0), 0.0)


def _filled(values: Floats, surface: Welded) -> Floats:
    """Give border vertices the mean of their inner neighbours' values, zero where none is inner."""
    border = surface.border
    if not border.any():
        return values
    count, total = np.zeros(len(border)), np.zeros_like(values)
    for i, j in permutations(range(3), 2):
        outer, inner = surface.proper_faces[:, i], surface.proper_faces[:, j]
        wanted = border[outer] & ~border[inner]
        outer, inner = outer[wanted], inner[wanted]
        count += np.bincount(outer, minlength=len(border))
        for row, value in zip(total, values, strict=True):
            row += np.bincount(outer, value[inner], minlength=len(border))
    return np.where(border, total / np.maximum(count, 1), values)
