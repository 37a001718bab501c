"""NIfTI-1 and NIfTI-2, word for word: ITK turns NaN into 0, and units and shears into others."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.tilt import tilt_of
from meshdepict.io.volume_bytes import GZIP, Inflated, voxels
from meshdepict.io.volume_contents import VolumeContents, rescaled, several_values, three_counts

__all__ = ["read_nifti"]

_TYPES = {
    2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 256: "i1", 512: "u2", 768: "u4", 1024: "i8",
    1280: "u8",
}  # fmt: skip
_ODD = {1: "bits", 32: "complex numbers", 1536: "128-bit floats", 1792: "complex numbers",
        2048: "complex numbers"}  # fmt: skip
_SEVERAL = {128: 3, 2304: 4}  # RGB, RGBA
_UNITS = {1: "m", 2: "mm", 3: "µm"}
_LPS = np.array((-1.0, -1.0, 1.0))  # NIfTI's x is to the right, its y to the front
_SIZES = {348: "1", 540: "2"}


@dataclass(frozen=True)
class _Header:
    counts: tuple[int, ...]
    code: int
    offset: float
    slope: float
    intercept: float
    widths: tuple[float, ...]
    forms: tuple[int, int]  # qform, sform
    quaternion: tuple[float, ...]  # b, c, d, x, y, z
    rows: tuple[float, ...]
    units: int
    order: str


def read_nifti(path: Path) -> VolumeContents:
    """Return a volume in the patient's frame (LPS), in the file's own unit of length.

    The matrix of the header (sform) decides where there is one, else its quaternion (qform).

    Raises
    ------
    MeshdepictError
        For damaged files, other dimensions than three, several values in a voxel, numbers that a
        volume can't hold, and a header without voxels: one clause whose subject is the file.
    """
    notes: list[str] = []
    size = path.stat().st_size
    with path.open("rb") as file:
        stream: Any = file
        if file.peek(2)[:2] == GZIP:
            stream = Inflated(file)
        try:
            start = stream.read(544)
        except Exception as error:
            raise MeshdepictError(f"is cut off or damaged: {error}") from error
        header = _header(start)
        if header.code in _SEVERAL:
            raise several_values(_SEVERAL[header.code])
        if header.code not in _TYPES:
            what = _ODD.get(header.code, f"numbers of the unknown type {header.code}")
            raise MeshdepictError(f"holds {what}: save it as integers or 32-bit floats")
        if len(header.counts) == 5 and header.counts[3] == 1 < header.counts[4]:
            raise several_values(header.counts[4])
        counts = three_counts(header.counts)
        kind = np.dtype(_TYPES[header.code]).newbyteorder(header.order)  # type: ignore[arg-type]
        skip = int(header.offset) - len(start)
        if skip > 0 and stream is file:
            file.seek(min(int(header.offset), size))
        while skip > 0 and stream is not file:
            part = stream.read(min(skip, 1 << 20))
            if not part:
                break
            skip -= len(part)
        if skip < 0:
            stream = _Joined(start[skip:], stream)
        values = voxels(stream, size, kind, counts, notes)
    steps, origin = _matrix(header, notes)
    values = rescaled(values, header.slope, header.intercept)
    return VolumeContents(
        values,
        {"steps": steps, "origin": origin},
        length_unit=_UNITS.get(header.units & 7, ""),
        notes=notes,
    )


class _Joined:
    """Bytes that were read already, and what comes after them."""

    def __init__(self, start: bytes, rest: Any) -> None:
        self._start, self._rest = start, rest

    def read(self, count: int) -> bytes:
        if self._start:
            found, self._start = self._start[:count], self._start[count:]
            return found
        rest: bytes = self._rest.read(count)
        return rest


def _header(start: bytes) -> _Header:
    """Return what the first 540 bytes say."""
    version, order = "", ""
    for mark in "<>":
        if len(start) >= 348:
            found = _SIZES.get(struct.unpack_from(mark + "i", start)[0], "")
            version, order = (found, mark) if found else (version, order)
    if not version or len(start) < (348 if version == "1" else 540):
        raise MeshdepictError(
            "is cut off, damaged or not what its suffix says: it doesn't begin as NIfTI does"
        )
    magic = start[344:347] if version == "1" else start[4:7]
    if magic == b"ni" + version.encode():
        raise MeshdepictError(
            "is the header of a pair of files: convert it to a single .nii with its voxels"
        )
    if magic != b"n+" + version.encode():
        raise MeshdepictError(
            "is ANALYZE 7.5, which doesn't say how it lies in the world, or damaged: convert it to "
            "NIfTI"
        )

    def get(letters: str, at: int) -> tuple[Any, ...]:
        return struct.unpack_from(order + letters, start, at)

    if version == "1":
        dims, (code,) = get("8h", 40), get("h", 70)
        widths = get("8f", 76)
        offset, slope, intercept = get("3f", 108)
        forms, quaternion, rows = get("2h", 252), get("6f", 256), get("12f", 280)
        units = start[123]
    else:
        dims, (code,) = get("8q", 16), get("h", 12)
        widths = get("8d", 104)
        (offset,), (slope, intercept) = get("q", 168), get("2d", 176)
        forms, quaternion, rows = get("2i", 344), get("6d", 352), get("12d", 400)
        (units,) = get("i", 500)
    if not 1 <= dims[0] <= 7:
        raise MeshdepictError(
            f"is damaged: its header says {dims[0]} dimensions, and NIfTI has 1 to 7"
        )
    least = 348 if version == "1" else 540
    if not math.isfinite(offset) or not (offset == 0 or least <= offset < 1 << 40):
        raise MeshdepictError("is damaged: its header says an impossible place of its voxels")
    if slope == 0 or not math.isfinite(slope) or not math.isfinite(intercept):
        slope, intercept = 1.0, 0.0  # as the standard says: none
    return _Header(
        dims[1 : dims[0] + 1], code, offset or least + 4, slope, intercept, widths,
        (forms[0], forms[1]), quaternion, rows, units, order,
    )  # fmt: skip


def _matrix(header: _Header, notes: list[str]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the steps from voxel to voxel (columns) and the origin, to the left, back and top."""
    widths = np.abs(header.widths[1:4])
    if header.forms[1] > 0:
        matrix = np.reshape(header.rows, (3, 4))
        steps, origin = matrix[:, :3], matrix[:, 3]
        if tilt_of(steps) is None and header.forms[0] > 0 and np.isfinite(steps).all():
            notes.append("its matrix (sform) is sheared, its quaternion (qform) is taken")
            steps, origin = _quaternion(header, widths)
    elif header.forms[0] > 0:
        steps, origin = _quaternion(header, widths)
    else:
        notes.append("it doesn't say how it lies in the world")
        steps, origin = np.diag(widths), np.zeros(3)
    return _LPS[:, None] * steps, _LPS * origin


def _quaternion(header: _Header, widths: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    b, c, d, *origin = header.quaternion
    a = math.sqrt(max(0.0, 1 - (b * b + c * c + d * d)))
    turn = np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )
    mirror = -1.0 if header.widths[0] < 0 else 1.0  # "qfac"
    return turn * widths * (1, 1, mirror), np.array(origin)
