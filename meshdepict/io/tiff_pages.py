"""The directories of a TIFF file: a page each, and what ImageJ and OME say of the whole stack."""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

from meshdepict.errors import MeshdepictError
from meshdepict.voxels.length_unit import MILLIMETRES, length_unit

__all__ = ["TIFF_MARKS", "Page", "Scale", "scale_of", "tiff_pages"]

TIFF_MARKS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
"""How a TIFF begins: two orders of bytes, two widths of places."""

_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4, 16: 8}
_LETTERS = {1: "B", 3: "H", 4: "I", 6: "b", 8: "h", 9: "i", 11: "f", 12: "d", 13: "I", 16: "Q"}
_NAMES = {
    254: "subfile", 256: "width", 257: "height", 258: "bits", 259: "compression",
    262: "photometric", 270: "description", 273: "offsets", 277: "samples", 279: "lengths",
    282: "resolution", 283: "resolution_y", 322: "tile", 339: "format",
    33550: "map_scale", 33922: "map_points", 34264: "map_transform", 34735: "map_keys",
}  # fmt: skip
_MOST_PAGES = 1 << 20
_FLOATS = (5, 10, 11, 12)  # types of entries; only resolutions and places on a map have them


@dataclass
class Page:
    """What one directory says; lists of numbers by the names of its entries."""

    entries: dict[str, list[Any]] = field(default_factory=dict)
    description: str = ""
    order: str = "<"

    def get(self, name: str, default: int) -> int:
        """Return an entry's first number."""
        found = self.entries.get(name)
        return int(found[0]) if found else default

    @property
    def kind(self) -> str:
        """The numbers' type, such as "u2"; "" for what is none."""
        bits = self.get("bits", 1)
        letter = {1: "u", 2: "i", 3: "f", 4: "u"}.get(self.get("format", 1), "")
        fits = bits in ((16, 32, 64) if letter == "f" else (8, 16, 32, 64))
        return f"{letter}{bits // 8}" if letter and fits else ""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.get("height", 0), self.get("width", 0)

    @property
    def on_map(self) -> bool:
        """Whether it says where on a map it lies: a GeoTIFF."""
        keys = self.entries.get("map_keys", [])
        return len(keys) > 4 or any(self.entries.get(f"map_{n}") for n in ("scale", "transform"))

    @property
    def alike(self) -> tuple[Any, ...]:
        """What all pages of a stack have in common."""
        return self.shape, self.kind, self.get("samples", 1), self.get("photometric", 1)


def tiff_pages(path: Path) -> list[Page]:
    """Return the pages of a file, without pictures of reduced size.

    A TIFF's header gives the place of the first page's directory; each gives that of the next one
    after its entries.

    Raises
    ------
    MeshdepictError
        For a file whose chain of pages is broken or goes round, or that is no TIFF.
    """
    size = path.stat().st_size
    pages: list[Page] = []
    seen: set[int] = set()
    left = 4 * size  # bytes that all directories may point to: they could share one long list
    with path.open("rb") as file:
        head = file.read(16)
        order = {b"II": "<", b"MM": ">"}.get(head[:2], "")
        if head[:4] not in TIFF_MARKS:
            raise MeshdepictError(f"is cut off, damaged or no TIFF: {path.name}")
        is_big = head[2:4] in (b"+\0", b"\0+")  # version 43
        try:
            at = struct.unpack_from(order + ("Q" if is_big else "I"), head, 8 if is_big else 4)[0]
            while at:
                if at in seen or len(seen) >= _MOST_PAGES:
                    raise MeshdepictError(f"is damaged: {path.name}, its pages go round in circles")
                seen.add(at)
                page, at, used = _page(file, at, left, order, is_big=is_big)
                left -= used
                if pages:
                    page.description = ""
                if not page.get("subfile", 0) & 1:
                    pages.append(page)
        except (struct.error, OverflowError, ValueError, OSError) as error:
            if isinstance(error, MeshdepictError):
                raise
            if isinstance(error, OSError) and error.errno not in (22, None):  # a place before 0
                raise
            raise MeshdepictError(f"is cut off or damaged: {path.name}") from error
    if not pages or not all(min(page.shape) > 0 for page in pages):
        raise MeshdepictError(f"is damaged: {path.name}, it has no page with pixels")
    return pages


def _page(file: BinaryIO, at: int, most: int, order: str, *, is_big: bool) -> tuple[Page, int, int]:
    """Return a directory, the place of the next, and how many bytes it took."""
    page = Page(order=order)
    letter, count_letter, length = ("Q", "Q", 20) if is_big else ("I", "H", 12)
    file.seek(at)
    start = file.read(struct.calcsize(order + count_letter))
    (count,) = struct.unpack(order + count_letter, start)
    used = count * length
    if used > most:
        raise struct.error
    table = file.read(count * length)
    (following,) = struct.unpack(order + letter, file.read(struct.calcsize(order + letter)))
    for entry in range(count):
        tag, kind = struct.unpack_from(order + "HH", table, entry * length)
        name = _NAMES.get(tag)
        floats = kind in _FLOATS and not str(name).startswith(("resolution", "map"))
        if name is None or kind not in _SIZES or floats:
            continue
        (number,) = struct.unpack_from(order + letter, table, entry * length + 4)
        if not number:  # an entry of nothing is none
            continue
        needed = number * _SIZES[kind]
        place = entry * length + 4 + struct.calcsize(order + letter)
        if needed > (8 if is_big else 4):
            used += needed
            if used > most:
                raise struct.error
            (where,) = struct.unpack_from(order + letter, table, place)
            file.seek(where)
            value = file.read(needed)
            if len(value) < needed:
                raise struct.error
        else:
            value = table[place : place + needed]
        if name == "description":
            page.description = value.decode("utf-8", "replace").rstrip("\0")
        elif kind in (5, 10):
            parts = struct.unpack(f"{order}{2 * number}{'I' if kind == 5 else 'i'}", value)
            page.entries[name] = [
                a / b if b else math.nan for a, b in zip(parts[::2], parts[1::2], strict=True)
            ]
        elif kind in _LETTERS:
            page.entries[name] = list(struct.unpack(f"{order}{number}{_LETTERS[kind]}", value))
    return page, following, used


@dataclass(frozen=True)
class Scale:
    """What a stack's first page says of the whole.

    Attributes
    ----------
    spacing : (3,) tuple of float or None
        Along x, y and z, where all three are told.
    unit : str
        Their unit of length.
    slices : int
        So many, of one page's size, lie behind each other (ImageJ's large stacks); 0: not said.
    several : str
        "channels" or "times" where the stack has more than one.
    """

    spacing: tuple[float, float, float] | None = None
    unit: str = ""
    slices: int = 0
    several: str = ""


def scale_of(page: Page) -> Scale:
    """Return what ImageJ or OME say in the first page."""
    if page.description.startswith("ImageJ="):
        return _imagej(page)
    if "<Pixels" in page.description:
        return _ome(page.description)
    return Scale()


def _imagej(page: Page) -> Scale:
    lines = dict(
        line.partition("=")[::2] for line in page.description[: 1 << 16].splitlines() if "=" in line
    )
    # Above 7 bits letters are written as \u00B5.
    text = re.sub(r"\\u([0-9a-fA-F]{4})", lambda code: chr(int(code[1], 16)), lines.get("unit", ""))
    unit = length_unit(text)
    step = _positive(lines.get("spacing", ""))
    across = [1 / n if n and math.isfinite(n) else math.nan for n in _resolutions(page)]
    spacing = None
    if unit and step and len(across) == 2 and all(map(math.isfinite, across)):
        spacing = (across[0], across[1], step)
    several = next(
        (word for word in ("channels", "frames") if _whole(lines.get(word, "1")) > 1), ""
    )
    return Scale(spacing, unit if spacing else "", _whole(lines.get("images", "0")), several)


def _resolutions(page: Page) -> list[float]:
    """Return pixels per unit along x and y."""
    first = page.entries.get("resolution", [])
    return [*first[:1], *page.entries.get("resolution_y", first)[:1]]


def _ome(text: str) -> Scale:
    found = re.search(r"<Pixels\b([^<>]*)", text)
    words = dict(re.findall(r"(\w+)\s*=\s*[\"']([^\"'<>]*)[\"']", found[1] if found else ""))
    lengths = [_positive(words.get(f"PhysicalSize{axis}", "")) for axis in "XYZ"]
    units = [length_unit(words.get(f"PhysicalSize{axis}Unit", "µm")) for axis in "XYZ"]
    several = next(
        (name for name, word in (("channels", "SizeC"), ("times", "SizeT"))
         if _whole(words.get(word, "1")) > 1),
        "",
    )  # fmt: skip
    if not all(lengths) or not all(units):
        return Scale(several=several)
    scale = [MILLIMETRES[unit] / MILLIMETRES[units[0]] for unit in units]
    x, y, z = (length * by for length, by in zip(lengths, scale, strict=True))
    return Scale((x, y, z), units[0], several=several)


def _positive(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        return 0.0
    return number if 0 < number < math.inf else 0.0


def _whole(text: str) -> int:
    return int(text) if re.fullmatch(r"\s*\d{1,9}\s*", text) else 0
