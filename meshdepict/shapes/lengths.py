"""Lengths as people write them: in units of length, in shares, pixels or cells, or not at all.

Light Warping smooths slopes over pixels, so that what is small in the picture vanishes: from afar
a pixel, and with it the width, covers more of the surface. A width may be given in pixels for that;
where another length is given beside it, the larger of the two counts.
"""

from __future__ import annotations

import math
import re
import warnings

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.options import real
from meshdepict.scene.shape import Shape
from meshdepict.scene.view import View
from meshdepict.voxels.length_unit import MILLIMETRES, length_unit

__all__ = ["counts_pixels", "pixel_size", "resolve_width"]

_PIXELS = "px"
_CELLS = ("cells", "cell")
_WRITTEN = re.compile(r"([+-]?(?:[0-9]+[.]?[0-9]*|[.][0-9]+)(?:[eE][+-]?[0-9]+)?)\s*([^0-9]*)")


def resolve_width(
    width: float | str | None,
    shape: Shape,
    view: View | None = None,
    *,
    averages: bool = True,
) -> float:
    """Return a width in world units: a number, "5m", "0.2%" of the diagonal, "3px", or None.

    None is the shape's own step: a mesh's median edge, a volume's largest spacing, a pixel. Of
    "0.2%,3px" and "0.5,3px" the larger one counts. A unit of length is understood where the shape
    knows what its own are in, as terrain does, in metres; terrain has "3cells", too: so many times
    the distance of its cells, the shorter one.

    Parameters
    ----------
    width : float, str or None
    shape : Mesh, HeightField, Volume or GBuffer
        An image has pixels of its own.
    view : View, optional
        Whose pixels are meant; see `pixel_size`.
    averages : bool
        Whether it is the width of averages, of which one beyond the shape is warned of.

    Raises
    ------
    MeshdepictError
        For what is no positive length, for pixels where no view says how large they are, for units
        where nobody knows the shape's, and for cells of what has none. One beyond the shape is
        taken, with a warning.
    """
    if width is None:
        return float(shape.edge_length)
    if isinstance(width, str):
        parts = [part.strip() for part in width.split(",")]
        # One number and one of pixels: "1,5" is no length, and surely not 5.
        if len(parts) > 2 or (len(parts) == 2 and sum(map(counts_pixels, parts)) != 1):
            parts = [""]
        lengths = [_length(part, shape, view) for part in parts]
    else:
        lengths = [real(width) or math.nan]
    if not all(0 < length < math.inf for length in lengths):
        usual = "5 or '5m' (metres), '3cells'" if _terrain(shape) else "0.5 (world units)"
        raise MeshdepictError(
            f"width={width!r} is not a positive length, such as {usual}, '0.2%' (of the "
            "diagonal), '3px' (pixels of the view) or '0.2%,3px' (the larger)"
        )
    resolved = max(lengths)
    if averages and resolved > shape.diagonal > 0:
        warnings.warn(
            f"width={width!r} is more than the object's diagonal of {shape.diagonal:.4g}: every "
            "scale is one average of all of it (unless given, the width is "
            f"{shape.edge_length:.4g})",
            MeshdepictWarning,
            stacklevel=4,
        )
    return resolved


def counts_pixels(width: object) -> bool:
    """Whether a width, as it is written, counts pixels."""
    return isinstance(width, str) and any(
        part.strip().endswith(_PIXELS) for part in width.split(",")
    )


def pixel_size(shape: Shape, view: View | None) -> float:
    """Return the world size of a pixel: an image's own, else a view's at the middle of the shape.

    A picture of another height than the view's `height_px` has other pixels.

    Raises
    ------
    MeshdepictError
        Without a view, and where the middle of the shape is not before its eye.
    """
    if shape.kind == "image":
        return float(shape.edge_length)
    if view is None:
        raise MeshdepictError(
            "a width in pixels needs a view, which says how large they are, and none is known "
            'here: give one (scale_space(…, view="front")), or a width in world units'
        )
    if view.parallel_scale is not None:
        return 2 * float(view.parallel_scale) / view.height_px
    assert view.field_of_view is not None  # every view has the one or the other
    depth = float((view.position - shape.centre) @ view.towards_eye)
    if depth <= 0:
        raise MeshdepictError(
            "a width in pixels needs an eye before the object, whose middle lies behind this "
            "view's: move the eye away, or give a width in world units"
        )
    return 2 * depth * math.tan(math.radians(view.field_of_view) / 2) / view.height_px


def _terrain(shape: Shape) -> bool:
    return shape.kind == "height field"


def _length(text: str, shape: Shape, view: View | None) -> float:
    """Return what one text stands for, NaN where it is none."""
    written = _WRITTEN.fullmatch(text)
    if written is None:
        return math.nan
    number, unit = float(written[1]), written[2]
    if unit == "%":
        return number / 100 * shape.diagonal
    if unit == _PIXELS:
        return number * pixel_size(shape, view)
    if unit in _CELLS:
        if not _terrain(shape):
            raise MeshdepictError(
                f"width={text!r} counts cells, and this {shape.kind} has none, only terrain has: "
                "give a width in world units, or a share of the diagonal such as '0.2%'"
            )
        return number * shape.edge_length
    if length_unit(unit):
        return number * _units(length_unit(unit), text, shape)
    return math.nan if unit else number


def _units(unit: str, text: str, shape: Shape) -> float:
    """Return how many of the shape's units a unit of length is."""
    own = length_unit(getattr(shape, "length_unit", ""))
    if not own:
        raise MeshdepictError(
            f"width={text!r} has a unit ({unit}), and nothing says what the lengths of this "
            f"{shape.kind} are in: give it in those, without a unit, or as a share of the "
            "diagonal such as '0.2%'"
        )
    return MILLIMETRES[unit] / MILLIMETRES[own]
