"""PNG with colours of 16 bits, which Pillow cuts to 8 without a word."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.threads import kernel

__all__ = ["deep_png", "deep_size"]

Bytes = NDArray[np.uint8]

_CHANNELS = {2: 3, 4: 2, 6: 4}  # by the kind of colour: RGB, grey with alpha, RGBA
# Adam7: the first column and row of each pass, and the steps to the next.
_PASSES = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
           (0, 1, 1, 2))  # fmt: skip


def deep_size(data: bytes) -> tuple[int, int] | None:
    """Return width and height of a PNG with colours of 16 bits; None for any other picture."""
    begins = data.startswith(b"\x89PNG\r\n\x1a\n") and data[12:16] == b"IHDR" and len(data) > 28
    if not begins or data[24] != 16 or data[25] not in _CHANNELS:
        return None
    width, height = struct.unpack(">II", data[16:24])
    return width, height


def deep_png(data: bytes) -> NDArray[np.uint16]:
    """Return the pixels (h, w, 2, 3 or 4) of a PNG that `deep_size` knows.

    Raises
    ------
    MeshdepictError
        For one that is cut off or damaged: a clause whose subject is the picture.
    """
    size = deep_size(data)
    assert size is not None
    width, height = size
    channels = _CHANNELS[data[25]]
    wide = 2 * channels  # bytes of a pixel
    whole = (0, 0, 1, 1)
    passes = _PASSES if data[28] else (whole,)
    parts = [
        (x, y, dx, dy, -(-(width - x) // dx), -(-(height - y) // dy)) for x, y, dx, dy in passes
    ]
    due = sum(rows * (1 + wide * columns) for *_, columns, rows in parts if columns > 0)
    try:
        packed = b"".join(_pieces(data))
        raw = np.frombuffer(zlib.decompressobj().decompress(packed, max(due, 1)), np.uint8)
    except zlib.error as error:
        raise MeshdepictError(f"can't be read as a picture ({error})") from None
    if len(raw) < due:
        raise MeshdepictError("can't be read as a picture (it is cut off)")
    pixels = np.zeros((height, width, channels), np.uint16)
    at = 0
    for x, y, dx, dy, columns, rows in parts:
        if columns < 1 or rows < 1:
            continue
        length = rows * (1 + wide * columns)
        lines = raw[at : at + length].reshape(rows, -1)
        at += length
        if lines[:, 0].max() > 4:
            raise MeshdepictError("can't be read as a picture (it has rows of an unknown kind)")
        plain = np.zeros((rows, wide * columns), np.uint8)
        _unfilter(np.ascontiguousarray(lines), plain, wide)
        pixels[y::dy, x::dx] = plain.view(">u2").reshape(rows, columns, channels)
    return pixels


def _pieces(data: bytes) -> list[bytes]:
    """Return what a PNG's IDAT chunks hold, as far as they are there."""
    found, at = [], 8
    while at + 8 <= len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if data[at + 4 : at + 8] == b"IDAT":
            found.append(data[at + 8 : at + 8 + length])
        at += 12 + length
    return found


@kernel()
def _unfilter(lines: Bytes, plain: Bytes, wide: int) -> None:
    """Undo what makes rows easy to pack: what of their neighbours each byte has lost."""
    rows, length = plain.shape
    for row in range(rows):
        kind = lines[row, 0]
        for at in range(length):
            left = int(plain[row, at - wide]) if at >= wide else 0
            above = int(plain[row - 1, at]) if row > 0 else 0
            corner = int(plain[row - 1, at - wide]) if row > 0 and at >= wide else 0
            guess = 0
            if kind == 1:
                guess = left
            elif kind == 2:
                guess = above
            elif kind == 3:
                guess = (left + above) // 2
            elif kind == 4:  # Paeth: the neighbour nearest to left + above − corner
                to_left, to_above = abs(above - corner), abs(left - corner)
                to_corner = abs(left + above - 2 * corner)
                if to_left <= to_above and to_left <= to_corner:
                    guess = left
                elif to_above <= to_corner:
                    guess = above
                else:
                    guess = corner
            plain[row, at] = (int(lines[row, 1 + at]) + guess) & 255
