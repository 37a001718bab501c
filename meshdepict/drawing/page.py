"""A page: pictures, blocks of colour and words at their places; painted here, or kept as vectors.

Everything that is written as a picture is laid out once, as a page. In PNG and JPEG all of it is
pixels; in SVG and PDF the pictures are, while blocks and words stay sharp at any size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from meshdepict.drawing.letters import font

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["SCREEN", "Block", "Color", "Page", "Part", "Picture", "Words", "paint"]

Color: TypeAlias = tuple[int, int, int]
"""sRGB, of 255."""

SCREEN = 96.0
"""Dots per inch where nobody says: what SVG and CSS take a pixel for."""


@dataclass(frozen=True)
class Picture:
    """A ``PIL.Image``, pixel by pixel."""

    image: Image
    left: int
    top: int


@dataclass(frozen=True)
class Block:
    """A rectangle of one colour; to the nearest pixel where it is painted."""

    left: float
    top: float
    right: float
    bottom: float
    color: Color


@dataclass(frozen=True)
class Words:
    """A line of text: where it begins, or its middle, at half the height of its letters."""

    text: str
    x: float
    y: float
    size: int
    color: Color
    anchor: str = "l"  # l: begins there; m: has its middle there
    rim: int = 0  # width of a bright or dark line round the letters
    around: Color = (255, 255, 255)


Part: TypeAlias = Picture | Block | Words


@dataclass(frozen=True)
class Page:
    """What a picture's file holds.

    Attributes
    ----------
    size : (int, int)
        Width and height in pixels.
    ground : (int, int, int) or None
        Colour; None is transparent.
    parts : sequence
        In the order in which they are painted.
    dpi : float, optional
        Pixels per inch on paper.
    """

    size: tuple[int, int]
    ground: Color | None
    parts: tuple[Part, ...]
    dpi: float | None = None


def paint(page: Page) -> Image:
    """Return a page as a ``PIL.Image`` in RGB, or RGBA where its ground is transparent."""
    from PIL import Image, ImageDraw

    mode, ground = ("RGBA", (0, 0, 0, 0)) if page.ground is None else ("RGB", page.ground)
    image = Image.new(mode, page.size, ground)
    pen = ImageDraw.Draw(image)
    for part in page.parts:
        if isinstance(part, Picture):
            image.paste(part.image.convert(mode), (part.left, part.top))
        elif isinstance(part, Block):
            left, top, right, bottom = map(round, (part.left, part.top, part.right, part.bottom))
            if left < right and top < bottom:
                pen.rectangle((left, top, right - 1, bottom - 1), fill=part.color)
        else:
            letters, anchor = font(part.text, part.size), f"{part.anchor}m"
            place = part.x, part.y
            pen.text(
                place, part.text, part.color, letters, anchor=anchor,
                stroke_width=part.rim, stroke_fill=part.around,
            )  # fmt: skip
    return image
