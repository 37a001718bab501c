"""Rays within a body of glass: from wall to wall, and how much of each leaves there.

A wall refracts a ray out and mirrors the rest of it back in, all of it where it comes too flat:
Snell and Fresnel. One ray within is followed; what leaves is told wall by wall. A ray that finds no
wall, since the surface is open or it began outside, leaves as it goes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import kernel
from meshdepict.transport.rays import AHEAD, OFFSET, ray_scene
from meshdepict.transport.walls import farthest, walls_of

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Inner", "Wall", "inner_paths"]

Single = NDArray[np.float32]

_MOST_PASSED = 8  # faces that a ray meets from outside; then it leaves
_LEAST = 0.01  # of a ray's light is followed
_WIDEST = np.float32(1.6)  # that a ray spreads, in radians


class Wall(NamedTuple):
    """Where some rays meet a wall from within.

    Attributes
    ----------
    ray : (k,) array of int
        Which.
    arriving, normal, leaving : (k, 3) arrays of float32
        Unit vectors: the ray before the wall, the wall's outward normal, and the ray outside; that
        grazes the wall where all of it is mirrored.
    share : (k,) array of float32
        Of a ray's light that arrives.
    let_out : (k,) array of float32
        Of that which arrives.
    spread : (k,) array of float32
        How far the rays of neighbouring samples are apart outside, in radians.
    """

    ray: NDArray[np.int64]
    arriving: Single
    normal: Single
    leaving: Single
    share: Single
    let_out: Single
    spread: Single


class Inner(NamedTuple):
    """What became of rays.

    Attributes
    ----------
    walls : tuple of Wall
        One after the other.
    directions : (n, 3) array of float32
        In which the rest goes that left by no wall, or met no more of them.
    rest : (n,) array of float32
        Its share.
    spread : (n,) array of float32
    """

    walls: tuple[Wall, ...]
    directions: Single
    rest: Single
    spread: Single


def inner_paths(
    mesh: Mesh,
    starts: NDArray[Any],
    directions: NDArray[Any],
    *,
    normals: NDArray[Any],
    refraction: float,
    walls: int,
    cones: tuple[NDArray[Any], NDArray[Any]] | None = None,
) -> Inner:
    """Follow rays within what a surface encloses. In one batch: callers give some at a time.

    Parameters
    ----------
    mesh : Mesh
    starts : (n, 3) array
        Of `paths.starting`, below the surface.
    directions : (n, 3) array
        Unit.
    normals : (v, 3) array
        Of the vertices of the mesh, outward.
    refraction : float
        Index within over that outside, ≥ 1.
    walls : int
        How many a ray meets at most.
    cones : two (n,) arrays, optional
        As for `paths.mirrored_paths`.

    Returns
    -------
    Inner
        Of each ray Σ share · let_out + rest = 1.
    """
    known, scene = walls_of(mesh), ray_scene(mesh)
    surface = np.ascontiguousarray(normals, np.float32)
    count = len(starts)
    origins = np.array(starts, np.float32)
    along = np.array(directions, np.float32, order="C")
    rest = np.ones(count, np.float32)
    width, spread = (np.array(part, np.float32) for part in cones or np.zeros((2, count)))
    left, passed = np.full(count, walls, np.int64), np.zeros(count, np.int64)
    found: list[Wall] = []
    going = np.arange(count, dtype=np.int64)
    while len(going) and walls:
        met = scene.run(origins[going], along[going], query="INTERSECT", output=True)
        size = len(going)
        arriving, normal, leaving = np.empty((3, size, 3), np.float32)
        share, let_out, apart = np.empty((3, size), np.float32)
        walled, on = np.zeros((2, size), bool)
        _meet(
            going, met["primID"], met["u"], met["v"], met["tfar"], *known, surface,
            np.float32(refraction), origins, along, rest, width, spread, left, passed,
            arriving, normal, leaving, share, let_out, apart, walled, on,
        )  # fmt: skip
        if walled.any():
            vectors = (part[walled] for part in (arriving, normal, leaving))
            numbers = (part[walled] for part in (share, let_out, apart))
            found.append(Wall(going[walled], *vectors, *numbers))
        going = going[on]
    return Inner(tuple(found), along, rest, spread)


@kernel()
def _meet(  # type: ignore[no-untyped-def]
    going, met, u, v, far, faces, points, outward, opened, sizes, normals, refraction, origins,
    directions, rest, width, spread, left, passed, arriving, normal, leaving, share, let_out,
    apart, walled, on,
):  # fmt: skip
    """Take rays through the walls that they met: out, and back in."""
    for j in range(len(going)):
        i, f = going[j], met[j]
        if f < 0:
            continue
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        gx, gy, gz = outward[f, 0], outward[f, 1], outward[f, 2]
        second = min(max(u[j], np.float32(0)), np.float32(1))
        third = min(max(v[j], np.float32(0)), np.float32(1) - second)
        first = np.float32(1) - second - third
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        width[i] += spread[i] * far[j]
        if dx * gx + dy * gy + dz * gz <= 0:  # from outside: another part's, or it began there
            passed[i] += 1
            on[j] = passed[i] < _MOST_PASSED
        else:
            nx = first * normals[a, 0] + second * normals[b, 0] + third * normals[c, 0]
            ny = first * normals[a, 1] + second * normals[b, 1] + third * normals[c, 1]
            nz = first * normals[a, 2] + second * normals[b, 2] + third * normals[c, 2]
            length = math.sqrt(nx * nx + ny * ny + nz * nz)
            if not length > np.float32(1e-6):
                nx, ny, nz, length = gx, gy, gz, 1.0
            if nx * gx + ny * gy + nz * gz < 0:
                length = -length
            nx, ny, nz = nx / length, ny / length, nz / length
            # A normal that looks back along the ray is taken at a right angle to it.
            cosine = min(max(dx * nx + dy * ny + dz * nz, np.float32(0)), np.float32(1))
            beyond = 1 - refraction * refraction * (1 - cosine * cosine)
            out = math.sqrt(max(beyond, np.float32(0)))
            across = (refraction * cosine - out) / max(refraction * cosine + out, np.float32(1e-30))
            inline = (refraction * out - cosine) / max(refraction * out + cosine, np.float32(1e-30))
            kept = (across * across + inline * inline) / 2 if beyond > 0 else np.float32(1)
            walled[j] = True
            share[j], let_out[j] = rest[i], 1 - kept
            arriving[j, 0], arriving[j, 1], arriving[j, 2] = dx, dy, dz
            normal[j, 0], normal[j, 1], normal[j, 2] = nx, ny, nz
            turn = np.float32(0)
            if width[i] > 0 and sizes[f] > 0:
                turn = farthest(normals, a, b, c) / sizes[f] * width[i]
            apart[j] = min(refraction * spread[i] + (refraction - 1) * turn, _WIDEST)
            spread[i] = min(spread[i] + 2 * turn, _WIDEST)
            lift = out - refraction * cosine
            x, y = refraction * dx + lift * nx, refraction * dy + lift * ny
            z = refraction * dz + lift * nz
            under = 2 * min(x * gx + y * gy + z * gz, np.float32(0))
            x, y, z = x - under * gx, y - under * gy, z - under * gz
            size = max(math.sqrt(x * x + y * y + z * z), 1e-12)
            leaving[j, 0], leaving[j, 1], leaving[j, 2] = x / size, y / size, z / size
            twice = 2 * cosine
            dx, dy, dz = dx - twice * nx, dy - twice * ny, dz - twice * nz
            over = 2 * max(dx * gx + dy * gy + dz * gz, np.float32(0))
            dx, dy, dz = dx - over * gx, dy - over * gy, dz - over * gz
            size = max(math.sqrt(dx * dx + dy * dy + dz * dz), 1e-12)
            dx, dy, dz = dx / size, dy / size, dz / size
            directions[i, 0], directions[i, 1], directions[i, 2] = dx, dy, dz
            rest[i] *= kept
            left[i] -= 1
            on[j] = left[i] > 0 and rest[i] > _LEAST
        for axis in range(3):
            g = gx if axis == 0 else (gy if axis == 1 else gz)
            d = dx if axis == 0 else (dy if axis == 1 else dz)
            at = first * points[a, axis] + second * points[b, axis] + third * points[c, axis]
            origins[i, axis] = at - OFFSET * g + AHEAD * d
