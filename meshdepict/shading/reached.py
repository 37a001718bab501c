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
from meshdepict.shading.gathering import PLAIN, Gathering, Gathers, fallen
from meshdepict.transport.radiosity import bounced
from meshdepict.transport.rays import AGAIN, MOST_RAYS, probed

if TYPE_CHECKING:
    from meshdepict.scales.company import Company

__all__ = [
    "USUAL_RAYS",
    "Bounces",
    "LightRays",
    "Reached",
    "Shadows",
    "added",
    "ray_count",
    "reached",
    "sent_to_all",
]

Single = NDArray[np.float32]
Shares = tuple[Single | None, ...]

Shadows = Annotated[bool, Flag(help="whether lights cast shadows")]
Bounces = Annotated[
    int, Range(0, 1000, help="how often light goes on from surface to surface", soft=(0, 5))
]
LightRays = Annotated[
    int,
    Range(2, MOST_RAYS, help="of each sample, to discs, the sky and what bounces", soft=(16, 1024)),
]


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


def ray_count(*, shadows: bool, bounces: int, rays: int) -> int:
    """Return how many rays of each sample a method declares under such options."""
    return rays if bounces else int(shadows)


def reached(
    space: ScaleSpace,
    lights: Sequence[Light],
    environments: Sequence[Environment] = (),
    *,
    shadows: bool,
    bounces: int,
    rays: int,
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
        The options of these names.
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
    seen: Shares = (None,) * len(lights)
    if not (shadows or bounces):
        return Reached(seen)
    if shadows:
        seen = tuple(space.seen_share(light, rays=rays) for light in lights)
    soft = shadows and any(light.spread for light in lights)
    if not (bounces or environments):
        if soft:
            places = space.surface.recentred(space.points), space.normals_at(0)
            chosen = probed(len(space.points))
            own, at = gathering.at(chosen), (places[0][chosen], places[1][chosen])
            seen_once: Shares = tuple(one if one is None else one[chosen] for one in seen)
            seen_again = tuple(
                space.seen_share(each, rays=rays, at=at, steps=AGAIN) for each in lights
            )
            _record(
                space, rays, shown(fallen(own, at[1], lights, seen_once)),
                shown(fallen(own, at[1], lights, seen_again)),
            )  # fmt: skip
        return Reached(seen)

    transfer = gathering.traced(space, rays)
    at = transfer.points, transfer.normals
    falling = seen
    if shadows and not space.at_vertices:
        falling = tuple(space.seen_share(light, rays=rays, at=at) for light in lights)
    first = gathering.along(transfer)
    skies, lamps = _parted(environments)
    lit = tuple(space.seen_share(lamp, at=at) for lamp in lamps)
    shone = fallen(gathering, at[1], lamps, lit)
    around = added(_sky(first, skies), shone)
    sent: Single | None = None
    if bounces:
        if space.company is None:
            inner = inside.along(transfer if inside is gathering else inside.traced(space, rays))
            start = _start(inside, inner, at[1], (lights, falling), skies, (lamps, lit))
            reflected = albedo if space.tints is None else np.float32(albedo) * space.tints
            _, sent = bounced(inner, start, albedo=reflected, bounces=bounces)
        else:
            sent = sent_to_all(
                space.company, lights, environments, shadows=shadows, bounces=bounces, rays=rays
            )
        around = added(around, first.from_surface(sent))
    if probes := transfer.probes:
        chosen = probes.chosen
        own = gathering.at(chosen)
        second = own.along(probes.transfer, again=True)
        places = transfer.points[chosen], transfer.normals[chosen]
        known: Shares = tuple(share if share is None else share[chosen] for share in falling)
        others: Shares = known
        if soft:
            others = tuple(
                space.seen_share(each, rays=rays, at=places, steps=AGAIN) for each in lights
            )
        again = added(_sky(second, skies), shone[chosen])
        if sent is not None:
            again = added(again, second.from_surface(sent))
        values, again = (
            shown(added(fallen(own, places[1], lights, shares), rest))
            for shares, rest in ((known, around[chosen]), (others, again))
        )
        if sent is not None and space.tints is not None:
            values, again = (_tinted(each, space.tints[chosen]) for each in (values, again))
        _record(space, rays, values, again)
    return Reached(seen, space.of_vertices(around).astype(np.float32), sent)


def sent_to_all(
    company: Company,
    lights: Sequence[Light],
    environments: Sequence[Environment],
    *,
    shadows: bool,
    bounces: int,
    rays: int,
) -> Single:
    """Return what the vertices of all objects that stand together send on; see `sent_together`."""
    skies, lamps = _parted(environments)

    def start(gathering: Gathering, inner: Gathers, normals: Any, *seen: Any) -> Single:
        return _start(gathering, inner, normals, (lights, seen[0]), skies, (lamps, seen[1]))

    return sent_together(
        company, lights, skies, lamps, shadows=shadows, bounces=bounces, rays=rays, start=start
    )


def _parted(environments: Sequence[Environment]) -> tuple[list[Environment], list[Light]]:
    """Return skies, and lights that stand for lamps in them."""
    from meshdepict.transport.sky_cells import parted_sky

    parts = [parted_sky(environment) for environment in environments]
    return [sky for sky, _ in parts], [lamp for _, some in parts for lamp in some]


def _start(
    gathering: Gathering,
    inner: Gathers,
    normals: NDArray[Any],
    lights: tuple[Sequence[Light], Sequence[Single | None]],
    skies: Sequence[Environment],
    lamps: tuple[Sequence[Light], Sequence[Single | None]],
) -> Single:
    """Return E_0 of lights, each as it is seen, of skies, and of the lamps in them."""
    direct = added(fallen(gathering, normals, *lights), _sky(inner, skies))
    return added(direct, fallen(gathering, normals, *lamps))


def _sky(transfer: Gathers, environments: Sequence[Environment]) -> Single:
    """Return what comes from environments; in colour where one of them has any."""
    total = np.zeros(len(transfer), np.float32)
    for environment in environments:
        sky = transfer.from_sky(environment)
        total = added(total, sky[:, 0] if environment.gray else sky)
    return total


def added(one: Single, other: Single) -> Single:
    """Return the sum of two results, in colour where either is."""
    if one.ndim == other.ndim:
        return one + other
    return one + other[:, None] if one.ndim == 2 else one[:, None] + other


def _tinted(shown: NDArray[Any], tints: Single) -> NDArray[Any]:
    """Return what is displayed (k,) or (k, 3) on surfaces of a colour, as it is shown at last."""
    light = srgb_to_linear(shown)
    return np.asarray(linear_to_srgb((light if light.ndim == 2 else light[:, None]) * tints))


def _record(space: ScaleSpace, rays: int, values: NDArray[Any], again: NDArray[Any]) -> None:
    """Keep the error that two independent results tell, in grey levels."""
    difference = 255 * (np.asarray(values, np.float64) - again)
    space.light_errors[rays] = float(np.sqrt(np.mean(difference**2) / 2)) if len(values) else 0.0
