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
_LEAST = 1e-12  # of the extent: in smaller balls rounded positions have no neighbours
_CELL = 0.5  # of the largest radius: a cell's side
_NEAR = 3.0  # edges of a cell, at which none says any more how a point's own area is bent


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
    low, high = points.min(axis=0), points.max(axis=0)
    wide = np.maximum(np.asarray(radii, np.float64), _LEAST * float((high - low).max()))
    largest = float(wide.max())
    side = max(_CELL * largest, float((high - low).max()) / 1e6)
    index = ((points - low) / side).astype(np.int64)
    shape = index.max(axis=0) + 1
    keys = (index[:, 2] * shape[1] + index[:, 1]) * shape[0] + index[:, 0]
    sort = np.argsort(keys, kind="stable")
    keys = keys[sort]
    starts = np.flatnonzero(np.concatenate(([True], keys[1:] != keys[:-1], [True])))
    cells = keys[starts[:-1]]
    # In largest radii, so that single precision does, relative to each cell.
    samples = np.empty((7, len(points)))
    samples[:3] = (points[sort] - low).T / largest
    samples[3:6] = normals[sort].T
    samples[6] = areas[sort] / largest**2
    threes = np.pad(wide, (0, -len(wide) % 3), mode="edge") / largest
    found = np.empty((len(threes), len(points)))
    far = math.ceil(largest / side)
    given = samples, cells, starts, shape, side / largest, far, threes
    each(lambda a, b: _shares(*given, found, a, b), spans(len(cells), 16 * thread_count()))
    result = np.empty((len(wide), len(points)))
    result[:, sort] = found[: len(wide)]
    return np.clip(result, 0, 1)


@kernel("contracted")
def _gathered(samples, cells, starts, shape, key, side, far):  # type: ignore[no-untyped-def]
    """Copy what lies in the cells around one, relative to its corner: (7, count)."""
    ix, iy, iz = key % shape[0], (key // shape[0]) % shape[1], key // (shape[0] * shape[1])
    runs, number, count = np.empty(((2 * far + 1) ** 2, 2), np.int64), 0, 0
    for jz in range(max(iz - far, 0), min(iz + far + 1, shape[2])):
        for jy in range(max(iy - far, 0), min(iy + far + 1, shape[1])):
            row = (jz * shape[1] + jy) * shape[0]
            a = starts[np.searchsorted(cells, row + max(ix - far, 0))]
            b = starts[np.searchsorted(cells, row + min(ix + far + 1, shape[0]))]
            runs[number, 0], runs[number, 1] = a, b
            number += a < b
            count += b - a
    around = np.empty((7, count), np.float32)
    at = 0
    for run in range(number):
        a, b = runs[run, 0], runs[run, 1]
        for j in range(a, b):
            around[0, at] = samples[0, j] - ix * side
            around[1, at] = samples[1, j] - iy * side
            around[2, at] = samples[2, j] - iz * side
            at += 1
        for k in range(3, 7):
            for j in range(a, b):
                around[k, at - b + j] = samples[k, j]
    return around, ix * side, iy * side, iz * side


@kernel("free")
def _sums(around, x, y, z, p, q, s, near, first, second, third):  # type: ignore[no-untyped-def]
    """Return Σ A d·n and Σ A d·n/‖d‖³ within three radii (squared), and how the nearest bend.

    Nothing is stored, so that the compiler needs not ask what overlaps, and keeps eight in a row.
    """
    zero, half, one, least = np.float32(0), np.float32(0.5), np.float32(1), np.float32(1e-12)
    fade = one / near
    xs, ys, zs = around[0], around[1], around[2]
    ps, qs, ss, areas = around[3], around[4], around[5], around[6]
    a0 = a1 = a2 = b0 = b1 = b2 = bends = weight = zero
    for j in range(around.shape[1]):
        dx, dy, dz = xs[j] - x, ys[j] - y, zs[j] - z
        square = dx * dx + dy * dy + dz * dz
        inverse = one / np.float32(math.sqrt(max(square, least)))
        along = dx * ps[j] + dy * qs[j] + dz * ss[j]
        facing = p * ps[j] + q * qs[j] + s * ss[j]
        own = dx * p + dy * q + dz * s
        # From 1 at the point to 0 where none is near, and to 0 on the other side of a sheet.
        close = max(one - square * fade, zero)
        same = min(max(facing + facing, zero), one)
        along -= min(close + close, one) * same * half * (along + own)
        term = areas[j] * along
        cube = term * inverse * inverse * inverse
        a0 += term if square < first else zero
        b0 += cube if square < first else zero
        a1 += term if square < second else zero
        b1 += cube if square < second else zero
        a2 += term if square < third else zero
        b2 += cube if square < third else zero
        bends += close * cube
        weight += close * (areas[j] * inverse if square > least else zero)
    return a0, b0, a1, b1, a2, b2, bends, weight


@kernel("contracted")
def _shares(samples, cells, starts, shape, side, far, radii, found, begin, end):  # type: ignore[no-untyped-def]
    for cell in range(begin, end):
        around, left, low, front = _gathered(samples, cells, starts, shape, cells[cell], side, far)
        for i in range(starts[cell], starts[cell + 1]):
            x, y, z = (
                np.float32(samples[0, i] - left),
                np.float32(samples[1, i] - low),
                np.float32(samples[2, i] - front),
            )
            p, q, s = (
                np.float32(samples[3, i]), np.float32(samples[4, i]), np.float32(samples[5, i]),
            )  # fmt: skip
            area = samples[6, i]
            near = np.float32(max(min(_NEAR * _NEAR * area, 1.0), 1e-12))
            own = _OWN * math.sqrt(area)
            for k in range(0, found.shape[0], 3):
                r0, r1, r2 = radii[k], radii[k + 1], radii[k + 2]
                a0, b0, a1, b1, a2, b2, bends, weight = _sums(
                    around, x, y, z, p, q, s, near,
                    np.float32(r0 * r0), np.float32(r1 * r1), np.float32(r2 * r2),
                )  # fmt: skip
                kappa = 2.0 * bends / weight if weight > 0 else 0.0
                found[k, i] = _share(a0, b0, r0, kappa, own)
                found[k + 1, i] = _share(a1, b1, r1, kappa, own)
                found[k + 2, i] = _share(a2, b2, r2, kappa, own)


@kernel("contracted", inline=True)
def _share(plain, sharp, r, kappa, own):  # type: ignore[no-untyped-def]
    return 0.5 + (plain / (r * r * r) - sharp) / (4 * math.pi) - kappa * min(own, r) / 4
