"""Hypsometric tints of what is baked: how high each sample lies, and the colour that it gets."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.choices import Choices
from meshdepict.color.tints import parsed_tint, tint_colors, tint_text
from meshdepict.errors import MeshdepictError
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.upright import upright
from meshdepict.shapes.gbuffer import GBuffer

__all__ = ["heights_of", "spanned_tint", "tinted"]

Floats = NDArray[np.float64]
Look = TypeVar("Look", bound=Choices)


def heights_of(space: ScaleSpace, up: str, points: Floats | None = None) -> Floats:
    """Return how high samples lie, in world units.

    Above level ground where the shape has some, height fields and meshes of sheets; of other meshes
    along the axis that is up.

    Parameters
    ----------
    space : ScaleSpace
    up : str
        An axis of `upright`.
    points : (k, 3) array, optional
        Of the same shape; the samples unless given.

    Raises
    ------
    MeshdepictError
        For an image.
    """
    if isinstance(space.shape, GBuffer):
        raise MeshdepictError(
            f"tint colours by height, and an {space.shape.kind} has none: leave it out"
        )
    try:
        axis = space.vertical
    except MeshdepictError:
        axis = upright(up)[:, 1]
    return np.asarray((space.points if points is None else points) @ axis, np.float64)


def spanned_tint(tint: str, span: Callable[[], tuple[float, float]]) -> str:
    """Return a tint with the heights of its first and last colour.

    Parameters
    ----------
    tint : str
    span : callable
        Returns the least and the largest height; asked where the tint has no heights of its own.
    """
    name, given = parsed_tint(tint)
    if given is not None:
        return tint
    low, high = span()
    return tint_text(name, (low, high)) if low < high else tint


def tinted(look: Look, heights: Floats) -> tuple[Look, NDArray[np.uint8]]:
    """Return a look with the heights of its tint's first and last colour, and the colours (n, 3).

    They are the lowest and the highest of all unless somebody chose them.
    """
    assert look.tint is not None
    tint = spanned_tint(look.tint, lambda: (float(heights.min()), float(heights.max())))
    return look.replace(tint=tint), tint_colors(heights, *parsed_tint(tint))
