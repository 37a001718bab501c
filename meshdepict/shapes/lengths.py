"""Lengths as people write them: in world units, as a share of the diagonal, or not at all."""

from __future__ import annotations

import math

from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scene.shape import Shape

__all__ = ["resolve_width"]


def resolve_width(width: float | str | None, shape: Shape) -> float:
    """Return a width in world units: a number, "0.2%" of the diagonal, or None.

    None is the shape's own step: a mesh's median edge, a volume's largest spacing, a pixel.

    Raises
    ------
    MeshdepictError
        For what is no positive length.
    """
    if width is None:
        return float(shape.edge_length)
    try:
        if not isinstance(width, str):
            resolved = real(width) or math.nan
        elif width.strip().endswith("%"):
            resolved = float(width.strip()[:-1]) / 100 * shape.diagonal
        else:
            resolved = float(width)
    except ValueError:
        resolved = math.nan
    if not (0 < resolved < math.inf):
        raise MeshdepictError(
            f"width={width!r} is not a positive length, such as 0.5 (world units) or '0.2%' "
            "(of the diagonal)"
        )
    return resolved
