"""Lengths as people write them: in world units, as a share of the diagonal, or not at all."""

from __future__ import annotations

import math
import warnings

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.options import real
from meshdepict.scene.shape import Shape

__all__ = ["resolve_width"]


def resolve_width(width: float | str | None, shape: Shape) -> float:
    """Return a width in world units: a number, "0.2%" of the diagonal, or None.

    None is the shape's own step: a mesh's median edge, a volume's largest spacing, a pixel.

    Raises
    ------
    MeshdepictError
        For what is no positive length. One beyond the shape is taken, with a warning.
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
    if resolved > shape.diagonal > 0:
        warnings.warn(
            f"width={width!r} is more than the object's diagonal of {shape.diagonal:.4g}: every "
            "scale is one average of all of it (unless given, the width is "
            f"{shape.edge_length:.4g})",
            MeshdepictWarning,
            stacklevel=4,
        )
    return resolved
