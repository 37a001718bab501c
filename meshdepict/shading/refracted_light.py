"""What a refractive body shows of an environment through two interfaces and more."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.material import Refractive
from meshdepict.shading.mirrored_light import FILTER, lobe_blurs, lobe_height
from meshdepict.threads import spans

__all__ = ["refracted_light"]

Single = NDArray[np.float32]

_AT_ONCE = 65_536  # rays


def refracted_light(
    space: ScaleSpace,
    environment: Environment,
    directions: NDArray[Any],
    material: Refractive,
    *,
    bounces: int,
    rays: int,
) -> Single:
    """Return the radiance (n, 3) that comes to samples through the body, all of it let in.

    Each ray leaves by the walls that it meets within, as much as Fresnel says, up to ``bounces`` of
    them; what is left then goes on as it is going.

    Parameters
    ----------
    space : ScaleSpace
    environment : Environment
    directions : (n, 3) array
        Unit, of the refracted line of sight. Those that don't go inward are looked up.
    material : Refractive
        A rough one bends rays to all sides at every wall.
    bounces : int
        At least 1.
    rays : int
        Of a rough one's lobe; a smooth one has a single ray.
    """
    from meshdepict.transport.inner_paths import inner_paths
    from meshdepict.transport.paths import starting
    from meshdepict.transport.rays import FIRST, RaySet, lifted
    from meshdepict.transport.walls import turning

    # What stands beside a body has no walls of it.
    surface, own = space.own_surface, space.normals_at(0)
    normals = own if space.at_vertices else surface.normals
    points = surface.recentred(space.points)
    lifts = lifted(points, own)
    looks = np.ascontiguousarray(directions, np.float32)
    rough, ratio = material.roughness, material.refraction
    out = environment.lookup(looks, blur=rough)
    inward = np.flatnonzero(np.einsum("ij,ij->i", looks, own) < 0)
    apart = surface.edge_length / (surface.diagonal or 1.0)
    bent = np.asarray(space.of_vertices(turning(surface, normals)), np.float32)
    count = rays if rough else 1
    blurs = lobe_blurs(rough, count) if rough else np.zeros(1)
    narrow = math.sqrt(max(rough**2 - float(np.mean(blurs**2)), 1e-12))
    lobe = RaySet(max(count, 2), lambda share: lobe_height(share, narrow))
    for begin, end in spans(len(inward), -(-len(inward) * count // _AT_ONCE)):
        here = inward[begin:end]
        towards = looks[here]
        at = np.repeat(here, count)
        if rough:
            axes = towards.astype(np.float64)
            found = lobe.leaving(points[here], lifts[here], axes, FIRST).directions
            over = np.maximum(np.einsum("ikj,ij->ik", found, own[here]), 0)
            towards = (found - 2 * over[..., None] * own[here][:, None]).reshape(-1, 3)
        paths = inner_paths(
            surface, starting(points[at], lifts[at], towards, below=True), towards,
            normals=normals, refraction=ratio, walls=bounces,
            cones=(np.full(len(at), apart), (1 - 1 / ratio) * bent[at] * apart),
        )  # fmt: skip
        own_blur = np.tile(blurs**2, len(here))
        total = environment.lookup(
            paths.directions, blur=np.sqrt(own_blur + (FILTER * paths.spread) ** 2)
        )
        total *= paths.rest[:, None]
        for number, wall in enumerate(paths.walls):
            variance = own_blur[wall.ray] + (number + 1) * rough**2 + (FILTER * wall.spread) ** 2
            light = environment.lookup(wall.leaving, blur=np.sqrt(variance))
            total[wall.ray] += light * (wall.share * wall.let_out)[:, None]
        out[here] = total.reshape(-1, count, 3).mean(axis=1)
    return out
