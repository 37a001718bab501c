"""What the surface hides from itself, asked with rays: ambient occlusion, the view of the sky."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, spans
from meshdepict.transport.rays import (
    AGAIN,
    BATCH,
    FIRST,
    RaySet,
    Steps,
    checked_rays,
    cosine_weighted,
    lifted,
    probed,
    ray_scene,
)

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Openness", "ambient_openness", "sky_openness", "zenith_angles"]

_SAME = 1e-12  # by which a mean of equal normals may differ from them

Floats = NDArray[np.float64]
At = tuple[NDArray[Any], NDArray[Any]]


class Openness(NamedTuple):
    """The share of the light from all around that reaches each point.

    Attributes
    ----------
    values : (n,) array of float32
        In [0, 1]: 1 where nothing is in the way.
    error : float
        Root mean square error over the points, estimated from a second set of as many rays,
        shifted independently, at a thousand of the points.
    """

    values: NDArray[np.float32]
    error: float


def ambient_openness(
    mesh: Mesh,
    *,
    at: At | None = None,
    rays: int = 256,
    done: Callable[[int], None] | None = None,
) -> Openness:
    """Return (1/π) ∫ max(0, n·ω) V(ω) dω at every point, V being 1 where a ray gets away.

    Parameters
    ----------
    mesh : Mesh
        What rays can meet.
    at : two (n, 3) arrays, optional
        World positions and unit normals; the mesh's vertices unless given.
    rays : int
        Per point, 2 … 65536, cosine-weighted. The error falls about as rays^−¾.
    done : callable, optional
        Called with the number of a finished batch.

    Raises
    ------
    MeshdepictError
        For another number of rays.
    """
    count = checked_rays(rays)
    points, normals = _places(mesh, at)
    return _traced(mesh, (points, normals), count, cosine_weighted, normals, weigh=False, done=done)


def sky_openness(
    mesh: Mesh,
    towards: NDArray[Any],
    *,
    at: At | None = None,
    spread: float = 90.0,
    rays: int = 256,
    even: bool = False,
    radius: float | None = None,
    done: Callable[[int], None] | None = None,
) -> Openness:
    """Return the share of the light of a cap of sky that reaches every point.

    ∫ max(0, n·ω) V(ω) dω over the directions within ``spread`` of ``towards``, relative to what an
    open surface that faces the cap's middle gets; ``even``, the share of the cap that is seen.

    Parameters
    ----------
    mesh : Mesh
        What rays can meet.
    towards : (3,) or (n, 3) array
        Unit vectors to the middle of the sky.
    at : two (n, 3) arrays, optional
        World positions and unit normals; the mesh's vertices unless given.
    spread : float
        Half the cap's opening in degrees, up to 90.
    rays : int
        Per point, 2 … 65536, evenly over the cap.
    even : bool
        Whether directions weigh the same, whatever their angle to the surface.
    radius : float, optional
        Farther away nothing hides the sky; in world units.
    done : callable, optional
        Called with the number of a finished batch.

    Raises
    ------
    MeshdepictError
        For another number of rays.
    """
    count = checked_rays(rays)
    least = math.cos(math.radians(spread))

    def height(share: Floats) -> Floats:
        return 1 - share * (1 - least)

    points, normals = _places(mesh, at)
    axes = np.broadcast_to(towards, normals.shape)
    return _traced(
        mesh, (points, normals), count, height, axes,
        weigh=not even, reach=_reach(mesh, radius), done=done,
    )  # fmt: skip


def zenith_angles(
    mesh: Mesh,
    towards: NDArray[Any],
    *,
    at: At,
    rays: int = 256,
    radius: float | None = None,
    done: Callable[[int], None] | None = None,
) -> NDArray[np.float32]:
    """Return how far from the zenith the sky is seen, on average round about: openness, in degrees.

    Rays leave evenly over azimuths and zenith angles from 0 to 180°; the share of those that get
    away, times 180°, is mean(90° − γ) with γ the horizon's elevation where nothing overhangs.

    Parameters
    ----------
    mesh, at, rays, radius, done
        As for `sky_openness`.
    towards : (3,) or (n, 3) array
        Unit vectors to the zenith.

    Returns
    -------
    (n,) array of float32
        90 on a plane.
    """
    count = checked_rays(rays)

    def height(share: Floats) -> Floats:
        return np.cos(np.pi * share)

    points, normals = _places(mesh, at)
    axes = np.broadcast_to(towards, normals.shape)
    found = _traced(
        mesh, (points, normals), count, height, axes,
        weigh=False, reach=_reach(mesh, radius), done=done,
    )  # fmt: skip
    return found.values * np.float32(180)


def _off_all(points: Floats, normals: Floats) -> Floats:
    """Return where rays start off: off all that meets at a crease, elsewhere off normals."""
    lifts = lifted(points, normals)
    same = np.abs(lifts - normals).max(axis=1) < _SAME
    return np.where(same[:, None], normals, lifts)


def _reach(mesh: Mesh, radius: float | None) -> float | None:
    """Return a radius in the mesh's unit frame."""
    return None if radius is None else radius / (mesh.diagonal or 1.0)


def _places(mesh: Mesh, at: At | None) -> tuple[Floats, Floats]:
    """Return positions in the mesh's unit frame, and normals."""
    if at is None:
        return mesh.unit_points, mesh.normals
    points, normals = at
    return mesh.recentred(points), np.asarray(normals)


def _traced(
    mesh: Mesh,
    places: tuple[Floats, Floats],
    rays: int,
    height: Callable[[Floats], Floats],
    axes: Floats,
    *,
    weigh: bool,
    reach: float | None = None,
    done: Callable[[int], None] | None,
) -> Openness:
    """Trace rays round each point's axis; weigh them by the cosine to its normal where asked to.

    ``height`` turns a share in [0, 1] of all rays into their cosine to the axis, from 1 downwards.
    """
    points, normals = places
    lifts = _off_all(points, normals)
    scene, ray_set = ray_scene(mesh), RaySet(rays, height)
    whole = np.ones(rays) if not weigh else height((np.arange(rays) + 0.5) / rays)

    def shares(here: Any, steps: Steps) -> Floats:
        bundle = ray_set.leaving(points[here], lifts[here], axes[here], steps)
        origins, directions = bundle.flat
        far = {} if reach is None else {"dists": np.full(len(origins), reach, np.float32)}
        if not weigh:
            hit = scene.run(origins, directions, query="OCCLUDED", **far)
            light = (hit < 0).reshape(-1, rays)
        else:
            light = np.einsum("ij,ikj->ik", normals[here].astype(np.float32), bundle.directions)
            lit = np.flatnonzero(light > 0)
            if len(lit):
                rays_lit = origins[lit], directions[lit]
                few = {name: limit[: len(lit)] for name, limit in far.items()}
                light.flat[lit[scene.run(*rays_lit, query="OCCLUDED", **few) >= 0]] = 0
            light = np.maximum(light, 0)
        # Every other ray first: in double precision the two sums stay what they always were.
        sums = light[:, ::2].sum(axis=1).astype(float) + light[:, 1::2].sum(axis=1)
        return np.asarray(sums / whole.sum())

    probes = probed(len(points))
    values, again = np.zeros(len(points)), np.zeros(len(probes))
    batch = max(1, BATCH // rays)

    def work(begin: int, end: int) -> None:
        values[begin:end] = shares(slice(begin, end), FIRST)

    def probe(begin: int, end: int) -> None:
        again[begin:end] = shares(probes[begin:end], AGAIN)

    each(work, spans(len(points), -(-len(points) // batch)), done)
    each(probe, spans(len(probes), -(-len(probes) // batch)))
    difference = values[probes] - again
    error = float(np.sqrt(np.mean(difference**2) / 2))
    return Openness(np.clip(values, 0, 1).astype(np.float32), error)
