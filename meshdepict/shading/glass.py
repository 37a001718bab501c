"""Light through a body of glass: in by one interface, and out by another (Walter et al. 2007).

The line of sight is refracted by facets of a frosted surface, goes from wall to wall within, and
leaves where walls let it out. What lies behind, or the lobe of a light, is looked up there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading.mirrored_light import FILTER
from meshdepict.shading.transmission import fresnel
from meshdepict.threads import each, spans

__all__ = ["WALLS", "Glass", "facet_height", "through_glass"]

Single = NDArray[np.float32]
Turned = Callable[[Single, int, int], Callable[[Light], Single]]

WALLS = 4
"""Walls within that a ray meets, if so much of its light is left."""

_AT_ONCE = 65_536  # rays
_STEEPEST = 0.3  # n·h from which on facets count as much as that: few rays go through them


class Glass(NamedTuple):
    """A transparent body.

    Attributes
    ----------
    refraction : float
        Index within over that outside.
    frosting : float
        Slope α of its facets.
    rays : int
        Of each sample, through facets that it shows.
    walls : int
        That each meets at most.
    """

    refraction: float
    frosting: float
    rays: int
    walls: int = WALLS


def through_glass(
    space: ScaleSpace,
    eye: Single,
    glass: Glass,
    *,
    lights: Sequence[Light] = (),
    aligned: Turned | None = None,
    transmitted: float = 0.0,
    skies: Sequence[Environment | None] = (),
    background: float = 0.0,
) -> Single:
    """Return what samples show of lights and skies behind the body.

    Parameters
    ----------
    space : ScaleSpace
    eye : (3, n) array
        Towards the eye, which no normal turns away from.
    glass : Glass
    lights : sequence of Light
    aligned : callable, optional
        Given where most of the line of sight leaves (3, k) of samples [begin, end), returns what
        turns a light there: (3, k).
    transmitted : float
        Weight of the lights.
    skies : sequence of Environment or None
        What lies behind; None is an even white.
    background : float
        Weight of the skies.

    Returns
    -------
    (n, 3) array, (n, 1) where nothing has a colour
    """
    from meshdepict.transport.rays import RaySet, lifted
    from meshdepict.transport.walls import turning

    # What stands beside a body has no walls of it.
    surface, own = space.own_surface, space.normals_at(0)
    normals = own if space.at_vertices else surface.normals
    colors = [light.color for light in lights if transmitted]
    gray = all(np.ptp(color) == 0 for color in colors)
    gray &= all(sky is None or sky.gray for sky in skies if background)
    out = np.zeros((space.count, 1 if gray else 3), np.float32)
    points = surface.recentred(space.points)
    lifts = lifted(points, own)
    apart = surface.edge_length / (surface.diagonal or 1.0)
    bent = np.asarray(space.of_vertices(turning(surface, normals)), np.float32)
    facets = RaySet(glass.rays, lambda share: facet_height(share, glass.frosting**2))
    batch = max(1, _AT_ONCE // glass.rays)

    def work(begin: int, end: int) -> None:
        here = slice(begin, end)
        towards = eye[:, here].T.astype(np.float64)
        entered = _entered(facets, points[here], lifts[here], own[here], towards, glass)
        sight = _sight(
            entered, bent[here], apart, surface, normals, points[here], lifts[here], glass
        )
        found = out[here]
        if transmitted:
            turn = None if aligned is None else aligned(_leaving(sight, entered), begin, end)
            for light in lights:
                to = (
                    np.broadcast_to(light.direction.astype(np.float32)[:, None], (3, end - begin))
                    if turn is None
                    else turn(light)
                )
                color = light.color.astype(np.float32) * np.float32(transmitted)
                found += _lamp(sight, entered.weight, to, glass)[:, None] * color[: out.shape[1]]
        for sky in skies if background else ():
            shown = _behind(sight, entered.weight, sky, glass)
            found += np.float32(background) * shown[:, : out.shape[1]]

    each(work, spans(space.count, -(-space.count // batch)))
    return out


class _Entered(NamedTuple):
    directions: Single  # (k · rays, 3)
    weight: Single  # (k, rays), of what each ray brings: at most 1 in all


def facet_height(share: NDArray[Any], a2: float) -> NDArray[np.float64]:
    """Return cosines n·h of facets by how much of D n·h is steeper: `transmission.facet_density`.

    Below c lies α² c⁴ / (1 − (1 − α²) c²).
    """
    below = np.clip(1 - np.asarray(share, np.float64), 0, 1)
    steep = (1 - a2) * below
    squared = 2 * below / np.maximum(steep + np.sqrt(steep**2 + 4 * a2 * below), 1e-300)
    return np.sqrt(np.clip(squared, 0, 1))


def _entered(
    facets: Any,
    points: NDArray[np.float64],
    lifts: NDArray[Any],
    normals: Single,
    eye: NDArray[np.float64],
    glass: Glass,
) -> _Entered:
    """Return the line of sight behind facets, which count as the eye sees them."""
    from meshdepict.transport.rays import FIRST

    axes = normals.astype(np.float64)
    half = facets.leaving(points, lifts, axes, FIRST).directions.astype(np.float64)
    c = np.einsum("ikj,ij->ik", half, eye)
    steep = np.einsum("ikj,ij->ik", half, axes)
    ratio = 1 / glass.refraction
    seen = np.maximum(c, 0)
    lean = ratio * seen - np.sqrt(1 + ratio**2 * (seen**2 - 1))
    through = lean[..., None] * half - ratio * eye[:, None]
    inward = np.einsum("ikj,ij->ik", through, axes) < 0
    share = np.where(inward, seen / np.maximum(steep, _STEEPEST), 0)
    total = share.sum(axis=1, keepdims=True)
    share = share / np.where(total > 0, total, 1)
    weight = share * (1 - fresnel(np.minimum(seen, 1), glass.refraction))
    size = np.linalg.norm(through, axis=2, keepdims=True)
    through = through / np.where(size > 0, size, 1)
    through = np.where(inward[..., None], through, -axes[:, None])
    return _Entered(through.reshape(-1, 3).astype(np.float32), weight.astype(np.float32))


def _sight(
    entered: _Entered,
    bent: Single,
    apart: float,
    surface: Any,
    normals: NDArray[Any],
    points: NDArray[np.float64],
    lifts: NDArray[Any],
    glass: Glass,
) -> Any:
    """Follow the line of sight from wall to wall."""
    from meshdepict.transport.inner_paths import inner_paths
    from meshdepict.transport.paths import starting

    at = np.repeat(np.arange(len(points)), glass.rays)
    starts = starting(points[at], lifts[at], entered.directions, below=True)
    bends = 1 - 1 / glass.refraction
    between = glass.frosting * math.sqrt(2 * math.pi / glass.rays)  # facets of two rays
    turn = bends * np.hypot(bent[at] * apart, between)
    return inner_paths(
        surface, starts, entered.directions, normals=normals, refraction=glass.refraction,
        walls=glass.walls, cones=(np.full(len(at), apart), turn),
    )  # fmt: skip


def _leaving(sight: Any, entered: _Entered) -> Single:
    """Return where the line of sight leaves on the whole (3, k)."""
    count, rays = entered.weight.shape
    weight = entered.weight.ravel()
    total = sight.directions * (sight.rest * weight)[:, None]
    for wall in sight.walls:
        total[wall.ray] += wall.leaving * (wall.share * wall.let_out * weight[wall.ray])[:, None]
    mean = total.reshape(count, rays, 3).sum(axis=1)
    whole = entered.weight.sum(axis=1, keepdims=True)
    mean = mean / np.where(whole > 0, whole, 1)
    # Where rays leave to all sides, that is none: then it is where they went within.
    went = (entered.directions * weight[:, None]).reshape(count, rays, 3).sum(axis=1)
    went = went / np.maximum(np.linalg.norm(went, axis=1, keepdims=True), 1e-6)
    mean = mean + (1 - np.linalg.norm(mean, axis=1, keepdims=True)) * went
    size = np.linalg.norm(mean, axis=1, keepdims=True)
    found = np.where(size > 1e-6, mean / np.where(size > 1e-6, size, 1), went)
    return np.ascontiguousarray(found.T, np.float32)


def _behind(sight: Any, weight: Single, sky: Environment | None, glass: Glass) -> Single:
    """Return what of a sky comes (k, 3) along the line of sight."""
    count, rays = weight.shape
    if sky is None:
        return np.repeat(weight.sum(axis=1)[:, None], 3, axis=1)
    flat = weight.ravel()
    bend = glass.frosting * (glass.refraction - 1)
    total = sky.lookup(sight.directions, blur=_blur(0, sight.spread))
    total *= (sight.rest * flat)[:, None]
    inner = 0.0
    for wall in sight.walls:
        light = sky.lookup(wall.leaving, blur=_blur(bend**2 + inner, wall.spread))
        total[wall.ray] += light * (wall.share * wall.let_out * flat[wall.ray])[:, None]
        inner += (2 * glass.refraction * glass.frosting) ** 2
    return total.reshape(count, rays, 3).sum(axis=1)


def _blur(variance: float, spread: Single) -> Single:
    return np.sqrt(variance + (FILTER * spread) ** 2)


def _lamp(sight: Any, weight: Single, lights: Single, glass: Glass) -> Single:
    """Return what of a light (3, k) comes (k,) by the lobes of the walls."""
    from meshdepict.shading.exit_kernel import sum_exits

    count, rays = weight.shape
    total, flat = np.zeros(count, np.float32), weight.ravel()
    # A wall's facets stand for those of the walls around, too, which neighbouring rays meet.
    bend = max(glass.refraction - 1, 1e-3)
    for wall in sight.walls:
        slope = glass.frosting**2 + (FILTER / bend * wall.spread) ** 2
        sum_exits(
            wall.ray, wall.arriving, wall.normal, wall.share * flat[wall.ray], lights,
            np.float32(glass.refraction), np.minimum(slope, 1).astype(np.float32), rays, total,
        )  # fmt: skip
    return total
