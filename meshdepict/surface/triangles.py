"""Geometry of triangle soups on plain arrays: vertex normals, mixed Voronoi areas, edge lengths.

``points`` are ``(n, 3)`` float64, ``faces`` ``(m, 3)`` integers. Degenerate triangles contribute
zero everywhere, never NaN. The work goes through the faces in blocks, so that the temporaries of
a scan with millions of faces stay small.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["edge_lengths", "enclosed_volume", "mixed_voronoi_areas", "normal_sums"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_BLOCK = 1 << 18  # faces at a time: about 40 MB of temporaries


def normal_sums(points: Floats, faces: Ints) -> Floats:
    """Sum the faces' normals at every vertex with Max's weights.

    A corner with edge vectors e, f adds e × f / (‖e‖²‖f‖²), which is exact on a sphere
    (N. Max, *Weights for Computing Vertex Normals from Facet Normals*, JGT 4(2), 1999).

    Returns
    -------
    (n, 3) array
        Not normalised; zero where no proper face meets the vertex.
    """
    total = np.zeros((len(points), 3))
    for block in _blocks(faces):
        sides, squared = _sides(points, block)
        cross = np.cross(sides[0], sides[1])
        for corner in range(3):
            weight = _quotient(1.0, squared[corner] * squared[corner - 1])
            for axis in range(3):
                total[:, axis] += np.bincount(
                    block[:, corner], weight * cross[:, axis], minlength=len(points)
                )
    return total


def mixed_voronoi_areas(points: Floats, faces: Ints) -> Floats:
    """Each vertex's share of the surface, after Meyer et al. 2002, §3.3.

    In a non-obtuse triangle corner a owns its Voronoi region (‖ab‖² cot C + ‖ac‖² cot B) / 8; in
    an obtuse one the obtuse corner owns half, the others a quarter each.

    Returns
    -------
    (n,) array
        Sums to the area of the surface.
    """
    total = np.zeros(len(points))
    for block in _blocks(faces):
        sides, squared = _sides(points, block)
        double_area = np.linalg.norm(np.cross(sides[0], sides[1]), axis=1)
        # The dot product of the two edges leaving a corner: its angle is obtuse where negative.
        dots = [-np.einsum("ij,ij->i", sides[c], sides[c - 1]) for c in range(3)]
        obtuse = np.minimum(np.minimum(dots[0], dots[1]), dots[2]) < 0
        for corner in range(3):
            before, after = (corner + 2) % 3, (corner + 1) % 3
            # sides[corner] runs to `after`, whose opposite angle sits at `before`.
            voronoi = _quotient(
                squared[corner] * dots[before] + squared[before] * dots[after], 8 * double_area
            )
            share = np.where(dots[corner] < 0, 0.25, 0.125) * double_area
            own = np.where(obtuse, share, voronoi)
            total += np.bincount(block[:, corner], own, minlength=len(points))
    return total


def edge_lengths(points: Floats, faces: Ints) -> Floats:
    """Length of every edge, each edge once, in no particular order."""
    n = len(points)
    keys = np.empty((3, len(faces)), np.int64)
    for corner in range(3):
        a, b = faces[:, corner], faces[:, (corner + 1) % 3]
        keys[corner] = np.minimum(a, b) * n + np.maximum(a, b)
    unique = keys.reshape(-1)
    unique.sort()
    unique = unique[np.concatenate(([True], unique[1:] != unique[:-1]))]
    lengths = np.empty(len(unique))
    for start in range(0, len(unique), _BLOCK):
        part = unique[start : start + _BLOCK]
        lengths[start : start + _BLOCK] = np.linalg.norm(
            points[part // n] - points[part % n], axis=1
        )
    return lengths


def enclosed_volume(points: Floats, faces: Ints) -> float:
    """Signed volume by the divergence theorem; positive where closed and wound outwards."""
    volume = 0.0
    for block in _blocks(faces):
        a, b, c = (points[block[:, corner]] for corner in range(3))
        volume += float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
    return volume


def _blocks(faces: Ints) -> Iterator[Ints]:
    for start in range(0, len(faces), _BLOCK):
        yield faces[start : start + _BLOCK]


def _sides(points: Floats, faces: Ints) -> tuple[list[Floats], list[Floats]]:
    """Side vectors of the triangles, side c from corner c to c + 1, and their squared lengths."""
    corners = [points[faces[:, corner]] for corner in range(3)]
    sides = [corners[(corner + 1) % 3] - corners[corner] for corner in range(3)]
    return sides, [np.einsum("ij,ij->i", side, side) for side in sides]


def _quotient(top: Floats | float, bottom: Floats) -> Floats:
    """Divide, zero where the denominator is zero (or so small that the quotient overflows)."""
    proper = bottom > 1e-290
    return np.where(proper, top / np.where(proper, bottom, 1.0), 0.0)
