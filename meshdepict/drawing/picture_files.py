"""Pictures as files: PNG, JPEG, SVG and PDF, each with where it comes from, which is read back."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict.drawing.page import Page, Picture, paint
from meshdepict.drawing.pdf_page import pdf_page, read_pdf_lines
from meshdepict.drawing.svg_page import read_svg_lines, svg_page
from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.mark import MARK

if TYPE_CHECKING:
    from PIL.Image import Image

    from meshdepict.drawing.figure import Figure

__all__ = [
    "PICTURES",
    "check_picture",
    "encoded",
    "read_picture_provenance",
    "write_page",
    "write_picture",
]

_QUALITY = 95  # of JPEG's 100; above, files grow and nobody sees why
_COMMENT = 65_000  # bytes of a JPEG's comment


def check_picture(path: str | Path, figure: Figure | None = None) -> None:
    """Refuse a name of another format, and what the format can't hold, before any work is done."""
    suffix = Path(path).suffix.lower()
    if suffix not in PICTURES:
        raise MeshdepictError(
            f"{path}: pictures are written as PNG, JPEG, SVG or PDF; end the name with .png, .jpg, "
            ".svg or .pdf"
        )
    if suffix in _JPEG and figure is not None and figure.ground is None:
        raise MeshdepictError(
            f"{path}: a JPEG has no transparency; choose another background, or write a .png"
        )


def write_page(page: Page, path: str | Path, facts: Mapping[str, str]) -> Path:
    """Write a page with facts about it, from where they can be read back; by the suffix.

    The same page becomes the same bytes.

    Raises
    ------
    MeshdepictError
        As `check_picture`, and where the file can't be written; an earlier one is left as it was.
    """
    check_picture(path)
    contents = encoded(page, Path(path).suffix.lower(), facts)
    with atomic_write(Path(path)) as stream:
        stream.write(contents)
    return Path(path)


def encoded(page: Page, suffix: str, facts: Mapping[str, str] | None = None) -> bytes:
    """Return what `write_page` writes into a file with a suffix."""
    lines = [f"{MARK}{key}: {text}" for key, text in (facts or {}).items()]
    return PICTURES[suffix](page, [line.encode("utf-8", "replace").decode() for line in lines])


def write_picture(
    image: Image, path: str | Path, facts: Mapping[str, str], dpi: float | None = None
) -> Path:
    """Write a ``PIL.Image`` as it is; see `write_page`."""
    ground = None if image.mode == "RGBA" else (255, 255, 255)
    return write_page(Page(image.size, ground, (Picture(image, 0, 0),), dpi), path, facts)


def read_picture_provenance(path: str | Path) -> list[str] | None:
    """Return the lines that this program wrote into a picture, None where there are none."""
    from PIL import Image

    suffix = Path(path).suffix.lower()
    try:
        if suffix in _VECTORS:
            lines = _VECTORS[suffix](path) or []
        else:
            with Image.open(path) as image:
                comment = bytes(image.info.get("comment", b"")).decode("utf-8", "replace")
                texts = getattr(image, "text", {})
            lines = [f"{key}: {text}" for key, text in texts.items()] or comment.splitlines()
    except (OSError, SyntaxError, ValueError, TypeError, Image.DecompressionBombError):
        return None  # whatever it is, this program didn't write it
    return [line for line in lines if line.startswith(MARK)] or None


def _png(page: Page, lines: Sequence[str]) -> bytes:
    from PIL.PngImagePlugin import PngInfo

    texts = PngInfo()
    for line in lines:
        key, _, text = line.partition(": ")
        texts.add_text(key, text)
    stream = io.BytesIO()
    paint(page).save(stream, format="PNG", pnginfo=texts, **_dots(page))
    return stream.getvalue()


def _jpeg(page: Page, lines: Sequence[str]) -> bytes:
    comment = "\n".join(" ".join(line.splitlines()) for line in lines).encode("utf-8", "replace")
    stream = io.BytesIO()
    paint(page).convert("RGB").save(
        stream, format="JPEG", quality=_QUALITY, subsampling=0, optimize=True,
        comment=comment[:_COMMENT], **_dots(page),
    )  # fmt: skip
    return stream.getvalue()


def _dots(page: Page) -> dict[str, tuple[float, float]]:
    return {"dpi": (page.dpi, page.dpi)} if page.dpi else {}


_JPEG = (".jpg", ".jpeg")
_VECTORS = {".svg": read_svg_lines, ".pdf": read_pdf_lines}

PICTURES: dict[str, Callable[[Page, Sequence[str]], bytes]] = {
    ".png": _png, ".jpg": _jpeg, ".jpeg": _jpeg, ".svg": svg_page, ".pdf": pdf_page,
}  # fmt: skip
"""What writes a page, by the suffix of its file."""
