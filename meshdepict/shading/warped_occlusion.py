"""Ambient occlusion seen through a warp: (1/π) ∫ ⟨n·l⟩ V(W(l)) dl (Light Warping, §6.1)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.features import Frames
from meshdepict.shading.warp_equations import warp, warp_scale
from meshdepict.threads import each, spans
from meshdepict.transport.rays import checked_rays

__all__ = ["warped_openness"]

_OFFSET = 1e-5  # of a ray's start from the surface, in diagonals
_BATCH = 8192  # points whose rays are traced at once
_GRID = 2.0**20  # positions this share of a diagonal apart have different angles
# Powers of the root of x⁴ = x + 1: their multiples fill the unit interval evenly.
_STEP = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])
_GOLDEN = math.pi * (3 - math.sqrt(5))


def warped_openness(
    space: ScaleSpace, frames: Frames | None, magnitude: float, *, rays: int
) -> NDArray[np.float32]:
    """Return the share (n,) of cosine-weighted directions whose warped partners get away.

    A partner below the horizon of the normal counts as blocked, as everywhere in Light Warping.
    Without frames every direction is its own partner.

    Raises
    ------
    MeshdepictError
        For a number of rays beyond 2 … 65536.
    """
    rays = checked_rays(rays)
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    mesh = space.surface
    points, normals = mesh.recentred(space.ray_points()), np.ascontiguousarray(space.normals_at(0))
    scene = EmbreeScene()
    TriangleMesh(scene, mesh.unit_points.astype(np.float32), mesh.faces.astype(np.int32))
    free = np.zeros(len(points), np.int64)
    warped = None
    if frames is not None:
        axes = np.stack([frames.u, frames.v, frames.z], axis=1)
        warped = axes, *(warp_scale(k, magnitude) for k in (frames.ku, frames.kv))

    def work(begin: int, end: int) -> None:
        here = slice(begin, end)
        n = normals[here]
        # Any tangent frame, turned by an angle that depends on the position alone: no bands, and
        # the same values whatever the order of the vertices.
        across = np.eye(3, dtype=np.float32)[np.argmin(np.abs(n), axis=1)]
        x = np.cross(across, n)
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        y = np.cross(n, x)
        start = 2 * math.pi * (np.floor(points[here] * _GRID) @ _STEP % 1)
        origins = (points[here] + _OFFSET * n).astype(np.float32)
        for ray in range(rays):
            share = (ray + 0.5) / rays
            angle = (start + ray * _GOLDEN)[:, None]
            level = math.sqrt(share)
            flat = level * (np.cos(angle) * x + np.sin(angle) * y)
            direction = flat + math.sqrt(1 - share) * n
            bent = direction
            if warped is not None:
                axes, scale_u, scale_v = (given[here] for given in warped)
                local = np.einsum("nij,nj->ni", axes, direction)
                bent = np.einsum("nij,ni->nj", axes, warp(local, scale_u, scale_v))
            bent = np.ascontiguousarray(bent, np.float32)
            above = np.flatnonzero(np.einsum("ni,ni->n", bent, n) > 0)
            if len(above):
                open_ = scene.run(origins[above], bent[above], query="OCCLUDED") < 0
                free[begin + above] += open_

    each(work, spans(len(points), -(-len(points) // _BATCH)))
    return (free / rays).astype(np.float32)
