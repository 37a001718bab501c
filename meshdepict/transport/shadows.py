"""Shadows of lights: V, the share of a light that each sample sees."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.threads import each, spans
from meshdepict.transport.rays import (
    BATCH,
    FIRST,
    RaySet,
    Steps,
    checked_rays,
    lifted,
    ray_scene,
)

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["seen_share"]


def seen_share(
    mesh: Mesh,
    towards: ArrayLike,
    *,
    at: tuple[NDArray[Any], NDArray[Any]],
    spread: float = 0.0,
    rays: int = 64,
    steps: Steps = FIRST,
) -> NDArray[np.float32]:
    """Return which share of a light reaches every point.

    A direction behind a point's own surface, n·l ≤ 0, is not seen, whatever else is in the way.

    Parameters
    ----------
    mesh : Mesh
        What casts shadows.
    towards : (3,) array_like
        Unit vector to the light, or to the middle of its disc.
    at : two (n, 3) arrays
        Positions in the mesh's unit frame, and unit normals.
    spread : float
        Half-angle of the disc in degrees; 0: one direction, and hard shadows.
    rays : int
        How many directions stand for a disc, 2 … 65536.
    steps : (2, 3) array
        Which of the two sets of them; see `rays`.

    Returns
    -------
    (n,) array of float32
        In [0, 1].

    Raises
    ------
    MeshdepictError
        For another number of rays.
    """
    count = checked_rays(rays) if spread else 1
    points, normals = at
    axis = np.asarray(towards, np.float64)
    least = math.cos(math.radians(spread))

    def height(share: NDArray[np.float64]) -> NDArray[np.float64]:
        return 1 - share * (1 - least)

    scene, ray_set = ray_scene(mesh), RaySet(count, height)
    lifts = lifted(points, normals)
    # Where all of the disc is behind nothing is asked. Samples of one ray each fill a batch.
    reach = math.sin(math.radians(min(spread, 90.0)))
    asked = np.flatnonzero(np.asarray(normals, np.float64) @ axis > -reach)
    shares = np.zeros(len(points), np.float32)
    batch = max(1, BATCH // count)

    def work(begin: int, end: int) -> None:
        here = asked[begin:end]
        facing = np.asarray(normals[here], np.float64)
        axes = np.broadcast_to(axis, facing.shape)
        bundle = ray_set.leaving(points[here], lifts[here], axes, steps, ahead=True)
        above = np.einsum("ij,ikj->ik", facing.astype(np.float32), bundle.directions) > 0
        origins, directions = bundle.flat
        tried = np.flatnonzero(above)
        if len(tried):
            blocked = scene.run(origins[tried], directions[tried], query="OCCLUDED") >= 0
            above.flat[tried[blocked]] = False
        shares[here] = above.sum(axis=1) / np.float32(count)

    if len(asked):
        each(work, spans(len(asked), -(-len(asked) // batch)))
    return shares
