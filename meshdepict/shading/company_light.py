"""Light that bounces among objects that stand together, each of a material of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading.first_light import along, first_light, skies_and_lamps
from meshdepict.shading.gathering import Gathers
from meshdepict.transport.radiosity import sent_on
from meshdepict.transport.shadows import seen_share

if TYPE_CHECKING:
    from meshdepict.scales.company import Company

__all__ = ["sent_together"]

Single = NDArray[np.float32]


def sent_together(
    company: Company,
    lights: Sequence[Light],
    environments: Sequence[Environment],
    *,
    shadows: bool,
    bounces: int,
    rays: int,
) -> Single:
    """Return what the vertices of all objects send on, (v,) or (v, 3), before the last bounce.

    It is found once for all objects that ask for the same.

    Parameters
    ----------
    company : Company
    lights, environments, shadows, bounces, rays
        As for `reached`.
    """
    key = (
        tuple((*light.direction, *light.color, light.spread) for light in lights),
        tuple(map(id, environments)), shadows, bounces, rays,
    )  # fmt: skip

    def find() -> tuple[Single, Sequence[Environment]]:
        found = _sent(company, lights, environments, shadows=shadows, bounces=bounces, rays=rays)
        return found, environments  # which keep their number as long as the key is known

    sent, _ = company.once(key, find)
    return np.asarray(sent, np.float32)


def _sent(
    company: Company,
    lights: Sequence[Light],
    environments: Sequence[Environment],
    *,
    shadows: bool,
    bounces: int,
    rays: int,
) -> Single:
    surface = company.surface
    skies, lamps = skies_and_lamps(environments)
    parts: list[tuple[slice, Gathers]] = []
    starts: list[tuple[slice, Single, Any]] = []
    for member, (albedo, gathering) in company.sendings.items():
        if not np.any(albedo):
            continue
        transfer = company.transport(rays, member)
        at = transfer.points, transfer.normals

        def seen(light: Light, at: tuple[Any, Any] = at) -> Single:
            return seen_share(surface, light.direction, at=at, spread=light.spread, rays=rays)

        falling = [seen(light) if shadows else None for light in lights]
        lit = [seen(lamp) for lamp in lamps]
        inner = along(gathering, transfer)
        start = first_light(gathering, inner, at[1], (lights, falling), skies, (lamps, lit))
        parts.append((surface.parts[member], inner))
        starts.append((surface.parts[member], start, albedo))
    count = len(surface.vertices)
    coloured = any(start.ndim == 2 or np.ndim(albedo) == 2 for _, start, albedo in starts)
    light = np.zeros((count, 3) if coloured else count, np.float32)
    reflected = np.zeros((count, 3) if coloured else count, np.float32)
    for part, start, albedo in starts:
        light[part] = start[:, None] if start.ndim < light.ndim else start
        reflected[part] = albedo
    return sent_on(_Together(parts, count), light, albedo=reflected, bounces=bounces)


class _Together:
    """What gathers light from a surface at the vertices of several objects."""

    def __init__(self, parts: Sequence[tuple[slice, Gathers]], count: int) -> None:
        self._parts, self._count = parts, count

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return what arrives at all vertices of what each sends."""
        out = np.zeros((self._count, *values.shape[1:]), np.float32)
        for part, gathers in self._parts:
            out[part] = gathers.from_surface(values)
        return out
