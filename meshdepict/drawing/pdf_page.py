"""Pages as PDF: pictures inside, blocks and words as such, and what the file says of itself."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshdepict.drawing.page import SCREEN, Block, Color, Page, Picture, Words
from meshdepict.errors import printable
from meshdepict.files.mark import SOFTWARE

__all__ = ["pdf_page", "read_pdf_lines"]

_HALF = 0.365  # from the baseline to the middle of capital letters, in heights of letters
_POINTS = 72.0  # per inch
_END = 1 << 20  # bytes at the end of a file where what it says of itself is
_LINES = re.compile(rb"/Keywords \(((?:[^\\()]|\\.)*)\)", re.DOTALL)
_ESCAPES = {b"n": b"\n", b"r": b"\r"}


def pdf_page(page: Page, lines: Sequence[str]) -> bytes:
    """Return a page as a PDF file of one page, the same bytes for the same page.

    Fonts are inside, so that words look alike everywhere and can be searched and copied.

    Parameters
    ----------
    page : Page
    lines : sequence of str
        What `read_pdf_lines` returns again.
    """
    import matplotlib
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

    (width, height), inch = page.size, page.dpi or SCREEN
    settings = {
        "pdf.fonttype": 42,  # letters, not outlines
        "pdf.compression": 9,
        "font.family": "DejaVu Sans",
        "text.usetex": False,
        "text.parse_math": False,  # a dollar is a dollar
    }
    with matplotlib.rc_context(settings), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of letters that no font has
        figure = Figure(figsize=(width / inch, height / inch), frameon=False)
        canvas = FigureCanvasPdf(figure)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set_xlim(0, width)
        axes.set_ylim(height, 0)
        parts = page.parts
        if page.ground is not None:
            parts = (Block(0, 0, width, height, page.ground), *parts)
        for order, part in enumerate(parts):
            if isinstance(part, Picture):
                wide, high = part.image.size
                extent = part.left, part.left + wide, part.top + high, part.top
                axes.imshow(
                    np.asarray(part.image), extent=extent, interpolation="none", aspect="auto",
                    zorder=order, clip_on=False,
                )  # fmt: skip
                axes.set_xlim(0, width)  # which imshow moves
                axes.set_ylim(height, 0)
            elif isinstance(part, Block):
                across, down = part.right - part.left, part.bottom - part.top
                look: dict[str, Any] = {
                    "facecolor": _share(part.color),
                    "linewidth": 0,
                    "clip_on": False,
                }
                axes.add_patch(
                    Rectangle((part.left, part.top), across, down, lw=0, zorder=order, **look)
                )
            else:
                _write(axes, part, _POINTS / inch, order)
        stream = io.BytesIO()
        facts = {"Creator": SOFTWARE, "CreationDate": None}
        facts["Keywords"] = "\n".join(printable(line) for line in lines)
        canvas.print_pdf(stream, metadata=facts)
    return stream.getvalue()


def read_pdf_lines(path: str | Path) -> list[str] | None:
    """Return what `pdf_page` was given, None where this program didn't write the file."""
    with Path(path).open("rb") as stream:
        stream.seek(0, io.SEEK_END)
        stream.seek(max(0, stream.tell() - _END))
        found = _LINES.search(stream.read())
    if found is None:
        return None
    raw = re.sub(rb"\\(.)", lambda escape: _ESCAPES.get(escape[1], escape[1]), found[1], flags=16)
    wide = raw.startswith(b"\xfe\xff")
    return raw.decode("utf-16" if wide else "latin-1", "replace").splitlines()


def _write(axes: Any, part: Words, points: float, order: int) -> None:
    """Write a line of text; its rim is drawn below it, since letters with one become outlines."""
    from matplotlib.patheffects import Stroke

    place = part.x, part.y + _HALF * part.size
    look = {
        "fontsize": part.size * points, "va": "baseline", "zorder": order, "clip_on": False,
        "ha": {"l": "left", "m": "center"}[part.anchor],
    }  # fmt: skip
    text = printable(part.text)
    if part.rim:
        rim = Stroke(linewidth=2 * part.rim * points, foreground=_share(part.around))
        axes.text(*place, text, path_effects=[rim], **look)
    axes.text(*place, text, color=_share(part.color), **look)


def _share(color: Color) -> tuple[float, float, float]:
    red, green, blue = color
    return red / 255, green / 255, blue / 255
