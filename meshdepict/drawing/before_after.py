"""Two pictures of one object side by side, before and after, each with a line under it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from meshdepict.drawing.canvas import canvas
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.drawing.picture import finished

if TYPE_CHECKING:
    from PIL.Image import Image

    from meshdepict.drawing.painted import Painted

__all__ = ["before_after"]

_INK = (60, 60, 60)
_LETTERS = 0.035  # of a picture's width
_STRIP = 2.2  # in letters


def before_after(
    bakes: Sequence[Painted], captions: Sequence[str], figure: Figure | None = None
) -> Image:
    """Return a ``PIL.Image`` of bakes side by side, each as `save_picture` draws it.

    Parameters
    ----------
    bakes : sequence
        What is drawn, from left to right.
    captions : sequence of str
        A line for each.
    figure : Figure, optional
        How each of them is laid out; 600 x 600 pixels on white unless given.
    """
    from PIL import Image, ImageDraw, ImageFont

    figure = figure or Figure(size=(600, 600))
    pictures = []
    for baked in bakes:
        framing = frame(baked.view, baked.shape, figure)
        with canvas(baked, framing.drawn) as drawing:
            pictures.append(finished(drawing.draw(framing.view), framing, figure))
    width, height = pictures[0].size
    letters = max(10, round(_LETTERS * width))
    strip = round(_STRIP * letters)
    page = Image.new("RGB", (width * len(pictures), height + strip), "white")
    pen, font = ImageDraw.Draw(page), ImageFont.load_default(size=letters)
    for i, (picture, caption) in enumerate(zip(pictures, captions, strict=True)):
        page.paste(picture.convert("RGB"), (i * width, 0))
        middle = (i + 0.5) * width, height + strip / 2
        pen.text(middle, caption, _INK, font, anchor="mm")
    return page
