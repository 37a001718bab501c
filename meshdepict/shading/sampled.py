"""As many rays as light takes: twice as many, until what they err can't be seen.

Rays of twice the number are other rays, so that each step begins anew: all steps together cost
twice the last one at most.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from meshdepict.scales.light_errors import FoundRays
from meshdepict.scales.space import ScaleSpace
from meshdepict.transport.rays import MOST_RAYS, ray_scene

__all__ = ["AUTO_RAYS", "AUTO_SECONDS", "FIRST_RAYS", "UNSEEN", "enough", "used_rays"]

Result = TypeVar("Result")

AUTO_RAYS = "auto"
"""What `LightRays` is called when it is to be found."""

FIRST_RAYS = 64
UNSEEN = 2.0
"""Grey levels, rms, that nobody sees."""

AUTO_SECONDS = 5.0
"""What the search for a number of rays may take, about."""


def used_rays(space: ScaleSpace, rays: int | str) -> int:
    """Return a number of rays; of as many as it takes, what the last light took."""
    if rays != AUTO_RAYS:
        return int(rays)
    found = space.light_errors.found
    return FIRST_RAYS if found is None else found.rays


def enough(space: ScaleSpace, sampled: Callable[[int], Result]) -> Result:
    """Return what is sampled by as many rays as it takes.

    That is until the error in the space's ``light_errors`` is below `UNSEEN`, or the next step
    would not end within `AUTO_SECONDS` of the beginning, or take more memory than is allowed. Which
    it was, the space's ``light_errors.found`` says.

    Parameters
    ----------
    space : ScaleSpace
    sampled : callable
        Given a number of rays, keeps the error; nothing, where nothing was sampled.
    """
    from meshdepict.transport.transfer import fits_memory  # which loads numba

    ray_scene(space.surface)  # grown once for all steps: it tells nothing of how long they take
    errors, rays, begun = space.light_errors, FIRST_RAYS, time.perf_counter()
    while True:
        errors.pop(rays, None)
        before = time.perf_counter()
        result = sampled(rays)
        now = time.perf_counter()
        error, ended = errors.get(rays, 0.0), ""
        if error < UNSEEN:
            break
        if 2 * rays > MOST_RAYS:
            ended = "most"
        elif now - begun + 2 * (now - before) > AUTO_SECONDS:
            ended = "time"
        elif not fits_memory(len(space.surface.vertices), 2 * rays):
            ended = "memory"
        if ended:
            break
        rays *= 2
    errors.found = FoundRays(rays, error, ended)
    return result
