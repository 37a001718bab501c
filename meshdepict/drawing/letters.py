"""Letters: a font that has them, and lines that are no longer than there is room for."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

from meshdepict.errors import printable

__all__ = ["LEADING", "font", "wrapped"]

LEADING = 1.35
"""From one line to the next, in heights of letters."""


def font(text: str, size: int) -> Any:
    """Return a font that has the letters: Pillow's own lacks µ and all else beyond ASCII."""
    from PIL import ImageFont

    return ImageFont.load_default(size) if text.isascii() else _wide(size)


def wrapped(text: str, width: float, size: int) -> list[str]:
    """Return a text as lines that fit into a width in pixels, in letters of a size.

    Lines break at spaces, and inside a word where it is longer than a line. They are measured in
    the widest of the fonts that pictures are written with, so that they fit in all of them.
    """
    measure = _wide(size).getlength
    lines = []
    text = text.encode("utf-8", "replace").decode()  # a file's name need not be text
    for paragraph in text.splitlines():
        line = ""
        for word in map(printable, paragraph.split()):
            longer = f"{line} {word}".strip()
            if measure(longer) <= width:
                line = longer
                continue
            lines += [line] if line else []
            *whole, line = _pieces(word, width, measure)
            lines += whole
        lines += [line] if line else []
    return lines


def _pieces(word: str, width: float, measure: Callable[[str], float]) -> list[str]:
    """Cut a word that is longer than a line."""
    pieces = [""]
    for letter in word:
        if pieces[-1] and measure(pieces[-1] + letter) > width:
            pieces.append("")
        pieces[-1] += letter
    return pieces


@functools.cache
def _wide(size: int) -> Any:
    """Return the font that comes with matplotlib: wide, and with the letters of many alphabets."""
    import matplotlib
    from PIL import ImageFont

    return ImageFont.truetype(
        Path(matplotlib.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), size
    )
