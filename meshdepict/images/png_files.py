"""PNG of large pictures: packed in parallel, strip by strip, grey where all of it is."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each

__all__ = ["write_png"]

Bytes = NDArray[np.uint8]

_STRIP = 1 << 22  # bytes that are packed at a time
_LEVEL = 3  # of deflate's 9: further ones take twice as long for a few percent
_FILTER = 1  # Sub: a texel's difference to the one on its left
_AT_ONCE = 16  # strips that wait to be written


def write_png(
    file: BinaryIO, image: Bytes, texts: Mapping[str, str] | None = None, *, srgb: bool = True
) -> None:
    """Write a picture as PNG.

    Parameters
    ----------
    file : binary file
    image : (h, w, 3) array of uint8
        Stored as grey where its channels are equal everywhere.
    texts : mapping, optional
        Key words and what is said under them.
    srgb : bool
        Whether they are colours, and not numbers.
    """
    height, width = image.shape[:2]
    rows = max(1, _STRIP // (3 * width))
    strips = [(a, min(a + rows, height)) for a in range(0, height, rows)]
    gray = _is_gray(image, strips)
    file.write(b"\x89PNG\r\n\x1a\n")
    header = struct.pack(">IIBBBBB", width, height, 8, 0 if gray else 2, 0, 0, 0)
    _chunk(file, b"IHDR", header)
    if srgb:
        _chunk(file, b"sRGB", b"\0")
    for key, text in (texts or {}).items():
        said = (
            key.encode("latin-1", "replace")[:79] + b"\0\0\0\0\0" + text.encode("utf-8", "replace")
        )
        _chunk(file, b"iTXt", said)
    sum_so_far = zlib.adler32(b"")
    for first in range(0, len(strips), _AT_ONCE):
        batch = strips[first : first + _AT_ONCE]
        filtered: list[bytes] = [b""] * len(batch)
        packed: list[bytes] = [b""] * len(batch)

        def pack(
            number: int, a: int, b: int, filtered: list[bytes] = filtered,
            packed: list[bytes] = packed,
        ) -> None:  # fmt: skip
            filtered[number] = _filtered(image[a:b, :, :1] if gray else image[a:b])
            # Each strip by itself, ended at a whole byte: one after the other they are one stream.
            deflate = zlib.compressobj(_LEVEL, zlib.DEFLATED, -15)
            packed[number] = deflate.compress(filtered[number]) + deflate.flush(zlib.Z_FULL_FLUSH)

        each(pack, [(i, *strip) for i, strip in enumerate(batch)])
        if first == 0:
            packed[0] = b"\x78\x5e" + packed[0]
        for raw, data in zip(filtered, packed, strict=True):
            sum_so_far = zlib.adler32(raw, sum_so_far)
            _chunk(file, b"IDAT", data)
    _chunk(file, b"IDAT", b"\x03\x00" + struct.pack(">I", sum_so_far))  # an empty last block
    _chunk(file, b"IEND", b"")


def _is_gray(image: Bytes, strips: list[tuple[int, int]]) -> bool:
    colored = [False] * len(strips)

    def look(number: int, a: int, b: int) -> None:
        part = image[a:b]
        colored[number] = bool(
            (part[..., 0] != part[..., 1]).any() or (part[..., 0] != part[..., 2]).any()
        )

    if image.shape[2] == 1:
        return True
    look(0, *strips[0])
    if not colored[0]:
        each(look, [(i, *strip) for i, strip in enumerate(strips)])
    return not any(colored)


def _filtered(part: Bytes) -> bytes:
    """Return rows of differences, each with its filter's number before it."""
    rows, width, channels = part.shape
    out = np.empty((rows, 1 + width * channels), np.uint8)
    out[:, 0] = _FILTER
    body = out[:, 1:].reshape(rows, width, channels)
    body[:, 0] = part[:, 0]
    np.subtract(part[:, 1:], part[:, :-1], out=body[:, 1:])
    return out.tobytes()


def _chunk(file: BinaryIO, kind: bytes, data: bytes) -> None:
    file.write(struct.pack(">I", len(data)) + kind + data)
    file.write(struct.pack(">I", zlib.crc32(data, zlib.crc32(kind))))
