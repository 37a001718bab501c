"""Compressed pixels of DICOM: their fragments, run lengths unpacked, and what JPEG claims of them.

GDCM believes what it is given, and a wrong claim ends the process: what is checked here never
reaches it.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.threads import kernel

__all__ = ["RLE", "check_jpeg", "fragments_of", "unpacked_runs"]

RLE = "1.2.840.10008.1.2.5"
"""The transfer syntax of run lengths."""

_HEAD = 64  # bytes: the number of segments, and where 15 of them begin


def fragments_of(data: Any, at: int, name: str) -> tuple[list[bytes], int]:
    """Return the fragments, the first of them a table of offsets, and where they end.

    Raises
    ------
    MeshdepictError
        Where the mark at their end is missing: one clause whose subject is the file's folder.
    """
    found: list[bytes] = []
    while at + 8 <= len(data):
        group, element, length = struct.unpack_from("<HHI", data, at)
        at += 8
        if (group, element) == (0xFFFE, 0xE0DD):
            return found, at
        if (group, element) != (0xFFFE, 0xE000) or at + length > len(data):
            break
        found.append(bytes(data[at : at + length]))
        at += length
    raise MeshdepictError(f"holds a damaged file, {name}: its compressed pixels don't end")


def unpacked_runs(
    fragments: Sequence[bytes], shape: tuple[int, ...], itemsize: int, name: str
) -> NDArray[Any]:
    """Return pixels (frames, rows, columns) of one fragment each, in runs of equal bytes.

    Raises
    ------
    MeshdepictError
        For other numbers of fragments and segments, and for runs that fill no frame.
    """
    wrong = MeshdepictError(
        f"holds a damaged file, {name}: its run lengths don't unpack to the size that the header "
        "claims"
    )
    if len(fragments) != shape[0]:
        raise wrong
    planes = np.empty((shape[0], itemsize, shape[1] * shape[2]), np.uint8)
    for fragment, plane in zip(fragments, planes, strict=True):
        if len(fragment) < _HEAD:
            raise wrong
        count, *starts = struct.unpack_from("<16I", fragment)
        ends = [*starts[1:count], len(fragment)]
        if count != itemsize or starts[0] < _HEAD:
            raise wrong
        data = np.frombuffer(fragment, np.uint8)
        for start, end, out in zip(starts, ends, plane, strict=False):
            if not start <= end <= len(data) or _run(data[start:end], out) != len(out):
                raise wrong
    # The highest byte comes first.
    whole = np.ascontiguousarray(np.moveaxis(planes, 1, 2))
    return whole.view(f">u{itemsize}").astype(f"u{itemsize}").reshape(shape)


@kernel()
def _run(data, out):  # type: ignore[no-untyped-def]
    """Fill bytes from run lengths (PackBits), and return how many were filled."""
    at = filled = 0
    while at < len(data) and filled < len(out):
        length = int(data[at])
        at += 1
        if length < 128:  # so many bytes, and one, as they are
            length += 1
            if at + length > len(data) or filled + length > len(out):
                return filled
            for k in range(length):
                out[filled + k] = data[at + k]
            at += length
            filled += length
        elif length > 128:  # one byte so often
            length = 257 - length
            if at >= len(data) or filled + length > len(out):
                return filled
            for k in range(length):
                out[filled + k] = data[at]
            at += 1
            filled += length
    return filled


def check_jpeg(fragments: Sequence[bytes], rows: int, columns: int, bits: int, name: str) -> None:
    """Refuse JPEG, JPEG-LS and JPEG 2000 that say another size than the file's header.

    Raises
    ------
    MeshdepictError
        For a size, a depth or a number of colours that is another.
    """
    for fragment in fragments:
        said = _jpeg_size(fragment) or _jpeg2000_size(fragment)
        if said and said != (rows, columns, 1, said[3]):
            raise MeshdepictError(
                f"holds a damaged file, {name}: its JPEG part says another size than the header"
            )
        if said and said[3] > bits:
            raise MeshdepictError(
                f"holds a damaged file, {name}: its JPEG part says more bits than the header"
            )


def _jpeg2000_size(data: bytes) -> tuple[int, int, int, int] | None:
    """Return the same of JPEG 2000, −1 columns where its image doesn't begin where tiles do."""
    if data[:4] != b"\xff\x4f\xff\x51" or len(data) < 45:
        return None
    x, y, x0, y0, width, height, tile_x, tile_y, parts = struct.unpack_from(">8IH", data, 8)
    depth, step_x, step_y = data[42:45]
    tiled = x0 == y0 == tile_x == tile_y == 0 and width and height and step_x == step_y == 1
    return y, x if tiled else -1, parts, (depth & 0x7F) + 1


def _jpeg_size(data: bytes) -> tuple[int, int, int, int] | None:
    """Return rows, columns, components and bits that a JPEG says; None for what is none."""
    if data[:2] != b"\xff\xd8":
        return None
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        frame = 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC)
        if (frame or marker == 0xF7) and at + 10 <= len(data):
            bits, rows, columns, parts = struct.unpack_from(">BHHB", data, at + 4)
            return rows, columns, parts, bits
        at += 2 + length
    return None
