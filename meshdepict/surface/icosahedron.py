"""The icosahedron, and the even lattices on the sphere that it gives."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["icosahedron", "icosphere", "lattice_points"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_ARC = float(np.arctan(2.0))  # angle between neighbouring corners, seen from the centre


@cache
def icosahedron() -> tuple[Floats, Ints]:
    """Return corners (12, 3) on the unit sphere and outward faces (20, 3); both read-only."""
    golden = (1 + 5**0.5) / 2
    rectangle = np.array([(s, t * golden, 0.0) for s in (1, -1) for t in (1, -1)])
    corners = np.concatenate([np.roll(rectangle, axis, axis=1) for axis in range(3)])
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    near = corners @ corners.T > 0.4  # cosine 1/√5 between neighbours, below zero between others
    triples = [t for t in combinations(range(12), 3) if near[np.ix_(t, t)].all()]
    outward = [t if np.linalg.det(corners[list(t)]) > 0 else t[::-1] for t in triples]
    faces = np.array(outward, np.int64)
    corners.setflags(write=False)
    faces.setflags(write=False)
    return corners, faces


def icosphere(vertices: int) -> tuple[Floats, Ints]:
    """Return a subdivided icosahedron on the unit sphere, wound outwards.

    Parameters
    ----------
    vertices : int
        At least 12. Every edge is cut into f parts, f such that 10 f² + 2 is nearest to it.

    Returns
    -------
    points : (10 f² + 2, 3) array
    faces : (20 f², 3) array
    """
    f = max(1, round(((vertices - 2) / 10) ** 0.5))
    corners, triangles = icosahedron()
    row, column = np.tril_indices(f + 1)  # one face's lattice, from its first corner downwards
    steps = np.stack((f - row, row - column, column), axis=1)  # towards each corner; sum f
    inside = (steps > 0).all(axis=1)
    inner, outer = int(inside.sum()), 12 + 30 * (f - 1)
    # Numbers: the corners, then the insides of the 30 edges, then those of the 20 faces.
    numbers = np.empty((20, len(steps)), np.int64)
    points = np.empty((outer + 20 * inner, 3))
    edges: dict[frozenset[int], int] = {}
    for face, corner in enumerate(triangles.tolist()):
        own = numbers[face]
        own[inside] = outer + face * inner + np.arange(inner)
        for k in range(3):
            a, b = corner[k], corner[k - 1]
            edge = edges.setdefault(frozenset((a, b)), len(edges))
            along = np.flatnonzero(steps[:, k - 2] == 0)
            towards_larger = steps[along, k if a > b else k - 1]
            own[along] = 12 + edge * (f - 1) + towards_larger - 1  # wrong at the ends, until …
        own[steps.argmax(axis=0)] = corner  # … here
        points[own] = _blend(steps / f, corners[corner])
    number = np.arange(len(steps))[row < f]
    below = number + row[row < f] + 1
    pointing_up = np.stack((number, below, below + 1), axis=1)
    pointing_down = np.stack((number, number - 1, below), axis=1)[column[row < f] > 0]
    pieces = np.concatenate((pointing_up, pointing_down))
    return points, numbers[:, pieces].reshape(-1, 3)


def lattice_points(count: int) -> Floats:
    """Return the (count, 3) points of an icosahedral lattice on the unit sphere.

    A triangular lattice in which (h, k) steps lead from one corner of the icosahedron to the
    next: twelve points have five neighbours, all others six.

    Raises
    ------
    MeshdepictError
        Unless count = 10 (h² + hk + k²) + 2; names the nearest such counts.
    """
    most = round(count**0.5) + 1
    lattices = {
        10 * (h * h + h * k + k * k) + 2: (h, k) for h in range(1, most) for k in range(h + 1)
    }
    if count not in lattices:
        below = sorted(known for known in lattices if known < count)[-1:]
        above = min(known for known in lattices if known > count)
        nearest = " or ".join(map(str, [*below, above]))
        raise MeshdepictError(f"no icosahedral lattice has {count} points; take {nearest}")
    h, k = lattices[count]
    total = h * h + h * k + k * k
    # Lattice point i u + j v (u, v at 60°) of a face whose corners are 0, (h, k) and (−k, h + k).
    i, j = np.mgrid[-k : h + 1, 0 : h + k + 1].reshape(2, -1)
    second, third = (h + k) * i + k * j, h * j - k * i
    steps = np.stack((total - second - third, second, third), axis=1)
    steps = steps[(steps >= 0).all(axis=1)]
    # Whole-number weights of all twelve corners tell exactly which points the faces share.
    corners, triangles = icosahedron()
    weights = np.zeros((20, len(steps), 12), np.int64)
    for face, corner in enumerate(triangles):
        weights[face][:, corner] = steps
    return _blend(np.unique(weights.reshape(-1, 12), axis=0) / total, corners)


def _blend(weights: Floats, corners: Floats) -> Floats:
    """Points of the unit sphere from weights (…, k) in [0, 1] of corners (k, 3).

    The weights enter as sines, as in spherical interpolation: the spacing is even along an edge
    and varies by less than 1.18 over a face, where plain weights give 1.47.
    """
    sines = np.sin(_ARC * weights)
    points = np.zeros((*weights.shape[:-1], 3))
    for k, corner in enumerate(corners):
        points += sines[..., [k]] * corner
    return points / np.linalg.norm(points, axis=-1, keepdims=True)
