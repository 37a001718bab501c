"""NRRD, with its voxels behind the header or in files beside it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.volume_bytes import voxels_of_files
from meshdepict.io.volume_contents import (
    VolumeContents,
    printable,
    several_values,
    three_counts,
)
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
from meshdepict.voxels.length_unit import MILLIMETRES, length_unit

__all__ = ["read_nrrd"]

_TYPES = {
    "i1": ("signed char", "int8", "int8_t"),
    "u1": ("uchar", "unsigned char", "uint8", "uint8_t"),
    "i2": ("short", "short int", "signed short", "signed short int", "int16", "int16_t"),
    "u2": ("ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"),
    "i4": ("int", "signed int", "int32", "int32_t"),
    "u4": ("uint", "unsigned int", "uint32", "uint32_t"),
    "i8": ("longlong", "long long", "long long int", "signed long long",
           "signed long long int", "int64", "int64_t"),
    "u8": ("ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"),
    "f4": ("float",),
    "f8": ("double",),
}  # fmt: skip
_KINDS = {word: kind for kind, words in _TYPES.items() for word in words}
_PACKED = {"raw": "", "gzip": "gzip", "gz": "gzip", "bzip2": "bzip2", "bz2": "bzip2"}
_TEXT = ("ascii", "text", "txt")
_DOMAINS = ("domain", "space", "time", "none", "???", "list")
_SPACES = {
    "right-anterior-superior": (-1.0, -1.0, 1.0), "ras": (-1.0, -1.0, 1.0),
    "left-anterior-superior": (1.0, -1.0, 1.0), "las": (1.0, -1.0, 1.0),
}  # fmt: skip
_UNIT = "meshdepict_unit"
_LENGTH_UNIT = "meshdepict_length_unit"


@dataclass
class _Header:
    fields: dict[str, str] = field(default_factory=dict)
    keys: dict[str, str] = field(default_factory=dict)
    files: list[str] = field(default_factory=list)  # of "data file: LIST"
    length: int = 0  # bytes, to the blank line and with it


def read_nrrd(path: Path) -> VolumeContents:
    """Return a volume in the patient's frame (LPS), in the file's own unit of length.

    Raises
    ------
    MeshdepictError
        For damaged files, other dimensions than three, several values in a voxel, and data files
        outside of the header's folder: one clause whose subject is the file.
    """
    notes: list[str] = []
    header = _header(path)
    counts = _counts(header)
    kind = _kind(header)
    values = _values(path, header, kind, counts, notes)
    place, unit = _place(header)
    hounsfield = header.keys.get(_UNIT) == "HU"
    unit = length_unit(header.keys.get(_LENGTH_UNIT, "")) or unit
    return VolumeContents(values, place, hounsfield, unit, notes=notes)


def _header(path: Path) -> _Header:
    found = _Header()
    with path.open("rb") as file:
        if not re.match(rb"NRRD000[1-9]\r?\n?$", file.readline(16)):
            raise MeshdepictError(
                "is cut off, damaged or not what its suffix says: it doesn't begin as NRRD does"
            )
        listed = False
        while line := file.readline(LONGEST):
            if file.tell() > LONGEST:
                raise MeshdepictError("is damaged: its header has no end")
            text = line.decode("utf-8", "replace").rstrip("\r\n")
            if listed and text.strip():
                found.files.append(text.strip())
                continue
            if not text.strip():
                break
            if text.startswith("#"):
                continue
            name, parted, value = text.partition(":")
            if not parted:
                raise MeshdepictError(
                    f"is damaged: its header has the line {printable(text)[:40]!r}"
                )
            if value.startswith("="):
                found.keys[name] = value[1:].replace("\\n", "\n")
                continue
            found.fields[name.strip().lower().replace("datafile", "data file")] = value.strip()
            listed = name.strip().lower() in ("data file", "datafile") and value.split()[:1] == [
                "LIST"
            ]
        found.length = file.tell()
    for name in ("type", "dimension", "sizes", "encoding"):
        if name not in found.fields:
            raise MeshdepictError(f"is cut off or damaged: its header lacks {name!r}")
    return found


def _counts(header: _Header) -> tuple[int, int, int]:
    """Return the voxels along x, y and z."""
    sizes = integers(header.fields["sizes"])
    if integers(header.fields["dimension"]) != [len(sizes)]:
        raise MeshdepictError("is damaged: its header says other dimensions than sizes")
    kinds = header.fields.get("kinds", "").split()
    ways = _vectors(header)
    if len(sizes) == 4 and sizes[0] >= 1:
        # Values in a voxel are the first axis, which has no direction.
        parts = kinds[:1] and kinds[0].lower() not in _DOMAINS
        if (parts or (ways and ways[0] is None)) and sizes[0] > 1:
            raise several_values(sizes[0])
    return three_counts(sizes)


def _kind(header: _Header) -> np.dtype[Any]:
    big = header.fields.get("endian", "little").lower() == "big"
    return value_type(header.fields["type"].lower(), _KINDS, big_endian=big)


def _values(
    path: Path, header: _Header, kind: np.dtype[Any], counts: tuple[int, int, int],
    notes: list[str],
) -> NDArray[Any]:  # fmt: skip
    encoding = header.fields["encoding"].lower()
    skip, lines = (
        _number(header.fields.get(name, header.fields.get(name.replace(" ", ""), "0")))
        for name in ("byte skip", "line skip")
    )
    checked_start(skip, lines, from_end=encoding == "raw")
    files, start = _files(path, header, counts), 0
    if files is None:
        files, lines, start = [path], 0, header.length
    if encoding in _PACKED:
        return voxels_of_files(
            files, kind, counts, notes,
            packed=_PACKED[encoding], start=-1 if skip < 0 else start, lines=lines,
            skip=max(skip, 0),
        )  # fmt: skip
    if encoding not in (*_TEXT, "hex") or len(files) > 1:
        raise MeshdepictError(f"is encoded as {printable(encoding)[:30]!r}: save it as raw or gzip")
    return voxels_of_text(
        files[0], kind, counts, notes, start=start, lines=lines, skip=skip,
        hexadecimal=encoding == "hex",
    )  # fmt: skip


def _files(path: Path, header: _Header, counts: tuple[int, int, int]) -> list[Path] | None:
    """Return the data files that a header names, None where the voxels are behind it."""
    named = header.fields.get("data file")
    if named is None:
        return None
    words = named.split()
    if words[:1] == ["LIST"]:
        return data_paths(path.parent, header.files)
    return data_paths(path.parent, numbered_names(words[:4], counts[-1]) or [named])


def _place(header: _Header) -> tuple[dict[str, Any], str]:
    """Return where the voxels are, in LPS, and the unit of length."""
    fields = header.fields
    ways = [way for way in _vectors(header) or [] if way is not None]
    place: dict[str, Any] = {}
    turn = np.array(_SPACES.get(fields.get("space", "").lower(), (1.0, 1.0, 1.0)))
    if ways:
        if len(ways) != 3:
            raise MeshdepictError("is damaged: its space directions are not three")
        place["steps"] = turn[:, None] * np.array(ways).T
        if "space origin" in fields:
            place["origin"] = turn * _vector(fields["space origin"])
    elif "spacings" in fields:
        spacing = floats(fields["spacings"])[:3]
        if not any(map(math.isnan, spacing)):  # its word for unknown
            place["spacing"] = np.abs(spacing)
            mins = fields.get("axis mins", fields.get("axismins", ""))
            lows = floats(mins)[:3] if mins else []
            if lows and all(map(math.isfinite, lows)):
                place["origin"] = np.array(lows)
    text = fields.get("space units", "") if ways else fields.get("units", "")
    units = [length_unit(word) for word in _quoted(text)][:3] or [""]
    if len(set(units)) > 1 and all(units) and len(units) == 3:  # axes in several units
        scale = np.array([MILLIMETRES[unit] / MILLIMETRES[units[0]] for unit in units])
        for name in ("steps", "spacing", "origin"):
            if name in place:
                shape = (3, 1) if name == "steps" else (3,)
                place[name] = place[name] * scale.reshape(shape)
    return place, units[0] if all(units) else ""


def _quoted(text: str) -> list[str]:
    """Return words in quotation marks, which some programs forget."""
    return re.findall(r'"([^"]*)"', text) if '"' in text else text.split()


def _vectors(header: _Header) -> list[NDArray[np.float64] | None]:
    """Return the space directions, None for an axis without."""
    text = header.fields.get("space directions", "")
    parts = re.findall(r"\([^()]*\)|none", text.lower())
    return [None if part == "none" else _vector(part) for part in parts]


def _vector(text: str) -> NDArray[np.float64]:
    numbers = floats(text.strip().strip("()").replace(",", " "))
    if len(numbers) != 3:
        raise MeshdepictError(f"is damaged: {printable(text)[:60]!r} is no place in space")
    return np.array(numbers)


def _number(text: str) -> int:
    """Return a whole number."""
    return (integers(text) or [0])[0]
