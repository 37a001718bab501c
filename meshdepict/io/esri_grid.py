"""ESRI's ASCII grids: a header of words and numbers, and the heights row by row from the north."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers
from meshdepict.files.limits import check_claim
from meshdepict.heights.cells import Transform, checked_transform
from meshdepict.io.crs import units_of
from meshdepict.io.height_source import (
    INFINITE,
    HeightSource,
    heights_of,
    note_units,
    whole_array,
)
from meshdepict.io.text import floats

__all__ = ["is_esri_grid", "open_esri_grid"]

_WORDS = (
    "ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy",
    "nodata_value",
)  # fmt: skip
_LINE = re.compile(rb"[ \t]*([A-Za-z_]+)[ \t]+(\S+)[ \t]*(?:\r\n|\r|\n|$)")
_LONGEST = 1 << 16  # bytes of a header, and of a text beside it
_NO_NUMBERS = re.compile(rb"(?i)-?1?\.?#(?:qnan|ind|inf|snan)\d*|(?<![^\s])\*(?![^\s])")


def is_esri_grid(start: bytes) -> bool:
    """Whether a file begins as an ASCII grid does: with one of its words and a number."""
    match = _LINE.match(start)
    return bool(match) and match[1].lower().decode() in _WORDS  # type: ignore[index]


def open_esri_grid(path: Path, data: bytes, unit: str) -> HeightSource:
    """Read an ASCII grid; a ``.prj`` beside it says its CRS.

    Parameters
    ----------
    path : Path
    data : bytes
        The file's.
    unit : str
        Of its heights, "" for none.

    Raises
    ------
    MeshdepictError
        For a header that lacks or repeats what it must say, and another number of heights than it
        claims: a clause whose subject is the file.
    """
    words, start = _header(data)
    cols, rows = (_count(words, name) for name in ("ncols", "nrows"))
    transform = _transform(words, rows)
    size = len(data)
    check_claim(8 * rows * cols, size, "heights")
    z: NDArray[Any] = _heights(data[start:], rows, cols)
    nodata = words.get("nodata_value")
    with any_numbers():
        narrow = z.astype(np.float32)
        valid = np.ones(z.shape, bool)
        if nodata is not None:  # to seven digits, as other programs compare it
            valid = narrow != np.float32(nodata)
        if np.all((narrow == z) | ~np.isfinite(z) | ~valid):
            z = narrow
    source = HeightSource(rows, cols, transform, whole_array(z, valid))
    _place(source, path)
    if nodata is not None:
        source.attributes["nodata"] = nodata
    scale = note_units(source, "", units_of(source.crs).vertical, unit, source.notes)
    z, valid, infinite = heights_of(z, valid, scale, 0)
    source.notes += [INFINITE] if infinite else []
    source.read, source.kind, source.size = whole_array(z, valid), z.dtype, size
    return source


def _header(data: bytes) -> tuple[dict[str, float], int]:
    """Return the numbers of the header's words, and where the heights begin."""
    words: dict[str, float] = {}
    at = 0
    while at < _LONGEST and (match := _LINE.match(data, at)):
        word, text = match[1].decode().lower(), match[2].decode("latin-1")
        if word not in _WORDS:
            if word in ("nan", "inf", "infinity"):
                break
            raise MeshdepictError(f"has the unknown word {word[:40]!r} in its header")
        if word in words:
            raise MeshdepictError(f"says {word} twice in its header")
        try:
            words[word] = float(text.replace(",", "."))
        except ValueError:
            raise MeshdepictError(f"says {text[:40]!r} for {word}, which is no number") from None
        at = match.end()
    return words, at


def _count(words: dict[str, float], name: str) -> int:
    number = words.get(name)
    if number is None:
        raise MeshdepictError(f"lacks {name} in its header")
    if not (1 <= number < 1 << 31 and number == int(number)):
        raise MeshdepictError(f"says {number:g} for {name}, which is no count")
    return int(number)


def _transform(words: dict[str, float], rows: int) -> Transform:
    """Return the transform: corners or centres of the lower left cell, one cell size or two."""
    dx, dy = (words.get(name, words.get("cellsize")) for name in ("dx", "dy"))
    if dx is None or dy is None:
        raise MeshdepictError("lacks cellsize (or dx and dy) in its header")
    if not (0 < dx < math.inf and 0 < dy < math.inf):
        raise MeshdepictError(f"says a cell size of {dx:g} x {dy:g}, which is none")
    place = []
    for axis, step in (("x", dx), ("y", dy)):
        corner, centre = words.get(f"{axis}llcorner"), words.get(f"{axis}llcenter")
        if corner is None and centre is None:
            raise MeshdepictError(f"lacks {axis}llcorner (or {axis}llcenter) in its header")
        place.append(corner if corner is not None else (centre or 0) - step / 2)
    x, y = place
    return checked_transform((dx, 0, x, 0, -dy, y + rows * dy))


def _heights(text: bytes, rows: int, cols: int) -> NDArray[np.float64]:
    text = _NO_NUMBERS.sub(b"nan", text)
    try:
        try:
            values = floats(text)
        except ValueError:  # decimal commas
            values = floats(text.replace(b",", b"."))
    except ValueError:
        raise MeshdepictError("is damaged: not all of its heights are numbers") from None
    if len(values) < rows * cols:
        raise MeshdepictError(
            f"is cut off: it holds {len(values):,} of the {rows * cols:,} heights that its header "
            "claims"
        )
    if len(values) > rows * cols:
        raise MeshdepictError(
            f"holds {len(values):,} heights, and its header claims {rows * cols:,}: correct the "
            "header"
        )
    return values.reshape(rows, cols)


def _place(source: HeightSource, path: Path) -> None:
    """Take the CRS from the text beside a grid."""
    stem = path.with_suffix("") if path.suffix.lower() == ".gz" else path
    for name in (stem.with_suffix(".prj"), stem.with_suffix(".PRJ")):
        if name.is_file():
            with name.open("rb") as file:
                source.crs = file.read(_LONGEST).decode("utf-8", "replace").strip().lstrip("\ufeff")
            break
    units = units_of(source.crs)
    source.degrees, source.unit = units.degrees, units.unit
