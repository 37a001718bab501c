"""What reaches samples: lights that cast shadows, a sky behind hills, light that bounces.

Declared here once for every method with a material: `Shadows`, `Bounces` and `LightRays` are its
options, `reached` what it asks for. With all of them off nothing is traced.

Shadows hide each light by V, the share of it that a sample sees. Light bounces between matt
surfaces: E_k = E_0 + T ρ E_{k−1}, E_0 what lights and the sky give directly, in which ρ is what the
method's material reflects diffusely, times the colours of the surface where they are kept. Bounces
without shadows let every light through to where it falls first, as without them; from there on
surfaces are in each other's way as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.options import Flag, Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading.company_light import sent_together
from meshdepict.shading.first_light import (
    added,
    along,
    first_light,
    from_skies,
    skies_and_lamps,
)
from meshdepict.shading.gathering import PLAIN, Gathering, Gathers, fallen
from meshdepict.shading.sampled import AUTO_RAYS, FIRST_RAYS, enough
from meshdepict.shading.smoothed_light import calmed
from meshdepict.transport.radiosity import sent_on
from meshdepict.transport.rays import AGAIN, MOST_RAYS, probed

if TYPE_CHECKING:
    pass

__all__ = [
    "USUAL_RAYS",
    "Bounces",
    "Denoise",
    "LightRays",
    "RaysOfAll",
    "Reached",
    "Shadows",
    "ray_count",
    "reached",
]

Single = NDArray[np.float32]
Shares = tuple[Single | None, ...]

Shadows = Annotated[bool, Flag(help="whether lights cast shadows")]
Bounces = Annotated[
    int, Range(0, 1000, help="how often light goes on from surface to surface", soft=(0, 5))
]
Denoise = Annotated[
    float,
    Range(
        0, 255, soft=(0, 5),
        help="grey levels of noise from which on light that came by rays is smoothed; 0: never",
    ),
]  # fmt: skip
LightRays = Annotated[
    int | str,
    Range(
        2, MOST_RAYS, help="of each sample, to discs, the sky and what bounces", soft=(16, 1024),
        words=(AUTO_RAYS,),
    ),
]  # fmt: skip


RaysOfAll = Annotated[
    int | str,
    Range(
        0, MOST_RAYS, soft=(0, 256), words=(AUTO_RAYS,),
        help="of each sample: of precomputed light, to discs, the sky and what bounces",
    ),
]  # fmt: skip
"""Of methods that also take light from all around at once; 0: what is usual for each."""

USUAL_RAYS = 64
"""What `LightRays` is unless given."""


class Reached(NamedTuple):
    """What reaches samples of some lights.

    Attributes
    ----------
    seen : tuple of (n,) arrays, or of None
        V of every light: the share that each sample sees; None: all.
    around : (n,) or (n, 3) array, optional
        E_k − E_0 of the lights: from the sky and by bounces, in units of a cosine. None: nothing.
    sent : (v,) or (v, 3) array, optional
        B_{k−1} of the vertices of the surface, of all objects that stand together, which the last
        bounce brought. None: no bounce.
    """

    seen: Shares
    around: Single | None = None
    sent: Single | None = None


def ray_count(*, shadows: bool, bounces: int, rays: int | str) -> int:
    """Return how many rays of each sample a method declares under such options, at least."""
    if not bounces:
        return int(shadows)
    return FIRST_RAYS if rays == AUTO_RAYS else int(rays)


def reached(
    space: ScaleSpace,
    lights: Sequence[Light],
    environments: Sequence[Environment] = (),
    *,
    shadows: bool,
    bounces: int,
    rays: int | str,
    denoise: float = 0.0,
    albedo: float,
    shown: Callable[[NDArray[Any]], NDArray[Any]],
    gathering: Gathering = PLAIN,
) -> Reached:
    """Return what samples see of lights, and what comes to them by other ways.

    Where anything is sampled, how far it is off is kept in the space's ``light_errors``.

    Parameters
    ----------
    space : ScaleSpace
    lights : sequence of Light
    environments : sequence of Environment
        Their light comes by rays that get away, and of lamps in them by rays to those: all of it is
        ``around``.
    shadows, bounces, rays
        The options of these names. As many rays as it takes, "auto", are 64, or twice as many as
        often as needed; see `sampled.enough`.
    denoise : float
        Grey levels of error from which on light of the sky and of bounces is smoothed between
        neighbours, as far as makes it better; see `smoothed_light`. Discs and lamps are not.
    albedo : float
        What matt surfaces send on, times the space's ``tints`` where it has any.
    shown : callable
        What the method displays, in [0, 1], where so much light arrives.
    gathering : Gathering
        What the method makes of light at the vertices of the surface: ``around`` is gathered so.
        Where nothing comes around, at the samples: only the error is told by it then.

    Raises
    ------
    MeshdepictError
        For samples that are no part of a surface.
    """
    inside = gathering if gathering.everywhere else PLAIN  # for what is sent on
    if space.company is not None:
        space.company.hear(space, albedo, inside)
    if not (shadows or bounces):
        return Reached((None,) * len(lights))

    def sampled(count: int) -> Reached:
        return _sampled(
            space, lights, environments, shadows=shadows, bounces=bounces, rays=count,
            denoise=denoise, albedo=albedo, shown=shown, gathering=gathering,
        )  # fmt: skip

    return enough(space, sampled) if rays == AUTO_RAYS else sampled(int(rays))


def _sampled(
    space: ScaleSpace,
    lights: Sequence[Light],
    environments: Sequence[Environment],
    *,
    shadows: bool,
    bounces: int,
    rays: int,
    denoise: float,
    albedo: float,
    shown: Callable[[NDArray[Any]], NDArray[Any]],
    gathering: Gathering,
) -> Reached:
    """Return what `reached` does, by a number of rays."""
    seen: Shares = (None,) * len(lights)
    if shadows:
        seen = tuple(space.seen_share(light, rays=rays) for light in lights)
    soft = shadows and any(light.spread for light in lights)
    if not (bounces or environments):
        if soft:
            places = space.surface.recentred(space.ray_points()), space.normals_at(0)
            chosen = probed(len(space.points))
            own, at = gathering.at(chosen), (places[0][chosen], places[1][chosen])
            seen_once: Shares = tuple(one if one is None else one[chosen] for one in seen)
            seen_again = tuple(
                space.seen_share(each, rays=rays, at=at, steps=AGAIN) for each in lights
            )
            once, again = (fallen(own, at[1], lights, each) for each in (seen_once, seen_again))
            space.light_errors[rays] = _apart(shown(once), shown(again))
        return Reached(seen)

    transfer = gathering.traced(space, rays)
    at = transfer.points, transfer.normals
    falling = seen
    if shadows and not space.at_vertices:
        falling = tuple(
            space.seen_share(light, rays=rays, at=at)
            if light.spread
            else space.seen_from_vertices([light])[0]
            for light in lights
        )
    inside = gathering if gathering.everywhere else PLAIN  # for what is sent on
    first = along(gathering, transfer)
    skies, lamps = skies_and_lamps(environments)
    lit = space.seen_from_vertices(lamps) if lamps else ()
    shone = fallen(gathering, at[1], lamps, lit)
    by_rays = from_skies(first, skies)
    around = added(by_rays, shone)
    sent: Single | None = None
    if bounces:
        if space.company is not None:
            sent = sent_together(
                space.company, lights, environments, shadows=shadows, bounces=bounces, rays=rays
            )
        else:
            if inside is gathering:
                inner: Gathers = first
                light = added(added(fallen(inside, at[1], lights, falling), by_rays), shone)
            else:
                # A single bounce of lights alone takes none of these rays.
                inner = (
                    first
                    if bounces == 1 and not skies
                    else along(inside, inside.traced(space, rays))
                )
                seen_lights, seen_lamps = (lights, falling), (lamps, lit)
                light = first_light(inside, inner, at[1], seen_lights, skies, seen_lamps)
            reflected = albedo if space.tints is None else np.float32(albedo) * space.tints
            sent = sent_on(inner, light, albedo=reflected, bounces=bounces)
        brought = first.from_surface(sent)
        by_rays, around = added(by_rays, brought), added(around, brought)
    if probes := transfer.probes:
        chosen = probes.chosen
        own = gathering.at(chosen)
        second = along(own, probes.transfer, again=True)
        places = transfer.points[chosen], transfer.normals[chosen]
        known: Shares = tuple(share if share is None else share[chosen] for share in falling)
        others: Shares = known
        if soft:
            others = tuple(
                space.seen_share(each, rays=rays, at=places, steps=AGAIN) for each in lights
            )
        again = added(from_skies(second, skies), shone[chosen])
        if sent is not None:
            again = added(again, second.from_surface(sent))
        tints = None if sent is None or space.tints is None else space.tints[chosen]

        def seen_as(light: Single) -> NDArray[Any]:
            return shown(light) if tints is None else _tinted(shown(light), tints)

        direct = fallen(own, places[1], lights, known)
        once, twice = seen_as(added(direct, around[chosen])), seen_as(added(direct, again))
        error = _apart(once, twice)
        whole = _apart(once, seen_as(added(fallen(own, places[1], lights, others), again)))
        if 0 < denoise < whole:

            def told(light: Single, left: float) -> float:
                smooth = seen_as(added(direct, added(light, shone)[chosen]))
                apart = float(np.mean((255 * (np.asarray(smooth, np.float64) - twice)) ** 2))
                # Of it the second set's own noise is no error of the first.
                off = max(apart - error**2, left * error**2)
                return math.sqrt(max(whole**2 - error**2, 0.0) + off)

            calm, whole = calmed(space.own_surface, at[1], by_rays, told, (denoise, whole))
            around = around if calm is by_rays else added(calm, shone)
        space.light_errors[rays] = whole
    return Reached(seen, space.of_vertices(around).astype(np.float32), sent)


def _tinted(shown: NDArray[Any], tints: Single) -> NDArray[Any]:
    """Return what is displayed (k,) or (k, 3) on surfaces of a colour, as it is shown at last."""
    light = srgb_to_linear(shown)
    return np.asarray(linear_to_srgb((light if light.ndim == 2 else light[:, None]) * tints))


def _apart(one: NDArray[Any], other: NDArray[Any]) -> float:
    """Return the rms error, in grey levels, of two independent results."""
    difference = 255 * (np.asarray(one, np.float64) - other)
    return float(np.sqrt(np.mean(difference**2) / 2)) if len(one) else 0.0
