"""Blocks that VTK's compressors packed, unpacked to no more than they should hold."""

from __future__ import annotations

import lzma
import zlib
from typing import Any

__all__ = ["COMPRESSORS", "unpacked"]


def unpacked(compressor: str, data: Any, wanted: int) -> bytes:
    """Return a block's contents, of another length than wanted where it is damaged.

    Parameters
    ----------
    compressor : str
        One of `COMPRESSORS`.
    data : bytes-like
    wanted : int
        Bytes that it holds.
    """
    try:
        return COMPRESSORS[compressor](bytes(data), wanted)
    except (zlib.error, lzma.LZMAError, EOFError):
        return b""


def _zlib(data: bytes, wanted: int) -> bytes:
    unpacking = zlib.decompressobj()
    found = unpacking.decompress(data, wanted + 1)  # one more: then its sum is checked
    return found if unpacking.eof else b""


def _lzma(data: bytes, wanted: int) -> bytes:
    return lzma.LZMADecompressor().decompress(data, wanted + 1)


def _lz4(data: bytes, wanted: int) -> bytes:
    """Return an LZ4 block's contents: literals, and copies of what came before."""
    found, at = bytearray(), 0

    def more(count: int) -> int:
        nonlocal at
        while count >= 15 and at < len(data):
            count += data[at]
            at += 1
            if data[at - 1] < 255:
                break
        return count

    while at < len(data):
        token = data[at]
        at += 1
        literals = more(token >> 4)
        found += data[at : at + literals]
        at += literals
        if at >= len(data):
            break
        back = int.from_bytes(data[at : at + 2], "little")
        at += 2
        length = more(token & 15) + 4
        if not 0 < back <= len(found) or len(found) + length > wanted:
            return b""
        first = len(found) - back
        piece = found[first : first + length]
        found += (piece * (length // len(piece) + 1))[:length]
    return bytes(found)


COMPRESSORS = {
    "vtkZLibDataCompressor": _zlib,
    "vtkLZMADataCompressor": _lzma,
    "vtkLZ4DataCompressor": _lz4,
}
"""How to unpack what each of VTK's compressors packed."""
