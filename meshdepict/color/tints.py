"""Hypsometric tints: colours by height, to be multiplied with relief in linear light.

They are pale, so that shading shows through them, and follow hand-made maps: plains green or bluish
under haze, slopes warm, summits the lightest.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.colormaps import table_of
from meshdepict.color.spans import parsed_span, reach, span_text
from meshdepict.color.srgb import quantise
from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest, real

__all__ = ["TINTS", "checked_tint", "parsed_tint", "tint_colors", "tint_table", "tint_text"]

# Display colours (0 … 255) at equal steps of height, the lowest first.
_COLOURS = {
    "earth": (
        (156, 188, 148), (186, 206, 158), (222, 219, 171), (232, 208, 164), (219, 183, 148),
        (212, 183, 165), (232, 222, 214), (253, 253, 251),
    ),
    "swiss": (
        (158, 184, 180), (176, 198, 178), (200, 212, 178), (226, 224, 184), (244, 234, 200),
        (254, 245, 224), (255, 253, 246),
    ),
    "desert": (
        (196, 205, 184), (226, 219, 186), (240, 220, 176), (238, 202, 155), (224, 178, 141),
        (214, 170, 150), (236, 214, 200), (252, 246, 240),
    ),
}  # fmt: skip
TINTS = tuple(_COLOURS)
"""Names of this package's own tints."""


def tint_table(name: str) -> NDArray[np.uint8]:
    """Return the 256 display colours of a tint, lowest first.

    Parameters
    ----------
    name : str
        "earth", "swiss" (after Imhof: haze below, light above), "desert", or any `colormap`. With
        "_r" behind it, the other way round.

    Returns
    -------
    (256, 3) array of uint8, read-only

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    if isinstance(name, str) and name.removesuffix("_r") in _COLOURS:
        return _own(name)
    try:
        return table_of(name)
    except MeshdepictError as error:
        if meant := nearest(str(name), TINTS):
            known = f"there are {', '.join(TINTS)}, and all colour maps"
            raise MeshdepictError(
                f"no tint is called {name!r}{meant} (there are {known})"
            ) from None
        raise MeshdepictError(f"{error}; tints of their own are {', '.join(TINTS)}") from None


@cache
def _own(name: str) -> NDArray[np.uint8]:
    colours = np.array(_COLOURS[name.removesuffix("_r")]) / 255
    if name.endswith("_r"):
        colours = colours[::-1]
    steps, places = np.linspace(0, 1, 256), np.linspace(0, 1, len(colours))
    table = quantise(np.stack([np.interp(steps, places, c) for c in colours.T], axis=1))
    table.setflags(write=False)
    return table


def tint_colors(
    heights: ArrayLike, name: str, span: tuple[float, float] | None = None
) -> NDArray[np.uint8]:
    """Return the colours of heights.

    Parameters
    ----------
    heights : (n,) array_like
    name : str
        See `tint_table`.
    span : (low, high), optional
        The heights of the first and of the last colour; all beyond have these, too. The lowest and
        the highest of all unless given.

    Returns
    -------
    (n, 3) array of uint8
        sRGB. Where all is at one height, the colour in the middle.

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    table = tint_table(name)
    heights = np.asarray(heights, np.float64)
    low, high = (heights.min(), heights.max()) if span is None else span
    apart = high - low if span is None else reach(low, high)
    shares = (heights - low) / apart if apart else np.full(len(heights), 0.5)
    return np.take(table, quantise(shares), axis=0)


# --- tints in words -----------------------------------------------------------------------------


def checked_tint(tint: object) -> str:
    """Return a tint in words, ``earth`` or ``earth:0..3000``.

    Parameters
    ----------
    tint : str or (name, low, high)

    Raises
    ------
    MeshdepictError
        For an unknown name, and ends that are not two numbers that differ.
    """
    if not isinstance(tint, str):
        tint = _joined(tint)
    parsed_tint(tint)
    return tint


def parsed_tint(tint: str) -> tuple[str, tuple[float, float] | None]:
    """Return name and span of a tint in words."""
    name, given, span = tint.partition(":")
    tint_table(name)
    if not given:
        return name, None
    try:
        return name, parsed_span(span)
    except MeshdepictError as error:
        raise MeshdepictError(f"tint={tint!r}: {error}") from None


def tint_text(name: str, span: tuple[float, float]) -> str:
    """Return a tint in words."""
    return f"{name}:{span_text(span)}"


def _joined(tint: object) -> str:
    parts: Sequence[Any] = tint if isinstance(tint, (tuple, list)) else ()
    ends = [real(part) for part in parts[1:]]
    if len(parts) != 3 or not isinstance(parts[0], str) or ends[0] is None or ends[1] is None:
        raise MeshdepictError(
            f"tint={tint!r} is neither a name nor a name with the heights of its first and last "
            "colour"
        )
    return tint_text(parts[0], (ends[0], ends[1]))
