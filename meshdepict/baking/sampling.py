"""Sampling what is baked: a scale space for each ladder that a look needs, once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.ladder import check_ladder
from meshdepict.scales.making import scale_space
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from meshdepict.baking.choices import Choices
    from meshdepict.scales.company import Company

__all__ = ["Place", "sampled"]


@dataclass
class Place:
    """Where a mesh stands among others, and how it was sampled there.

    Attributes
    ----------
    company : Company
    member : int
        Which of them it is.
    eye : View
        Of the whole scene.
    spaces : {(scales, ratio): ScaleSpace}
        Of the mesh, as far as they have been made.
    """

    company: Company
    member: int
    eye: View
    spaces: dict[tuple[int, float], ScaleSpace] = field(default_factory=dict)


def sampled(
    mesh: object,
    look: Choices,
    eye: View,
    ladder: tuple[int, float],
    *,
    tints: NDArray[np.float32] | None = None,
    place: Place | None = None,
) -> ScaleSpace:
    """Return a scale space of a surface, with nothing smoothed yet; of a place the one it has."""
    check_ladder(*ladder, look.facing, look.tolerance)
    known = {} if place is None else place.spaces
    if ladder not in known:
        space = known[ladder] = scale_space(
            mesh, scales=ladder[0], width=look.width, ratio=ladder[1], facing=look.facing,
            tolerance=look.tolerance, view=eye, at_once=(),
        )  # fmt: skip
        if tints is not None:
            space.tints = tints
        if place is not None:
            space.company, space.member = place.company, place.member
    return known[ladder]
