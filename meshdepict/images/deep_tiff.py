"""TIFF with colours of 16 bits, which Pillow cuts to 8 without a word."""

from __future__ import annotations

import io
import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim

__all__ = ["deep_tiff"]

_NAMES = {
    256: "width", 257: "height", 258: "bits", 259: "compression", 273: "offsets", 277: "samples",
    278: "rows", 279: "lengths", 284: "planes", 317: "predictor", 322: "tile_width",
    323: "tile_height", 324: "offsets", 325: "lengths", 339: "format",
}  # fmt: skip
_LETTERS = {1: "B", 3: "H", 4: "I", 16: "Q"}
_NONE, _DEFLATE = 1, (8, 32946)
_LZW, _PACKBITS = 5, 32773
_MOST_ENTRIES = 4096


def deep_tiff(data: bytes) -> NDArray[np.uint16] | None:
    """Return the pixels (h, w, 3 or 4) of a TIFF with colours of 16 bits; None for any other.

    Raises
    ------
    MeshdepictError
        For one that is cut off or damaged, and for packing other than deflate, LZW and PackBits: a
        clause whose subject is the picture.
    """
    order = {b"II*\0": "<", b"MM\0*": ">"}.get(data[:4])
    if order is None:
        return None
    try:
        tags = _directory(data, order)
        bits, samples = tags.get("bits", [1]), tags.get("samples", [1])[0]
        if set(bits) != {16} or samples < 3 or tags.get("format", [1])[0] != 1:
            return None
        return _pixels(data, order, tags, samples)
    except (struct.error, zlib.error, LookupError, OSError, ValueError) as error:
        raise MeshdepictError(f"can't be read as a picture ({error})") from None


def _directory(data: bytes, order: str) -> dict[str, list[int]]:
    """Return the numbers of the first directory by name."""
    (start,) = struct.unpack_from(f"{order}I", data, 4)
    (count,) = struct.unpack_from(f"{order}H", data, start)
    found: dict[str, list[int]] = {}
    for at in range(start + 2, start + 2 + 12 * min(count, _MOST_ENTRIES), 12):
        tag, kind, length = struct.unpack_from(f"{order}HHI", data, at)
        if tag not in _NAMES or kind not in _LETTERS:
            continue
        packed = f"{order}{length}{_LETTERS[kind]}"
        if struct.calcsize(packed) > len(data):
            raise ValueError("its directory is damaged")
        place = at + 8
        if struct.calcsize(packed) > 4:
            (place,) = struct.unpack_from(f"{order}I", data, place)
        found[_NAMES[tag]] = list(struct.unpack_from(packed, data, place))
    return found


def _pixels(
    data: bytes, order: str, tags: dict[str, list[int]], samples: int
) -> NDArray[np.uint16]:
    width, height = tags["width"][0], tags["height"][0]
    compression, predictor = tags.get("compression", [1])[0], tags.get("predictor", [1])[0]
    if compression not in (_NONE, *_DEFLATE, _LZW, _PACKBITS):
        raise MeshdepictError(
            "is a TIFF of 16 bits a channel that is packed otherwise than with deflate, LZW or "
            "PackBits: save it so"
        )
    if tags.get("planes", [1])[0] != 1 or predictor not in (1, 2):
        raise MeshdepictError("is a TIFF whose channels are apart: save them together")
    if width < 1 or height < 1:
        raise MeshdepictError("has no pixels")
    check_claim(2 * samples * width * height, len(data), "pixels")
    across = tags.get("tile_width", [width])[0]
    down = tags.get("tile_height", [min(tags.get("rows", [height])[0], height)])[0]
    if across < 1 or down < 1:
        raise ValueError("its tiles have no size")
    check_claim(2 * samples * across * down, len(data), "pixels")
    found = np.zeros((height, width, samples), np.uint16)
    columns = -(-width // across)
    pieces = zip(tags["offsets"], tags["lengths"], strict=True)
    for number, (offset, length) in enumerate(pieces):
        row, column = number // columns * down, number % columns * across
        rows = down if "tile_height" in tags else min(down, height - row)
        if rows < 1:
            break
        size = 2 * samples * across * rows
        raw = data[offset : offset + length]
        if compression in _DEFLATE:
            raw = zlib.decompressobj().decompress(raw, size)
        elif compression != _NONE:
            raw = _unpacked(raw, compression, 2 * samples * across, rows)
        if len(raw) < size:
            raise ValueError("it is cut off")
        piece = np.frombuffer(raw[:size], f"{order}u2").reshape(rows, across, samples)
        piece = piece.astype(np.uint16)
        if predictor == 2:
            piece = np.cumsum(piece, axis=1, dtype=np.uint16)
        part: Any = found[row : row + rows, column : column + across]
        part[...] = piece[: part.shape[0], : part.shape[1]]
    return found[..., :4]


def _unpacked(packed: bytes, compression: int, across: int, rows: int) -> bytes:
    """Return a piece's bytes: packing knows of no channels, so Pillow reads them as a grey picture.

    That is how many bytes a row has, and how many rows there are.
    """
    from PIL import Image

    tags = {
        256: across, 257: rows, 258: 8, 259: compression, 262: 1, 273: 0, 277: 1, 278: rows,
        279: len(packed),
    }  # fmt: skip
    tags[273] = 8 + 2 + 12 * len(tags) + 4
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags.items())
    head = b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + b"\0" * 4
    with Image.open(io.BytesIO(head + packed)) as image:
        return image.tobytes()
