"""A figure on a page: its size in pixels or on paper, its ground, its scale and its caption."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest, real
from meshdepict.voxels.length_unit import MILLIMETRES, length_unit

__all__ = ["LARGEST", "Figure", "check_pixels", "summary"]

_PER_INCH = {"cm": 2.54, "mm": 25.4, "in": 1.0}
_SIZE = re.compile(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)(px|cm|mm|in)?")
_NUMBER = re.compile(r"\d+\.\d+(?:e[-+]\d+)?")
_PAPER = re.compile(r"a([0-6])(landscape)?")
_A0 = 841, 1189  # mm; each of the following is half of the one before
_PRINT = 300.0  # dots per inch that printers ask for, where a size on paper comes without
LARGEST = 16384
"""Pixels across: what graphics cards can draw into."""
# Beside the names that CSS has, which Pillow knows.
_GROUNDS = {"transparent": None, "white": (255, 255, 255), "paper": (226, 221, 209)}
_DARK = 110  # luma of a ground below which ink is white
_COUNTED = ("units", "px", "voxels")  # what a length is counted in where nothing says its unit
_POINTS = 8.0  # height of letters on paper, in 1/72 inch
_LETTERS = 0.024  # … and where there is no paper, as a share of the picture's shorter side


@dataclass(frozen=True, kw_only=True)
class Figure:
    """How a picture is laid out.

    Parameters
    ----------
    size : (int, int) or str, optional
        Width and height in pixels; or "1200x900", "12x9cm", "120x90mm", "5x4in", "A4",
        "A4 landscape". 1000 x 1000 unless given, and of a map of terrain the raster as it is, a
        pixel or a square of pixels a cell; with `pixels_per_unit`, whatever the object needs.
    dpi : float, optional
        Dots per inch on paper, 300 where a size on paper needs them.
    background : str, optional
        A name of CSS such as "white" or "lightgray", "paper" (pale, so that burnt-out whites show),
        "transparent" or "#rrggbb"; what the depicted method declares unless given, mostly white.
    scale_bar : bool
    unit : str
        What the file's units are, for the scale bar's label; unless given, as the file says.
    pixels_per_unit : float, optional
        The same scale for every object, which is put in the middle. Unless given, a named view
        shows the whole object, and any other view is taken as it is.
    caption : str
        What stands below the picture; "auto" says method, light and widths.

    Raises
    ------
    MeshdepictError
        For anything else.
    """

    size: Any = None
    dpi: float | None = None
    background: str | None = None
    scale_bar: bool = False
    unit: str = ""
    pixels_per_unit: float | None = None
    caption: str = ""

    def __post_init__(self) -> None:
        """Check everything once, before anything is read or drawn."""
        for name, what in (("dpi", "dots per inch"), ("pixels_per_unit", "pixels")):
            value = getattr(self, name)
            if value is not None and not (_is_number(value) and 0 < value < 1e9):
                raise MeshdepictError(
                    f"{name}={value!r} is not a number of {what} above 0 and below 1e9"
                )
        if not isinstance(self.scale_bar, bool):
            raise MeshdepictError(f"scale_bar={self.scale_bar!r} is neither True nor False")
        if not isinstance(self.caption, str):
            raise MeshdepictError(f"caption={self.caption!r} is no text")
        object.__setattr__(self, "unit", _unit(self.unit))
        object.__setattr__(
            self, "_ground", _ground("white" if self.background is None else self.background)
        )
        size, dpi = _pixels(self.size, self.dpi)
        if size is not None:
            check_pixels(size)
        object.__setattr__(self, "_pixels", size)
        object.__setattr__(self, "dpi", dpi)

    def on(self, ground: str) -> Figure:
        """Return this figure on a ground, unless it has one."""
        return self if self.background is not None else replace(self, background=ground)

    @property
    def pixels(self) -> tuple[int, int] | None:
        """Width and height in pixels, None where they aren't given."""
        size: tuple[int, int] | None = self._pixels  # type: ignore[attr-defined]
        return size

    @property
    def ground(self) -> tuple[int, int, int] | None:
        """Colour (sRGB) of the background, None where it is transparent."""
        ground: tuple[int, int, int] | None = self._ground  # type: ignore[attr-defined]
        return ground

    @property
    def inks(self) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
        """Colours of what is written on the ground, and of what lies between: black and white."""
        black, white = (0, 0, 0), (255, 255, 255)
        dark = self.ground is not None and _luma(self.ground) < _DARK
        return (white, black) if dark else (black, white)

    def captioned(self, facts: Mapping[str, str], unit: str = "") -> Figure:
        """Return the figure with the caption that says where a picture comes from, if asked for.

        Parameters
        ----------
        facts : mapping
            The picture's provenance.
        unit : str
            What widths are measured in, unless the figure says it.
        """
        if self.caption != "auto":
            return self
        text, word, widths = summary(facts).partition(" width")
        widths = _NUMBER.sub(lambda found: f"{float(found[0]):.3g}", widths)
        measured = f"{word}{widths} {self.unit or unit}".rstrip() if word else ""
        return replace(self, caption=text + measured)

    def letters(self, size: tuple[int, int]) -> int:
        """Height of letters in pixels in a picture of a size."""
        height = self.dpi * _POINTS / 72 if self.dpi else _LETTERS * min(size)
        return max(11, round(height))


def _pixels(size: object, dpi: float | None) -> tuple[tuple[int, int] | None, float | None]:
    """Return a size in pixels and the dots per inch that go with it."""
    if size is None:
        return None, dpi
    if isinstance(size, str):
        text = size.strip().lower().replace(" ", "").replace("-", "").replace("×", "x")
        match = _SIZE.fullmatch(_on_paper(text))
        if match is None:
            raise MeshdepictError(
                f"size {size!r} is not WIDTHxHEIGHT in pixels, such as 1200x900, or on paper, such "
                "as 12x9cm, 120x90mm, 5x4in, A4 or A4-landscape"
            )
        width, height, unit = match.groups()
        numbers = float(width), float(height)
        if unit in _PER_INCH:
            dpi = dpi or _PRINT
            numbers = numbers[0] * dpi / _PER_INCH[unit], numbers[1] * dpi / _PER_INCH[unit]
            return (round(numbers[0]), round(numbers[1])), dpi
    else:
        given = tuple(size) if np.iterable(size) else ()
        if len(given) != 2 or not all(map(_is_number, given)):
            raise MeshdepictError(
                f"size={size!r} is neither (width, height) nor a text like 12x9cm"
            )
        numbers = float(given[0]), float(given[1])
    if any(number != math.floor(number) for number in numbers):
        raise MeshdepictError(f"size={size!r}: pixels come in whole numbers")
    return (int(numbers[0]), int(numbers[1])), dpi


def _on_paper(text: str) -> str:
    """Return the size that a name of paper stands for, any other text as it is."""
    match = _PAPER.fullmatch(text)
    if match is None:
        return text
    width, height = _A0
    for _ in range(int(match[1])):
        width, height = height // 2, width
    return f"{height}x{width}mm" if match[2] else f"{width}x{height}mm"


def check_pixels(size: tuple[int, int], why: str = "") -> None:
    """Refuse a picture that can't be drawn; `why` it would be like that goes into the sentence."""
    if not all(1 <= length <= LARGEST for length in size):
        raise MeshdepictError(
            f"a picture of {size[0]}x{size[1]} pixels{why}: 1 to {LARGEST} are possible"
        )


def _unit(unit: object) -> str:
    """Return the name of a unit, however it is spelt."""
    text = str(unit).strip()
    if unit is None or not text or text in _COUNTED:
        return text if unit is not None else ""
    name = length_unit(text)
    if not name:
        known = (*MILLIMETRES, *_COUNTED)
        raise MeshdepictError(
            f"unit={unit!r} is no length that a scale bar knows ({', '.join(known)})"
            f"{nearest(text, known)}"
        )
    return name


def _ground(background: str) -> tuple[int, int, int] | None:
    name = background.strip().lower() if isinstance(background, str) else ""
    if name in _GROUNDS:
        return _GROUNDS[name]
    if re.fullmatch(r"#[0-9a-f]{6}", name):
        red, green, blue = bytes.fromhex(name[1:])
        return red, green, blue
    from PIL import ImageColor

    if name in ImageColor.colormap:
        red, green, blue = ImageColor.getrgb(name)[:3]
        return red, green, blue
    raise MeshdepictError(
        f"background={background!r} is none of {', '.join(_GROUNDS)}, no name of a colour such as "
        "lightgray, and no #rrggbb"
        f"{nearest(str(background), (*_GROUNDS, *ImageColor.colormap))}"
    )


def _luma(color: tuple[int, int, int]) -> float:
    return 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]


def summary(facts: Mapping[str, str]) -> str:
    """Return method, light and widths of a provenance, as a caption has them."""
    light = facts["light"].partition(" (")[0]  # its name, if it has one
    count, *rest = facts["scales"].split(", ")
    parts = [facts["method"], f"light {light}"]
    if rest:
        widths = rest[0] if count != "1" else rest[0].replace("widths", "width").split(" to ")[0]
        parts.append(f"{count} {widths}")
    return ", ".join(parts)


def _is_number(value: object) -> bool:
    return real(value) is not None
