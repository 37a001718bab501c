"""Pages as SVG: pictures inside, blocks and words as such, and what the file says of itself."""

from __future__ import annotations

import base64
import html
import io
import re
from collections.abc import Sequence
from pathlib import Path

from meshdepict.drawing.page import SCREEN, Block, Color, Page, Picture, Words
from meshdepict.errors import printable
from meshdepict.files.mark import SOFTWARE

__all__ = ["read_svg_lines", "svg_page"]

_FONTS = "Helvetica, Arial, 'DejaVu Sans', sans-serif"
_HALF = 0.36  # from the baseline to the middle of capital letters, in heights of letters
_BEGINNING = 1 << 20  # bytes where the metadata are: before any picture
_NO_CHARACTERS = re.compile("[\ufffe\uffff]")
_LINES = re.compile(r'<metadata id="meshdepict">\n(.*?)\n</metadata>', re.DOTALL)


def svg_page(page: Page, lines: Sequence[str]) -> bytes:
    """Return a page as an SVG file.

    Parameters
    ----------
    page : Page
    lines : sequence of str
        What `read_svg_lines` returns again.
    """
    width, height = page.size
    inch = page.dpi or SCREEN
    across, down = (f"{25.4 * side / inch:.4f}mm" for side in page.size)
    said = "\n".join(_escaped(line) for line in lines)
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<!-- {SOFTWARE} -->",
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{across}" height="{down}" '
        f'viewBox="0 0 {width} {height}">',
        f'<metadata id="meshdepict">\n{said}\n</metadata>',
    ]
    if page.ground is not None:
        parts.append(_block(Block(0, 0, width, height, page.ground)))
    for part in page.parts:
        if isinstance(part, Picture):
            parts.append(_picture(part))
        elif isinstance(part, Block):
            parts.append(_block(part))
        else:
            parts.append(_words(part))
    return "\n".join([*parts, "</svg>", ""]).encode("utf-8", "replace")


def read_svg_lines(path: str | Path) -> list[str] | None:
    """Return what `svg_page` was given, None where this program didn't write the file."""
    with Path(path).open("rb") as stream:
        beginning = stream.read(_BEGINNING).decode("utf-8", "replace")
    found = _LINES.search(beginning)
    return [html.unescape(line) for line in found[1].splitlines()] if found else None


def _picture(part: Picture) -> str:
    stream = io.BytesIO()
    part.image.save(stream, format="PNG")
    code = base64.b64encode(stream.getvalue()).decode()
    width, height = part.image.size
    return (
        f'<image x="{part.left}" y="{part.top}" width="{width}" height="{height}" '
        f'preserveAspectRatio="none" href="data:image/png;base64,{code}"/>'
    )


def _block(part: Block) -> str:
    return (
        f'<rect x="{part.left:.6g}" y="{part.top:.6g}" width="{part.right - part.left:.6g}" '
        f'height="{part.bottom - part.top:.6g}" fill="{_hex(part.color)}"/>'
    )


def _words(part: Words) -> str:
    anchor = {"l": "start", "m": "middle"}[part.anchor]
    rim = ""
    if part.rim:
        rim = (
            f' stroke="{_hex(part.around)}" stroke-width="{2 * part.rim}" '
            'stroke-linejoin="round" paint-order="stroke"'
        )
    return (
        f'<text x="{part.x:.6g}" y="{part.y + _HALF * part.size:.6g}" font-size="{part.size}" '
        f'font-family="{_FONTS}" text-anchor="{anchor}" fill="{_hex(part.color)}"{rim}>'
        f"{_escaped(part.text)}</text>"
    )


def _hex(color: Color) -> str:
    return f"#{bytes(color).hex()}"


def _escaped(text: str) -> str:
    """Return a text for XML, which has neither control characters nor what Unicode leaves out."""
    return html.escape(_NO_CHARACTERS.sub("\N{REPLACEMENT CHARACTER}", printable(text)))
