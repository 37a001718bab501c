"""The scale bar: a round length in the file's units, and what it is made of on a page."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from meshdepict.drawing.page import Block, Part, Words

if TYPE_CHECKING:
    from meshdepict.drawing.figure import Figure

__all__ = ["BAR_SHARE", "ScaleBar", "bar_parts", "scale_bar"]

BAR_SHARE = 0.3
"""Of a picture's width, how long its bar is at most."""


@dataclass(frozen=True)
class ScaleBar:
    """A length in the file's units, into how many parts the bar is divided, and its label."""

    length: float
    parts: int
    label: str


def scale_bar(extent: float, unit: str = "", *, share: float = BAR_SHARE) -> ScaleBar:
    """Choose the bar for a picture.

    Parameters
    ----------
    extent : float
        Width of the picture in the file's units, positive.
    unit : str
        Name of these units.
    share : float
        How much of the width the bar may take.

    Returns
    -------
    ScaleBar
        The longest of 1, 2 and 5 times a power of ten that isn't longer than that.

    Examples
    --------
    >>> scale_bar(100, "mm")
    ScaleBar(length=20.0, parts=4, label='20 mm')
    """
    longest = share * extent * (1 + 1e-9)  # a bar of just that length is not lost to rounding
    power = math.floor(math.log10(longest))
    first = next(digit for digit in (5, 2, 1) if digit * 10.0**power <= longest or digit == 1)
    length = float(f"{first}e{power}")  # 3e-7 rather than 3.0000000000000004e-07
    number = f"{length:,.0f}" if 1 <= length < 1e6 else f"{length:g}"
    name = unit or ("unit" if length == 1 else "units")
    return ScaleBar(length, 4 if first == 2 else 5, f"{number} {name}")


def bar_parts(
    longest: float,
    unit: str,
    per_unit: float,
    *,
    left: int,
    middle: int,
    letters: int,
    figure: Figure,
) -> list[Part]:
    """Return the blocks and the words of a scale bar, from edge to edge as long as it says.

    Parameters
    ----------
    longest : float
        What it may be long, in the file's units.
    unit : str
        Name of these units.
    per_unit : float
        Pixels of a unit.
    left, middle : int
        Where it begins, and where the middle of its height is, in pixels.
    letters : int
        Height of letters in pixels.
    figure : Figure
        On whose ground it lies.
    """
    bar = scale_bar(longest, unit, share=1)
    ink, fill = figure.inks
    thick, line = max(4, round(letters * 0.45)), max(1, round(letters / 14))
    length = bar.length * per_unit
    if length < bar.parts * 2 * line:  # a picture of a few pixels has no room for a bar
        return []
    top = middle - thick // 2
    bottom = top + thick
    ends = [left + length * i / bar.parts for i in range(bar.parts + 1)]
    clear = figure.ground is None  # legible on any page: a bright rim round bar and label
    parts: list[Part] = []
    if clear:
        parts.append(Block(left - line, top - line, ends[-1] + line, bottom + line, fill))
    parts.append(Block(left, top, ends[-1], bottom, ink))
    for i in range(1, bar.parts, 2):
        edge = line if i == bar.parts - 1 else 0
        parts.append(Block(ends[i], top + line, ends[i + 1] - edge, bottom - line, fill))
    beside, across = ends[-1] + letters * 0.6, (top + bottom - 1) / 2
    rim = 2 * line if clear else 0
    parts.append(Words(bar.label, beside, across, letters, ink, rim=rim, around=fill))
    return parts
