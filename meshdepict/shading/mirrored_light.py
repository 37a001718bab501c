"""What mirrors show of an environment, of each other and of what is matt beside them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.shading.company_light import sent_together
from meshdepict.threads import spans

__all__ = ["FILTER", "Matt", "lobe_blurs", "lobe_height", "mirrored_light"]

Single = NDArray[np.float32]
Scaled = Callable[[Single, Single], Single]

FILTER = 0.5
"""Of how far neighbours' rays are apart is the width of their blur."""

_AT_ONCE = 262_144  # rays whose light is looked up together: twenty megabytes
_SPREAD = 0.25  # of a blur's variance over the solid angle that a ray stands for; see `lobes`
_FARTHEST = 1e-7  # of a lobe lies beyond all rays
_LAST = 0.98  # share of a lobe's rays up to which they stand for less than all that is left of it


class Matt(NamedTuple):
    """What is matt beside mirrors.

    Attributes
    ----------
    mirrors : (m,) array of bool
        Which triangles of the surface are mirrors, and not matt.
    sent : (v,) or (v, 3) array
        What the vertices of the surface send to every side.
    """

    mirrors: NDArray[np.bool_]
    sent: Single


class _Mirrors(NamedTuple):
    """What rays are followed through."""

    space: ScaleSpace
    environment: Environment
    normals: NDArray[Any]
    apart: float
    apart_rays: Single
    roughness: float
    bounces: int
    hidden: bool
    matt: Matt | None
    scaled: tuple[Scaled, Single] | None


def mirrored_light(
    space: ScaleSpace,
    environment: Environment,
    directions: NDArray[Any],
    *,
    roughness: float,
    shadows: bool,
    bounces: int,
    rays: int,
    matt: Matt | None = None,
    scaled: tuple[Scaled, Single] | None = None,
) -> Single:
    """Return the radiance (n, 3) that comes to samples from where their mirrors look.

    A smooth mirror has one ray, which is mirrored up to so many times. A rough one has several in
    its lobe; where those are mirrored again, their lobes are blur of the environment.

    Parameters
    ----------
    space : ScaleSpace
    environment : Environment
    directions : (n, 3) array
        Unit. Those that go below a sample's own horizon are looked up, whatever hides them.
    roughness : float
        Width of the lobe in radians.
    shadows : bool
        Whether a ray that was mirrored so often is hidden by what it meets then.
    bounces : int
    rays : int
        In the lobe.
    matt : Matt, optional
        Of a surface by itself all is mirror unless given; of what stands together each says so.
    scaled : a function and a (v,) array, optional
        Light (k, 3) as a mirror of curvature (k,) scales it, and the curvature of the vertices.

    Returns
    -------
    (n, 3) array of float32
    """
    from meshdepict.transport.paths import starting
    from meshdepict.transport.rays import FIRST, RaySet, lifted
    from meshdepict.transport.walls import turning

    if space.company is not None:
        space.company.hear_mirror(space)
        matt = matt or _beside(space, environment, shadows=shadows, bounces=bounces, rays=rays)
    surface, own, normals = space.surface, space.normals_at(0), space.surface_normals
    apart = space.own_surface.edge_length / (surface.diagonal or 1.0)
    bent = np.asarray(space.of_surface(turning(surface, normals)), np.float32)
    scene = _Mirrors(
        space, environment, normals, apart, 2 * bent * np.float32(apart), roughness, bounces,
        shadows, matt, scaled,
    )  # fmt: skip
    points = surface.recentred(space.ray_points())
    lifts = lifted(points, own)
    looks = np.ascontiguousarray(directions, np.float32)
    out = environment.lookup(looks, blur=roughness)
    above = np.flatnonzero(np.einsum("ij,ij->i", looks, own) > 0)
    if not roughness:
        starts = starting(points[above], lifts[above], looks[above])
        out[above] = _arriving(scene, above, starts, looks[above], np.zeros(1))
        return out
    # A von Mises–Fisher lobe, as `Environment.lookup` blurs by, less the blur of every ray.
    blurs = lobe_blurs(roughness, rays)
    narrow = roughness**2 - float(np.mean(blurs**2))
    lobe = RaySet(rays, lambda share: lobe_height(share, math.sqrt(max(narrow, 1e-12))))
    for begin, end in spans(len(above), -(-len(above) * rays // _AT_ONCE)):
        here = above[begin:end]
        axes = looks[here].astype(np.float64)
        bundle = lobe.leaving(points[here], lifts[here], axes, FIRST)
        towards = _kept_above(bundle.directions, own[here])
        starts = starting(
            np.repeat(points[here], rays, axis=0), np.repeat(lifts[here], rays, axis=0), towards
        )
        out[here] = _arriving(scene, here, starts, towards, blurs).reshape(-1, rays, 3).mean(axis=1)
    return out


def lobe_height(share: NDArray[Any], width: float) -> NDArray[Any]:
    """Return cosines to the axis of a von Mises–Fisher lobe, by how much of it is nearer."""
    outer = 1 - np.asarray(share, np.float64) * -math.expm1(-2 / width**2)
    return np.maximum(1 + width**2 * np.log(np.maximum(outer, _FARTHEST)), -1)


def lobe_blurs(width: float, rays: int) -> NDArray[np.float64]:
    """Return by how much (rays,) each ray of a lobe is blurred: as far as it stands for."""
    share = np.minimum((np.arange(rays) + 0.5) / rays, _LAST)
    solid = 2 * math.pi * width**2 / (rays * (1 - share))
    return np.minimum(np.sqrt(_SPREAD * solid), width / 2)


def _beside(
    space: ScaleSpace, environment: Environment, *, shadows: bool, bounces: int, rays: int
) -> Matt:
    """Return what is matt of all that stands together, and sends on light of the environment."""
    company = space.company
    assert company is not None
    sent = np.zeros(len(company.surface.vertices), np.float32)
    if bounces:
        sent = sent_together(
            company, [], [environment], shadows=shadows, bounces=bounces, rays=rays
        )
    return Matt(company.mirror_faces, sent)


def _kept_above(directions: Single, normals: Single) -> Single:
    """Return directions (n, rays, 3) in one row, mirrored in the tangent plane if below it."""
    under = np.minimum(np.einsum("ikj,ij->ik", directions, normals), 0)
    return (directions - 2 * under[..., None] * normals[:, None]).reshape(-1, 3)


def _arriving(
    scene: _Mirrors,
    samples: NDArray[np.int64],
    starts: Single,
    directions: Single,
    blurs: NDArray[np.float64],
) -> Single:
    """Return what comes (n, 3) along rays, every so many of which are blurred alike."""
    from meshdepict.transport.paths import AWAY, mirrored_paths
    from meshdepict.transport.walls import between

    surface, matt = scene.space.surface, scene.matt
    each = len(blurs)
    paths = mirrored_paths(
        surface, starts, directions, normals=scene.normals,
        mirrors=None if matt is None else matt.mirrors, bounces=scene.bounces, hidden=scene.hidden,
        cones=(np.full(len(starts), scene.apart), np.repeat(scene.apart_rays[samples], each)),
    )  # fmt: skip
    found = np.zeros((len(starts), 3), np.float32)
    times = np.zeros(len(starts))
    for met in paths.mirrored:
        times[met.ray] += 1
    variance = np.tile(blurs**2, len(samples)) + times * scene.roughness**2
    # Of what was mirrored again neighbours see other parts: as a picture that is made smaller.
    variance += np.where(times > 0, (FILTER * paths.spread) ** 2, 0)
    away = np.flatnonzero(paths.triangle == AWAY)
    blur = np.sqrt(variance[away])
    found[away] = scene.environment.lookup(paths.directions[away], blur=blur)
    if matt is not None:
        at = np.flatnonzero(paths.triangle >= 0)
        sent = between(matt.sent, surface.faces[paths.triangle[at]], paths.weights[at])
        found[at] = sent if sent.ndim == 2 else sent[:, None]
    if scene.scaled is not None:
        scaled, bend = scene.scaled
        for met in reversed(paths.mirrored):
            there = between(bend, surface.faces[met.triangle], met.weights)
            found[met.ray] = scaled(found[met.ray], there)
    return found
