"""What reaches samples before it bounces: lights, as they are seen, skies and the lamps in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading.gathering import Gathering, Gathers, fallen

if TYPE_CHECKING:
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["added", "along", "first_light", "from_skies", "skies_and_lamps"]

Single = NDArray[np.float32]
Seen = tuple[Sequence[Light], Sequence[Single | None]]


def first_light(
    gathering: Gathering,
    rays: Gathers,
    normals: NDArray[Any],
    lights: Seen,
    skies: Sequence[Environment],
    lamps: Seen,
) -> Single:
    """Return E_0, (n,) or (n, 3), as something gathers it.

    Parameters
    ----------
    gathering : Gathering
    rays : Gathers
        What gathers light of the sky so.
    normals : (n, 3) array
    lights, lamps : pairs
        Lights, and which share of each is seen.
    skies : sequence of Environment
        Without their lamps.
    """
    direct = added(fallen(gathering, normals, *lights), from_skies(rays, skies))
    return added(direct, fallen(gathering, normals, *lamps))


def skies_and_lamps(
    environments: Sequence[Environment],
) -> tuple[list[Environment], list[Light]]:
    """Return skies, and lights that stand for the lamps in them."""
    from meshdepict.transport.sky_cells import parted_sky

    parts = [parted_sky(environment) for environment in environments]
    return [sky for sky, _ in parts], [lamp for _, some in parts for lamp in some]


def from_skies(rays: Gathers, skies: Sequence[Environment]) -> Single:
    """Return what comes from skies; in colour where one of them has any."""
    total = np.zeros(len(rays), np.float32)
    for each in skies:
        sky = rays.from_sky(each)
        total = added(total, sky[:, 0] if each.gray else sky)
    return total


def along(gathering: Gathering, transfer: Transfer | Retraced, *, again: bool = False) -> Gathers:
    """Return what gathers light along rays, kept or not."""
    from meshdepict.transport.retraced import InParts, Retraced

    if not isinstance(transfer, Retraced):
        return gathering.along(transfer, again=again)
    return InParts(transfer, lambda part, here: gathering.at(here).along(part, again=again))


def added(one: Single, other: Single) -> Single:
    """Return the sum of two results, in colour where either is."""
    if one.ndim == other.ndim:
        return one + other
    return one + other[:, None] if one.ndim == 2 else one[:, None] + other
