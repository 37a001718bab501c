"""Rays that mirrors send on: what each meets in the end, or where it gets away.

A ray is mirrored at the normal between the corners of the triangle that it meets, and kept on the
side of the triangle from which it came. Both vary without a jump from triangle to triangle.

Facets stand for a round surface: a ray that leaves it at a grazing angle may meet the facet next to
where it began, though the normal there turns away from it. Where the surface is convex that ray
goes on, through the facet and out again: of a convex object nothing sees itself. Where it is
hollow the ray is kept on its side, along the facet.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans
from meshdepict.transport.rays import AHEAD, BATCH, OFFSET, ray_scene
from meshdepict.transport.walls import farthest, walls_of

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["AWAY", "HIDDEN", "Met", "Paths", "mirrored_paths", "starting"]

Single = NDArray[np.float32]
Ints = NDArray[np.int32]

AWAY, HIDDEN = -1, -2
_MOST_PASSED = 16  # facets that a ray goes through; then it is away
_WIDEST = np.float32(1.6)  # that a ray spreads, in radians: environments are blurred no more
_NEXT_TO = np.float32(2)  # longest edges of a facet: so far away a start may be that grazes it


class Met(NamedTuple):
    """Where some rays met triangles.

    Attributes
    ----------
    ray : (k,) array of int
        Which.
    triangle : (k,) array of int32
    weights : (k, 2) array of float32
        Of the second and third corner.
    """

    ray: NDArray[np.int64]
    triangle: Ints
    weights: Single


class Paths(NamedTuple):
    """Where rays end.

    Attributes
    ----------
    directions : (n, 3) array of float32
        In which they went at last.
    triangle : (n,) array of int32
        What they met there: a matt triangle; `AWAY`: the sky; `HIDDEN`: what sends nothing.
    weights : (n, 2) array of float32
        Of its second and third corner.
    mirrored : tuple of Met
        Where they were mirrored, in the order of any ray's way; a ray is at most once in each.
    spread : (n,) array of float32
        How far the rays of neighbouring samples are apart then, in radians.
    """

    directions: Single
    triangle: Ints
    weights: Single
    mirrored: tuple[Met, ...]
    spread: Single


def starting(
    points: NDArray[Any], lifts: NDArray[Any], directions: NDArray[Any], *, below: bool = False
) -> Single:
    """Return where rays begin (n, 3) that leave points of a surface, off it and a little ahead.

    Parameters
    ----------
    points : (n, 3) array
        In the mesh's unit frame.
    lifts : (n, 3) array
        As `rays.lifted` returns them.
    directions : (n, 3) array
    below : bool
        Whether rays leave into what the surface encloses.
    """
    off = -OFFSET if below else OFFSET
    return (points + off * lifts + AHEAD * directions).astype(np.float32)


def mirrored_paths(
    mesh: Mesh,
    starts: NDArray[Any],
    directions: NDArray[Any],
    *,
    normals: NDArray[Any],
    mirrors: NDArray[np.bool_] | None = None,
    bounces: int,
    hidden: bool = False,
    cones: tuple[NDArray[Any], NDArray[Any]] | None = None,
) -> Paths:
    """Follow rays from mirror to mirror, to what is matt or away.

    Backs of closed parts are no mirrors, and what is matt shows nothing there. Where a part has a
    boundary both of its sides are alike.

    Parameters
    ----------
    mesh : Mesh
        What rays meet.
    starts : (n, 3) array
        Of `starting`.
    directions : (n, 3) array
        Unit.
    normals : (v, 3) array
        Of the vertices of the mesh.
    mirrors : (m,) array of bool, optional
        Which triangles are mirrors, and which matt; all are mirrors unless given.
    bounces : int
        How often a ray is mirrored. After the last time it is away, or:
    hidden : bool
        It is asked whether it meets a mirror once more, and hidden if it does.
    cones : two (n,) arrays, optional
        How far apart neighbouring samples are, in the mesh's unit frame, and their rays in radians.
        Curved mirrors spread them further.
    """
    walls, scene = walls_of(mesh), ray_scene(mesh)
    surface = np.ascontiguousarray(normals, np.float32)
    shiny = np.ones(len(walls.faces), bool) if mirrors is None else np.ascontiguousarray(mirrors)
    count = len(starts)
    origins = np.array(starts, np.float32)
    along = np.array(directions, np.float32, order="C")
    triangle, weights = np.full(count, AWAY, np.int32), np.zeros((count, 2), np.float32)
    width, spread = (np.array(part, np.float32) for part in cones or np.zeros((2, count)))
    pieces = spans(count, -(-count // BATCH))
    turned: list[list[Met]] = [[] for _ in pieces]

    def work(number: int, begin: int, end: int) -> None:
        going = np.arange(begin, end, dtype=np.int64)
        left, passed = np.full(end - begin, bounces, np.int64), np.zeros(end - begin, np.int64)
        while len(going):
            met = scene.run(origins[going], along[going], query="INTERSECT", output=True)
            mirrored, on = np.zeros((2, len(going)), bool)
            _step(
                going, met["primID"], met["u"], met["v"], met["tfar"], *walls, surface, shiny,
                hidden, bounces, begin, origins, along, left, passed, width, spread, triangle,
                weights, mirrored, on,
            )  # fmt: skip
            if mirrored.any():
                at = np.stack([met["u"], met["v"]], axis=1)[mirrored]
                turned[number].append(Met(going[mirrored], met["primID"][mirrored], at))
            going = going[on]

    if count and (bounces or hidden or mirrors is not None):
        each(work, [(i, *piece) for i, piece in enumerate(pieces)])
    steps = max(map(len, turned), default=0)
    together = [[one[k] for one in turned if k < len(one)] for k in range(steps)]
    mirrored = tuple(Met(*map(np.concatenate, zip(*some, strict=True))) for some in together)
    return Paths(along, triangle, weights, mirrored, spread)


@kernel()
def _bends(points, normals, a, b, c, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Return how normals turn along a direction in a triangle: towards it, > 0, where convex."""
    ux, uy, uz = (points[b, 0] - points[a, 0], points[b, 1] - points[a, 1],
                  points[b, 2] - points[a, 2])  # fmt: skip
    vx, vy, vz = (points[c, 0] - points[a, 0], points[c, 1] - points[a, 1],
                  points[c, 2] - points[a, 2])  # fmt: skip
    uu, uv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz
    vv = vx * vx + vy * vy + vz * vz
    du, dv = dx * ux + dy * uy + dz * uz, dx * vx + dy * vy + dz * vz
    # Weights by which the direction changes the corners', but for a factor > 0.
    second, third = vv * du - uv * dv, uu * dv - uv * du
    along_u = (
        dx * (normals[b, 0] - normals[a, 0]) + dy * (normals[b, 1] - normals[a, 1])
        + dz * (normals[b, 2] - normals[a, 2])
    )  # fmt: skip
    along_v = (
        dx * (normals[c, 0] - normals[a, 0]) + dy * (normals[c, 1] - normals[a, 1])
        + dz * (normals[c, 2] - normals[a, 2])
    )  # fmt: skip
    return second * along_u + third * along_v


@kernel()
def _step(  # type: ignore[no-untyped-def]
    going, met, u, v, far, faces, points, outward, opened, sizes, normals, mirrors, hidden, bounces,
    begin, origins, directions, left, passed, width, spread, triangle, weights, mirrored, on,
):  # fmt: skip
    """Take the rays that are on their way through what each met."""
    for j in range(len(going)):
        i, f = going[j], met[j]
        k = i - begin
        if f < 0:
            continue  # away, as it was from the beginning
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        gx, gy, gz = outward[f, 0], outward[f, 1], outward[f, 2]
        second = min(max(u[j], np.float32(0)), np.float32(1))
        third = min(max(v[j], np.float32(0)), np.float32(1) - second)
        first = np.float32(1) - second - third
        facing = dx * gx + dy * gy + dz * gz
        behind = facing > 0
        if behind:
            gx, gy, gz, facing = -gx, -gy, -gz, -facing
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        width[i] += spread[i] * far[j]
        nx = first * normals[a, 0] + second * normals[b, 0] + third * normals[c, 0]
        ny = first * normals[a, 1] + second * normals[b, 1] + third * normals[c, 1]
        nz = first * normals[a, 2] + second * normals[b, 2] + third * normals[c, 2]
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        if not length > np.float32(1e-6):
            nx, ny, nz, length = gx, gy, gz, 1.0
        if nx * gx + ny * gy + nz * gz < 0:
            length = -length
        nx, ny, nz = nx / length, ny / length, nz / length
        against = dx * nx + dy * ny + dz * nz
        inside = behind and not opened[f]
        # One that was mirrored began on a facet, and grazes none.
        grazes = against >= 0 and left[k] == bounces and far[j] <= _NEXT_TO * sizes[f]
        if (inside and (mirrors[f] or passed[k] > 0)) or (not inside and grazes):
            if passed[k] == _MOST_PASSED:
                continue
            passed[k] += 1
            off = -OFFSET
            if not inside and _bends(points, normals, a, b, c, dx, dy, dz) * length < 0:
                dx, dy, dz = dx - 2 * facing * gx, dy - 2 * facing * gy, dz - 2 * facing * gz
                directions[i, 0], directions[i, 1], directions[i, 2] = dx, dy, dz
                off = OFFSET
        elif not mirrors[f]:
            triangle[i] = HIDDEN if inside else f
            weights[i, 0], weights[i, 1] = second, third
            continue
        elif left[k] == 0:
            triangle[i] = HIDDEN
            continue
        else:
            left[k] -= 1
            passed[k] = 0
            mirrored[j] = True
            twice = 2 * min(against, np.float32(0))
            dx, dy, dz = dx - twice * nx, dy - twice * ny, dz - twice * nz
            under = 2 * min(dx * gx + dy * gy + dz * gz, np.float32(0))
            dx, dy, dz = dx - under * gx, dy - under * gy, dz - under * gz
            size = math.sqrt(dx * dx + dy * dy + dz * dz)
            dx, dy, dz = dx / size, dy / size, dz / size
            directions[i, 0], directions[i, 1], directions[i, 2] = dx, dy, dz
            if width[i] > 0 and sizes[f] > 0:
                turn = farthest(normals, a, b, c) / sizes[f]
                spread[i] = min(spread[i] + 2 * turn * width[i], _WIDEST)
            if left[k] == 0 and not hidden:
                continue
            off = OFFSET
        on[j] = True
        for axis in range(3):
            g = gx if axis == 0 else (gy if axis == 1 else gz)
            d = dx if axis == 0 else (dy if axis == 1 else dz)
            at = first * points[a, axis] + second * points[b, axis] + third * points[c, axis]
            origins[i, axis] = at + off * g + AHEAD * d
