"""MetaImage: .mha with its voxels behind the header, .mhd with them in files beside it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.volume_bytes import voxels_of_files
from meshdepict.io.volume_contents import VolumeContents, rescaled, several_values, three_counts
from meshdepict.io.volume_header import (
    LONGEST,
    checked_start,
    data_paths,
    floats,
    integers,
    numbered_names,
    value_type,
    voxels_of_text,
)
from meshdepict.voxels.length_unit import length_unit

__all__ = ["read_metaimage"]

_TYPES = {
    "CHAR": "i1", "UCHAR": "u1", "SHORT": "i2", "USHORT": "u2", "INT": "i4", "UINT": "u4",
    "LONG": "i4", "ULONG": "u4", "LONG_LONG": "i8", "ULONG_LONG": "u8", "FLOAT": "f4",
    "DOUBLE": "f8",
}  # fmt: skip
_YES = ("true", "1", "yes")


class _Header(dict[str, str]):
    """Values by the names of their lines, in lower case; and where the header ends."""

    length = 0
    files: tuple[str, ...] = ()

    def numbers(self, *names: str) -> list[float]:
        """Return the numbers of the first of some lines that there is."""
        return floats(self.word(*names))

    def counts(self, name: str) -> list[int]:
        """Return a line's whole numbers."""
        return integers(self.word(name))

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
    big = header.yes("elementbyteordermsb", "binarydatabyteordermsb")
    kind = value_type(name, _TYPES, big_endian=big)
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
        while line := file.readline(LONGEST):
            text = line.decode("utf-8", "replace")
            name, parted, value = text.partition("=")
            if not parted or file.tell() > LONGEST:
                break
            found[name.strip().lower()] = value.strip()
            if name.strip().lower() == "elementdatafile":
                found.length = file.tell()
                if value.split()[:1] == ["LIST"]:
                    names = file.read(LONGEST).decode("utf-8", "replace").splitlines()
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
    skip = checked_start((header.counts("headersize") or [0])[0])
    files = [path]
    if named.upper() == "LOCAL":
        skip = header.length
    else:
        names = header.files or numbered_names(named.split(), counts[-1]) or [named]
        files = data_paths(path.parent, names)
    packed = "zlib" if header.yes("compresseddata") else ""
    if header.word("binarydata").lower() not in ("", *_YES) and len(files) == 1:
        return voxels_of_text(files[0], kind, counts, notes, start=max(skip, 0))
    return voxels_of_files(files, kind, counts, notes, packed=packed, start=skip)


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
