"""The scale bar: a round length in the file's units, and how it is drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from PIL.Image import Image

    from meshdepict.drawing.figure import Figure
    from meshdepict.drawing.framing import Framing

__all__ = ["ScaleBar", "draw_scale_bar", "scale_bar"]

_SHARE = 0.3  # of the picture's width, at most
_DARK = 110  # luma of a ground below which ink is white


@dataclass(frozen=True)
class ScaleBar:
    """A length in the file's units, into how many parts the bar is divided, and its label."""

    length: float
    parts: int
    label: str


def scale_bar(extent: float, unit: str = "", *, share: float = _SHARE) -> ScaleBar:
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


def draw_scale_bar(image: Image, framing: Framing, figure: Figure) -> None:
    """Draw the scale bar at the bottom left of a ``PIL.Image``; in parallel views only."""
    from PIL import ImageDraw

    assert framing.pixels_per_unit is not None  # `frame` sees to that
    width, height = framing.size
    bar = scale_bar(width / framing.pixels_per_unit, framing.unit)
    ground = figure.ground
    dark = ground is not None and _luma(ground) < _DARK
    ink, fill = ("white", "black") if dark else ("black", "white")
    letters = figure.letters(framing.size)
    thick, line = max(4, round(letters * 0.45)), max(1, round(letters / 14))
    length = bar.length * framing.pixels_per_unit
    strip = framing.strip or min(3 * letters, height // 3)
    left, middle = round(letters * 1.2), height - strip // 2
    top, bottom = middle - thick // 2, middle - thick // 2 + thick - 1
    pen = ImageDraw.Draw(image)
    if length < bar.parts * 2 * line:  # a picture of a few pixels has no room for a bar
        return
    ends = [left + round(length * i / bar.parts) for i in range(bar.parts + 1)]
    pen.rectangle((left, top, ends[-1] - 1, bottom), fill=ink)
    for i in range(1, bar.parts, 2):  # from edge to edge it is as long as it says
        edge = line if i == bar.parts - 1 else 0
        pen.rectangle((ends[i], top + line, ends[i + 1] - 1 - edge, bottom - line), fill=fill)
    font = _font(bar.label, letters)
    place = ends[-1] + letters * 0.6, (top + bottom) / 2
    if ground is None:  # legible on any page: a bright rim round bar and label
        rim = 2 * line
        pen.rectangle(
            (left - line, top - line, ends[-1] - 1 + line, bottom + line), outline=fill, width=line
        )
        pen.text(place, bar.label, ink, font, anchor="lm", stroke_width=rim, stroke_fill=fill)
    else:
        pen.text(place, bar.label, ink, font, anchor="lm")


def _luma(color: tuple[int, int, int]) -> float:
    return 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]


def _font(text: str, size: int) -> Any:
    """Return a font that has the letters: Pillow's own lacks µ and all else beyond ASCII."""
    from PIL import ImageFont

    if text.isascii():
        return ImageFont.load_default(size)
    import matplotlib

    path = Path(matplotlib.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")
    return ImageFont.truetype(path, size)
