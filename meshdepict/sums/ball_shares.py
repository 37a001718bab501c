"""How much of a ball about each point lies below the surface: integral invariants of samples.

The volume is an integral over the surface inside the ball, by the divergence theorem, so positions,
normals and areas of samples are all that is needed: no mesh, no closed surface, no grid.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["ball_shares", "exact_shares"]

Floats = NDArray[np.float64]

# By how much the integral of 1/‖x‖ exceeds its sum over a square lattice without the origin, in
# edges of its cells over 2π. A hexagonal lattice of the same area has 0.624.
_OWN = 0.621
_NEAR = 2.5  # edges of a cell: who says how a point's own area is bent


def exact_shares(points: Floats, normals: NDArray[Any], areas: Floats, radius: float) -> Floats:
    """Return ½ + (1/4πr³) Σ_{‖d‖<r} A_j (d·n_j)(1 − r³/‖d‖³), d = x_j − x_i, by its definition.

    The slow readable twin, without the point's own area: see `ball_shares`.
    """
    found = np.empty(len(points))
    for i, point in enumerate(points):
        d = points - point
        length = np.linalg.norm(d, axis=1)
        near = (length < radius) & (length > 0)
        terms = areas[near] * np.einsum("ij,ij->i", d[near], normals[near])
        sums = (terms * (1 - (radius / length[near]) ** 3)).sum()
        found[i] = 0.5 + sums / (4 * np.pi * radius**3)
    return found


def ball_shares(
    points: Floats, normals: NDArray[Any], areas: Floats, radii: Sequence[float]
) -> Floats:
    """Return the share of balls that lies below the surface, for several radii.

    ``½ + (1/4πr³) Σ_{‖d‖<r} A_j (d·n_j)(1 − r³/‖d‖³)``, d = x_j − x_i, and two things that a sum
    over samples needs. Of the nearest, whose normals are means over what bends at the point itself,
    d·n_j is ½ d·(n_j − n_i): the same on any smooth surface, and of the right sign in a scratch as
    wide as a sample. And the point's own area is added, over which the integrand is not bounded:
    −κρ/4, κ being the mean of 2 d·n/‖d‖² over the nearest, weighted by A/‖d‖, and ρ about the
    area's radius.

    Parameters
    ----------
    points, normals : (n, 3) array
        Unit normals, outwards.
    areas : (n,) array
        Of the surface that each point stands for.
    radii : sequence of float
        In the units of the points.

    Returns
    -------
    (len(radii), n) array
        In [0, 1]; ½ on a plane, less on a bump, more in a hollow.
    """
    wide = np.asarray(radii, np.float64)
    order = np.argsort(wide)
    low, high = points.min(axis=0), points.max(axis=0)
    side = max(float(wide.max()), float((high - low).max()) / 1e6)
    index = ((points - low) / side).astype(np.int64)
    shape = index.max(axis=0) + 1
    keys = (index[:, 2] * shape[1] + index[:, 1]) * shape[0] + index[:, 0]
    sort = np.argsort(keys, kind="stable")
    keys = keys[sort]
    starts = np.flatnonzero(np.concatenate(([True], keys[1:] != keys[:-1], [True])))
    cells = keys[starts[:-1]]
    moved, towards = points[sort] - low, normals[sort].astype(np.float64)
    found = np.empty((len(wide), len(points)))
    given = moved, towards, areas[sort], cells, starts, shape, wide[order]
    each(lambda a, b: _shares(*given, found, a, b), spans(len(cells), 16 * thread_count()))
    result = np.empty_like(found)
    result[np.ix_(order, sort)] = found
    return np.clip(result, 0, 1)


@kernel("contracted")
def _shares(xyz, normals, areas, cells, starts, shape, radii, found, begin, end):  # type: ignore[no-untyped-def]
    count = len(radii)
    most = radii[-1] ** 2
    squares = radii * radii
    # Per radius the sums over its shell alone of A d·n and A d·n/‖d‖³.
    plain, sharp = np.empty(count), np.empty(count)
    for cell in range(begin, end):
        key = cells[cell]
        ix, iy, iz = key % shape[0], (key // shape[0]) % shape[1], key // (shape[0] * shape[1])
        runs, number = np.empty((9, 2), np.int64), 0
        for jz in range(max(iz - 1, 0), min(iz + 2, shape[2])):
            for jy in range(max(iy - 1, 0), min(iy + 2, shape[1])):
                row = (jz * shape[1] + jy) * shape[0]
                a = np.searchsorted(cells, row + max(ix - 1, 0))
                b = np.searchsorted(cells, row + min(ix + 2, shape[0]))
                runs[number, 0], runs[number, 1] = starts[a], starts[b]
                number += 1
        for i in range(starts[cell], starts[cell + 1]):
            x, y, z = xyz[i, 0], xyz[i, 1], xyz[i, 2]
            p, q, s = normals[i, 0], normals[i, 1], normals[i, 2]
            plain[:], sharp[:] = 0, 0
            bends = weight = 0.0
            near = _NEAR * _NEAR * areas[i]
            for run in range(number):
                for j in range(runs[run, 0], runs[run, 1]):
                    dx, dy, dz = xyz[j, 0] - x, xyz[j, 1] - y, xyz[j, 2] - z
                    square = dx * dx + dy * dy + dz * dz
                    if square >= most or square == 0.0:
                        continue
                    inverse = 1 / math.sqrt(square)
                    along = dx * normals[j, 0] + dy * normals[j, 1] + dz * normals[j, 2]
                    if (
                        square < near
                        and p * normals[j, 0] + q * normals[j, 1] + s * normals[j, 2] > 0
                    ):
                        along = 0.5 * (along - (dx * p + dy * q + dz * s))
                    term = areas[j] * along
                    cube = term * inverse * inverse * inverse
                    k = 0
                    while square >= squares[k]:
                        k += 1
                    plain[k] += term
                    sharp[k] += cube
                    if square < near:
                        bends += cube
                        weight += areas[j] * inverse
            kappa = 2 * bends / weight if weight > 0.0 else 0.0
            own = _OWN * math.sqrt(areas[i])
            a = b = 0.0
            for k in range(count):
                a += plain[k]
                b += sharp[k]
                r = radii[k]
                share = (a / (r * r * r) - b) / (4 * math.pi)
                found[k, i] = 0.5 + share - kappa * min(own, r) / 4
