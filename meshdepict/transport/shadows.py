"""Shadows of lights: V, the share of a light that each sample sees."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.threads import each, spans
from meshdepict.transport.rays import (
    AHEAD,
    BATCH,
    FIRST,
    RaySet,
    Steps,
    checked_rays,
    lifted,
    ray_scene,
    started,
)

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["seen_directions", "seen_share"]

_TOGETHER = 8_192  # rays of one direction: a hand that holds the light waits for every thread


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
    axis = np.asarray(towards, np.float64)
    if not spread:
        return seen_directions(mesh, axis[None], at=at)[0].astype(np.float32)
    count = checked_rays(rays)
    points, normals = at
    least = math.cos(math.radians(spread))

    def height(share: NDArray[np.float64]) -> NDArray[np.float64]:
        return 1 - share * (1 - least)

    scene, ray_set = ray_scene(mesh), RaySet(count, height)
    lifts = lifted(points, normals)
    # Where all of the disc is behind nothing is asked.
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


def seen_directions(
    mesh: Mesh,
    towards: ArrayLike,
    *,
    at: tuple[NDArray[Any], NDArray[Any]],
    lifts: NDArray[np.float64] | None = None,
) -> NDArray[np.bool_]:
    """Return whether each point sees each of some directions: (directions, n).

    Parameters
    ----------
    mesh : Mesh
        What casts shadows.
    towards : (directions, 3) array_like
        Unit vectors.
    at : two (n, 3) arrays
        As for `seen_share`.
    lifts : (n, 3) array, optional
        What `lifted` says of them, where that is known.
    """
    points, normals = at
    axes = np.asarray(towards, np.float64).reshape(-1, 3)
    scene, count = ray_scene(mesh), len(points)
    starts = started(points, lifted(points, normals) if lifts is None else lifts)
    exact, single = np.asarray(normals, np.float64), np.asarray(normals, np.float32)
    seen = np.zeros((len(axes), count), bool)

    def work(number: int, begin: int, end: int) -> None:
        axis = axes[number].astype(np.float32)
        above = exact[begin:end] @ axes[number] > 0
        here = begin + np.flatnonzero(above & (single[begin:end] @ axis > 0))
        if len(here):
            origins = starts[here] + AHEAD * axis
            directions = np.broadcast_to(axis, origins.shape).copy()
            seen[number, here] = scene.run(origins, directions, query="OCCLUDED") < 0

    pieces = spans(count, -(-count // _TOGETHER)) if count else []
    each(work, [(number, *piece) for number in range(len(axes)) for piece in pieces])
    return seen
