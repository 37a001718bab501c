"""Headers of text, as NRRD and MetaImage have them: their numbers, and the data files they name."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.files.reach import inside
from meshdepict.io.volume_bytes import text_numbers, voxels
from meshdepict.io.volume_contents import printable

__all__ = [
    "LONGEST", "checked_start", "data_paths", "floats", "integers", "numbered_names",
    "value_type", "voxels_of_text",
]  # fmt: skip

LONGEST = 1 << 20
"""Bytes of header, or of a line of it."""

_COMMA = re.compile(r"^([+-]?\d+),(\d+(?:[eE][+-]?\d+)?)$")


def floats(text: str) -> list[float]:
    """Return numbers parted by blanks; "0,5" is a half, as some programs write it abroad.

    Raises
    ------
    MeshdepictError
        For words: one clause whose subject is the file, as everywhere here.
    """
    try:
        return [float(_COMMA.sub(r"\1.\2", word)) for word in text.split()]
    except ValueError:
        raise MeshdepictError(
            f"is damaged: its header has {printable(text)[:60]!r} for numbers"
        ) from None


def integers(text: str) -> list[int]:
    """Return whole numbers parted by blanks.

    Raises
    ------
    MeshdepictError
        For anything else.
    """
    words = text.split()
    if not all(re.fullmatch(r"[+-]?\d{1,18}", word) for word in words):
        raise MeshdepictError(
            f"is damaged: its header has {printable(text)[:60]!r} for whole numbers"
        )
    return [int(word) for word in words]


def value_type(name: str, types: dict[str, str], *, big_endian: bool) -> np.dtype[Any]:
    """Return NumPy's type of the voxels by the format's name for it.

    Raises
    ------
    MeshdepictError
        For a name that isn't among `types`.
    """
    if name not in types:
        raise MeshdepictError(
            f"holds values of the type {printable(name)[:30]!r}: save it as integers or floats"
        )
    return np.dtype(types[name]).newbyteorder(">" if big_endian else "<")


def checked_start(skip: int, lines: int = 0, *, from_end: bool = True) -> int:
    """Return how many bytes to skip; −1, where that is allowed, as voxels are a file's end.

    Raises
    ------
    MeshdepictError
        For places that no file has.
    """
    if not -int(from_end) <= skip < 1 << 40 or not 0 <= lines < 1 << 30:
        raise MeshdepictError("is damaged: its header says an impossible place of its voxels")
    return skip


def data_paths(folder: Path, names: Sequence[str]) -> list[Path]:
    """Return where the data files lie: in the header's folder, or below."""
    return [inside(folder, name.removeprefix("./"), "data file") for name in names]


def numbered_names(words: Sequence[str], most: int) -> list[str]:
    """Return the names that a pattern stands for, such as ``slice%03d.raw 1 24 1``.

    Parameters
    ----------
    words : sequence of str
        The pattern, and the first number, the last one and the step; others: no names.
    most : int
        Slices.

    Raises
    ------
    MeshdepictError
        For a step of none, and for more names than slices.
    """
    if len(words) != 4 or not re.search(r"%\d*d", words[0]):
        return []
    if not all(re.fullmatch(r"[+-]?\d{1,9}", word) for word in words[1:]):
        return []
    first, last, step = map(int, words[1:])
    count = (last - first) // step + 1 if step else 0
    if not 0 < count <= most:
        raise MeshdepictError("is damaged: its header numbers more data files than slices")

    def name(number: int) -> str:
        def digits(match: re.Match[str]) -> str:
            width = min(int(match[2] or 0), 99)
            return f"{number:0{width}d}" if match[1] else f"{number:{width}d}"

        return re.sub(r"%(0?)(\d*)d", digits, words[0], count=1)

    return [name(first + at * step) for at in range(count)]


def voxels_of_text(
    path: Path, kind: np.dtype[Any], counts: tuple[int, int, int], notes: list[str], *,
    start: int = 0, lines: int = 0, skip: int = 0, hexadecimal: bool = False,
) -> NDArray[Any]:  # fmt: skip
    """Return voxels that are written in letters: decimal numbers, or bytes as hexadecimal ones.

    Parameters
    ----------
    path : Path
    kind, counts, notes
        As for `volume_bytes.voxels`.
    start, lines, skip : int
        Bytes in front of them, then lines, and bytes again.
    hexadecimal : bool
    """
    if not path.is_file():
        raise MeshdepictError(f"names the data file {path.name!r}, which is not there")
    size = path.stat().st_size
    check_claim(math.prod(counts) * kind.itemsize, size, "voxels")
    with path.open("rb") as file:
        file.seek(start)
        for _ in range(lines):
            if not file.readline(LONGEST):
                break
        file.seek(skip, 1)
        text = file.read()
    if not hexadecimal:
        return text_numbers(text, kind, counts, notes)
    try:
        data = bytes.fromhex(text.decode("ascii"))
    except ValueError:
        raise MeshdepictError("is damaged: its voxels are no hexadecimal numbers") from None
    return voxels(io.BytesIO(data), size, kind, counts, notes)
