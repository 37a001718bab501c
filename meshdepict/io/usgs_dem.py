"""Digital elevation models of the U.S. Geological Survey: ASCII in records of 1,024 bytes.

Record A says what and where; a record B for every profile, from south to north, holds its heights
as integers of six letters each, profiles from west to east. In a map's projection they begin at
different northings: the wedges between them and the rectangle round them have no heights.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.heights.cells import checked_transform
from meshdepict.io.height_source import (
    HeightSource,
    heights_of,
    note_units,
    whole_array,
)
from meshdepict.io.usgs_crs import usgs_crs

__all__ = ["is_usgs_dem", "open_usgs_dem"]

_RECORD = 1024
_FIRST, _NEXT = 146, 170  # heights in a profile's first record and in the following ones
_HEAD = 144  # bytes of a profile's first record before them
_WIDTH = 6
_VOID = (-32767, -32766)
_UNITS = {1: "ft", 2: "m"}
_DEGREES = {0: 180 / math.pi, 3: 1 / 3600}  # of a radian, of an arc second
_SURVEY_FOOT = 1200 / 3937


@dataclass
class _Profile:
    x: float
    y: float
    datum: float
    heights: NDArray[np.int64]


def is_usgs_dem(start: bytes) -> bool:
    """Whether a file begins as record A does: text, and small codes at their places."""
    head = start[:_RECORD].decode("latin-1")
    codes = [head[at : at + _WIDTH].strip() for at in (144, 150, 156, 528, 534, 540)]
    return len(head) >= 864 and bool(
        re.fullmatch(r"[1-4]", codes[0] or "1")
        and all(re.fullmatch(r"\d{1,2}", code) for code in codes[1:])
        and codes[5] == "4"
    )


def open_usgs_dem(data: bytes, unit: str) -> HeightSource:
    """Read a model.

    Parameters
    ----------
    data : bytes
        The file's.
    unit : str
        Of its heights, "" to believe the file.

    Raises
    ------
    MeshdepictError
        For a file that is cut off, irregular, or says what is no number: a clause whose subject is
        the file.
    """
    size = len(data)
    data = _records(data)
    head = data[:_RECORD]
    if _integer(head, 150) != 1:
        raise MeshdepictError("has points in no regular pattern: a height field has rows")
    ground, up = _integer(head, 528), _integer(head, 534)
    dx, dy, dz = (_real(head, at, 12) for at in (816, 828, 840))
    turned = _real(head, 786, 24, missing=0.0)
    if not (0 < dx < math.inf and 0 < dy < math.inf and 0 < dz < math.inf):
        raise MeshdepictError(f"says a resolution of {dx:g} x {dy:g} x {dz:g}, which is none")
    if turned:
        raise MeshdepictError("has profiles that are turned against its axes: rotate it first")
    if up not in _UNITS or ground not in (0, 1, 2, 3):
        raise MeshdepictError("says units that its format doesn't know")
    profiles = _profiles(data, _integer(head, 858), size)
    z, valid, west, north = _grid(profiles, dx, dy, dz, size)
    rows, cols = z.shape
    system = _integer(head, 156)
    degrees = system == 0
    if degrees != (ground in _DEGREES):
        raise MeshdepictError("says a system of coordinates and a unit that don't go together")
    by = _DEGREES.get(ground, 1.0)
    numbers = (dx * by, 0.0, west * by, 0.0, -dy * by, north * by)
    source = HeightSource(rows, cols, checked_transform(numbers), whole_array(z, valid))
    source.degrees, source.unit = degrees, _SURVEY_FOOT if ground == 1 else 1.0
    source.crs = usgs_crs(system, _integer(head, 162, missing=0), _datum(head))
    source.attributes |= {"name": head[:40].decode("latin-1").strip(), "nodata": _VOID[0]}
    scale = note_units(source, _UNITS[up], None, unit, source.notes)
    z, valid, _ = heights_of(z, valid, scale, 0)
    source.read, source.kind, source.size = whole_array(z, valid), z.dtype, size
    return source


def _records(data: bytes) -> bytes:
    """Return the records back to back; some programs put each on lines of its own, blanks cut."""
    start = data[: 4 * _RECORD]
    if b"\n" not in start and b"\r" not in start:
        return data
    lines = [line for line in data.splitlines() if line.strip(b" \0\x1a")]
    return b"".join(line.ljust(-(-len(line) // _RECORD) * _RECORD) for line in lines)


def _profiles(data: bytes, count: int, size: int) -> list[_Profile]:
    if not 1 <= count < 1 << 20:
        raise MeshdepictError(f"says {count:,} profiles, which is no count")
    check_claim(count * _RECORD, size, "profiles")
    found = []
    at = _RECORD
    for number in range(1, count + 1):
        head = data[at : at + _HEAD]
        if len(head) < _HEAD:
            raise MeshdepictError(
                f"is cut off: it holds {number - 1:,} of the {count:,} profiles that it claims"
            )
        heights = _integer(head, 12)
        if not 0 <= heights < 1 << 20:
            raise MeshdepictError(f"is damaged: its profile {number:,} has {heights:,} heights")
        records = 1 + max(0, -(-(heights - _FIRST) // _NEXT))
        parts = [data[at + _HEAD : at + _RECORD]]
        parts += [data[at + k * _RECORD : at + (k + 1) * _RECORD] for k in range(1, records)]
        usable = [parts[0][: _FIRST * _WIDTH], *(part[: _NEXT * _WIDTH] for part in parts[1:])]
        text = b"".join(usable)[: heights * _WIDTH]
        if len(text) < heights * _WIDTH:
            raise MeshdepictError(
                f"is cut off: it ends within profile {number:,} of the {count:,} that it claims"
            )
        x, y, datum = (_real(head, place, 24) for place in (24, 48, 72))
        found.append(_Profile(x, y, datum, _numbers(text, number)))
        at += records * _RECORD
    return [profile for profile in found if len(profile.heights)]


def _numbers(text: bytes, number: int) -> NDArray[np.int64]:
    """Return integers of six letters each, which may touch each other."""
    words = np.frombuffer(text, f"S{_WIDTH}")
    try:
        return np.array([int(word) if word.strip(b" \0") else _VOID[0] for word in words.tolist()])
    except ValueError:
        raise MeshdepictError(
            f"is damaged: not all heights of its profile {number:,} are numbers"
        ) from None


def _grid(
    profiles: list[_Profile], dx: float, dy: float, dz: float, size: int
) -> tuple[NDArray[Any], NDArray[np.bool_], float, float]:
    """Return the rectangle round all profiles, where it has heights, and its north-west corner."""
    if not profiles:
        raise MeshdepictError("holds no heights")
    x, y, datum = (np.array([getattr(p, name) for p in profiles]) for name in ("x", "y", "datum"))
    if not np.isfinite([x, y, datum]).all():
        raise MeshdepictError("is damaged: a profile has no place")
    counts = np.array([len(profile.heights) for profile in profiles])
    west, south = x.min(), y.min()
    columns, starts = (x - west) / dx, (y - south) / dy
    odd = np.maximum(abs(columns - np.round(columns)), abs(starts - np.round(starts)))
    if odd.max() > 0.05 or len(np.unique(np.round(columns))) < len(profiles):
        raise MeshdepictError(
            f"is irregular: its profile {int(np.argmax(odd)) + 1:,} lies between the cells of the "
            "others"
        )
    cols = float(np.round(columns.max())) + 1
    rows = float((np.round(starts) + counts).max())
    check_claim(int(9 * rows * cols), size, "heights")
    raw = np.zeros((int(rows), int(cols)))
    valid = np.zeros(raw.shape, bool)
    for profile, column, start in zip(profiles, columns, starts, strict=True):
        at = int(rows) - 1 - round(start) - np.arange(len(profile.heights))
        raw[at, round(column)] = profile.heights * dz + profile.datum
        valid[at, round(column)] = ~np.isin(profile.heights, _VOID)
    with np.errstate(over="ignore"):
        narrow = raw.astype(np.float32)
    return narrow, valid, float(west - dx / 2), float(south - dy / 2 + rows * dy)


def _datum(head: bytes) -> int:
    """Return the code of the horizontal datum; models older than it are in NAD 27."""
    text = head[890:892].strip(b" \0")
    return int(text) if re.fullmatch(rb"\d{1,2}", text) else 1


def _integer(record: bytes, at: int, *, missing: int | None = None) -> int:
    text = record[at : at + _WIDTH].strip(b" \0")
    if not text and missing is not None:
        return missing
    try:
        return int(text)
    except ValueError:
        raise MeshdepictError(
            f"is damaged: at byte {at:,} of a record there is no whole number"
        ) from None


def _real(record: bytes, at: int, width: int, *, missing: float | None = None) -> float:
    """Return a number as FORTRAN writes it: 0.3D+02."""
    text = record[at : at + width].strip(b" \0").upper().replace(b"D", b"E")
    if not text and missing is not None:
        return missing
    try:
        return float(text)
    except ValueError:
        raise MeshdepictError(
            f"is damaged: at byte {at:,} of a record there is no number"
        ) from None
