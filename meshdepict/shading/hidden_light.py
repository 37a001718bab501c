"""Light on a material, as much of it as samples see, and what comes to them by other ways."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import AshikhminShirley, CookTorrance, Material, Phong
from meshdepict.shading.direct import direct
from meshdepict.shading.reached import Reached, added

__all__ = ["hidden_direct"]

Single = NDArray[np.float32]


def hidden_direct(
    space: ScaleSpace,
    lights: Sequence[Light],
    eyes: Single,
    material: Material,
    reach: Reached,
    *,
    environments: Sequence[Environment] = (),
    count: int = 54,
    **settings: Any,
) -> Single:
    """Return what `direct` does, each light as much as it is seen; without what came around.

    Where light came around, the matt part of the environments is in it: of them highlights alone
    are left, which nothing hides.

    Parameters
    ----------
    space, lights, eyes, material, environments, count, **settings
        As for `direct`.
    reach : Reached
        Of these lights and environments.

    Returns
    -------
    (n,) array, (n, 3) where a light is coloured
    """
    around = reach.around is not None
    if not around and all(share is None for share in reach.seen):
        return direct(
            space, lights, eyes, material, environments=environments, count=count, **settings
        )
    total = np.zeros(len(space.points), np.float32)
    for light, share in zip(lights, reach.seen, strict=True):
        part = direct(space, [light], eyes, material, **settings)
        total = added(total, part if share is None else (part.T * share).T)
    if environments and (glossy := _glossy(material)) is not None:
        part = direct(space, [], eyes, glossy, environments=environments, count=count, **settings)
        total = added(total, part)
    return total


def _glossy(material: Material) -> Material | None:
    """Return a material without its matt part; None where that is all."""
    if isinstance(material, (Phong, CookTorrance, AshikhminShirley)):
        return replace(material, diffuse=0.0)
    return None
