"""MetaImage: .mha with its voxels behind the header, .mhd with them in files beside it."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.files.reach import inside
from meshdepict.io.volume_bytes import (
    numbered_names,
    text_numbers,
    voxels_of_files,
)
from meshdepict.io.volume_contents import (
    VolumeContents,
    printable,
    rescaled,
    several_values,
    three_counts,
)
from meshdepict.voxels.length_unit import length_unit

__all__ = ["read_metaimage"]

_TYPES = {
    "CHAR": "i1", "UCHAR": "u1", "SHORT": "i2", "USHORT": "u2", "INT": "i4", "UINT": "u4",
    "LONG": "i4", "ULONG": "u4", "LONG_LONG": "i8", "ULONG_LONG": "u8", "FLOAT": "f4",
    "DOUBLE": "f8",
}  # fmt: skip
_LONGEST = 1 << 20  # bytes of header
_YES = ("true", "1", "yes")


class _Header(dict[str, str]):
    """Values by the names of their lines, in lower case; and where the header ends."""

    length = 0
    files: tuple[str, ...] = ()

    def numbers(self, *names: str) -> list[float]:
        """Return the numbers of the first of some lines that there is."""
        text = self.word(*names)
        try:
            return [float(word) for word in text.split()]
        except ValueError:
            raise MeshdepictError(
                f"is damaged: its header has {printable(text)[:60]!r} for numbers"
            ) from None

    def counts(self, name: str) -> list[int]:
        """Return a line's whole numbers."""
        words = self.word(name).split()
        if not all(re.fullmatch(r"[+-]?\d{1,18}", word) for word in words):
            raise MeshdepictError(
                f"is damaged: its header has {printable(self.word(name))[:60]!r} for whole numbers"
            )
        return [int(word) for word in words]

    def word(self, *names: str) -> str:
        """Return the text of the first of some lines that there is."""
        return next((self[name] for name in names if name in self), "")

    def yes(self, *names: str) -> bool:
        """Return whether the first of some lines that there is says True."""
        return self.word(*names).lower() in _YES


def read_metaimage(path: Path) -> VolumeContents:
    """Return a volume, in the file's own unit of length where it says one.

    Raises
    ------
    MeshdepictError
        For damaged files, other dimensions than three, several values in a voxel, and data files
        outside of the header's folder: one clause whose subject is the file.
    """
    notes: list[str] = []
    header = _header(path)
    channels = (header.counts("elementnumberofchannels") or [1])[0]
    name = header.word("elementtype").upper().removeprefix("MET_")
    if name.endswith("_ARRAY") and channels == 1:
        channels = 2
    if channels != 1:
        raise several_values(channels)
    sizes = header.counts("dimsize")
    if header.counts("ndims") != [len(sizes)]:
        raise MeshdepictError("is damaged: its header says other dimensions than sizes")
    counts = three_counts(sizes)
    if name not in _TYPES:
        raise MeshdepictError(
            f"holds values of the type {printable(name)[:30]!r}: save it as integers or floats"
        )
    big = header.yes("elementbyteordermsb", "binarydatabyteordermsb")
    kind = np.dtype(_TYPES[name]).newbyteorder(">" if big else "<")
    values = _values(path, header, kind, counts, notes)
    slope = header.numbers("elementtointensityfunctionslope") or [1.0]
    shift = header.numbers("elementtointensityfunctionoffset") or [0.0]
    if slope[0] and all(map(math.isfinite, (slope[0], shift[0]))):
        values = rescaled(values, slope[0], shift[0])
    unit = length_unit(header.word("meshdepict_length_unit") or header.word("distanceunits"))
    hounsfield = header.word("meshdepict_unit") == "HU"
    return VolumeContents(values, _place(header), hounsfield, unit, notes=notes)


def _header(path: Path) -> _Header:
    found = _Header()
    with path.open("rb") as file:
        while line := file.readline(_LONGEST):
            text = line.decode("utf-8", "replace")
            name, parted, value = text.partition("=")
            if not parted or file.tell() > _LONGEST:
                break
            found[name.strip().lower()] = value.strip()
            if name.strip().lower() == "elementdatafile":
                found.length = file.tell()
                if value.split()[:1] == ["LIST"]:
                    names = file.read(_LONGEST).decode("utf-8", "replace").splitlines()
                    found.files = tuple(name.strip() for name in names if name.strip())
                break
    if not {"ndims", "dimsize", "elementtype", "elementdatafile"} <= set(found):
        raise MeshdepictError(
            "is cut off, damaged or not what its suffix says: it has no header of MetaImage"
        )
    return found


def _values(
    path: Path, header: _Header, kind: np.dtype[Any], counts: tuple[int, int, int],
    notes: list[str],
) -> NDArray[Any]:  # fmt: skip
    named = header["elementdatafile"]
    skip = (header.counts("headersize") or [0])[0]
    if not -1 <= skip < 1 << 40:
        raise MeshdepictError("is damaged: its header says an impossible place of its voxels")
    files = [path]
    if named.upper() == "LOCAL":
        skip = header.length
    else:
        names = header.files or _numbered_files(named, counts) or [named]
        files = [inside(path.parent, name.removeprefix("./"), "data file") for name in names]
    packed = "zlib" if header.yes("compresseddata") else ""
    if header.word("binarydata").lower() not in ("", *_YES) and len(files) == 1:
        if not files[0].is_file():
            raise MeshdepictError(f"names the data file {files[0].name!r}, which is not there")
        check_claim(math.prod(counts) * kind.itemsize, files[0].stat().st_size, "voxels")
        with files[0].open("rb") as file:
            file.seek(max(skip, 0))
            return text_numbers(file.read(), kind, counts, notes)
    return voxels_of_files(files, kind, counts, notes, packed=packed, start=skip)


def _numbered_files(named: str, counts: tuple[int, int, int]) -> list[str]:
    """Return the names that a pattern such as ``slice%03d.raw 1 24 1`` stands for, or none."""
    words = named.split()
    if len(words) != 4 or not re.search(r"%\d*d", words[0]):
        return []
    if not all(re.fullmatch(r"[+-]?\d{1,9}", word) for word in words[1:]):
        return []
    first, last, step = map(int, words[1:])
    return numbered_names(words[0], first, last, step, counts[-1])


def _place(header: _Header) -> dict[str, Any]:
    spacing = header.numbers("elementspacing", "elementsize")
    origin = header.numbers("offset", "position", "origin")
    matrix = header.numbers("transformmatrix", "rotation", "orientation")
    for numbers, count in ((spacing, 3), (origin, 3), (matrix, 9)):
        if numbers and len(numbers) < count:
            raise MeshdepictError("is damaged: its header says where it lies in too few numbers")
    place: dict[str, Any] = {}
    if origin:
        place["origin"] = np.array(origin[:3])
    if not spacing:
        if matrix:
            place["direction"] = np.reshape(matrix[:9], (3, 3)).T
        return place
    way = np.reshape(matrix[:9], (3, 3)).T if matrix else np.eye(3)  # a row for each axis
    with np.errstate(over="ignore", invalid="ignore"):  # what isn't finite is refused later
        return place | {"steps": way * np.array(spacing[:3])}
