"""Two pictures of one object side by side, before and after, each with a line under it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from meshdepict.drawing.figure import Figure
from meshdepict.drawing.page import Page, Part, Picture, Words, paint
from meshdepict.drawing.picture import draw_page

if TYPE_CHECKING:
    from meshdepict.drawing.painted import Painted

__all__ = ["before_after"]

_INK = (60, 60, 60)
_LETTERS = 0.035  # of a picture's width
_STRIP = 2.2  # in letters


def before_after(
    bakes: Sequence[Painted], captions: Sequence[str], figure: Figure | None = None
) -> Page:
    """Return a page with bakes side by side, each as `save_picture` draws it.

    Parameters
    ----------
    bakes : sequence
        What is drawn, from left to right.
    captions : sequence of str
        A line for each.
    figure : Figure, optional
        How each of them is laid out; 600 x 600 pixels on white unless given.
    """
    figure = figure or Figure(size=(600, 600))
    pictures = [paint(draw_page(baked, figure)) for baked in bakes]
    width, height = pictures[0].size
    letters = max(10, round(_LETTERS * width))
    strip = round(_STRIP * letters)
    parts: list[Part] = []
    for i, (picture, caption) in enumerate(zip(pictures, captions, strict=True)):
        parts.append(Picture(picture.convert("RGB"), i * width, 0))
        middle = (i + 0.5) * width, height + strip / 2
        parts.append(Words(caption, *middle, letters, _INK, anchor="m"))
    size = width * len(pictures), height + strip
    return Page(size, (255, 255, 255), tuple(parts), figure.dpi)
