"""The arrays of VTK's XML, decoded from text, base64 or appended bytes, and no more than is there.

Lengths in front of data are claims; each is compared with the bytes that follow it.
"""

from __future__ import annotations

import base64
import binascii
import re
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.vtk_packed import unpacked

__all__ = ["TYPES", "Coding", "decoded"]

TYPES = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4",
    "Int64": "i8", "UInt64": "u8", "Float32": "f4", "Float64": "f8", "String": "u1", "Bit": "u1",
}  # fmt: skip
"""NumPy's types by VTK's."""


@dataclass
class Coding:
    """How a file's arrays are written.

    Attributes
    ----------
    order : "<" or ">"
        Of bytes.
    header : "I" or "Q"
        Type of the numbers in front of data.
    compressor : str
        One of `vtk_packed.COMPRESSORS`, "" for none.
    size : int
        Of the file, in bytes.
    appended : bytes-like
        Data behind the tree.
    raw : bool
        Whether these are bytes; else base64.
    """

    order: str
    header: str
    compressor: str
    size: int
    appended: Any = b""
    raw: bool = False


def decoded(
    coding: Coding,
    attributes: Mapping[str, str],
    name: str,
    text: str,
    count: int | None,
    claim: Callable[[int], None],
) -> NDArray[Any]:
    """Return an array's numbers in the machine's order of bytes, bits as 0 and 1.

    Parameters
    ----------
    coding : Coding
    attributes : mapping
        Of its element: type, format and offset.
    name : str
        For sentences.
    text : str
        What its element holds.
    count : int, optional
        How many numbers are expected, of bits, which are padded.
    claim : function
        Is told bytes that will be needed, before they are allocated; it may raise.

    Raises
    ------
    MeshdepictError
        For an unknown type, format or compressor, and for damaged data.
    """
    word = attributes.get("type", "")
    if word not in TYPES:
        raise MeshdepictError(f"has an array of the unknown type {word[:40]!r}: {name!r}")
    bits = word == "Bit"
    kind = np.dtype(TYPES[word]).newbyteorder(coding.order)  # type: ignore[arg-type]
    source = _source(coding, attributes, name, text)
    if source is None:
        claim(len(text) * kind.itemsize // 2)  # each number takes a letter and a blank
        return _numbers_of(text, kind, name)
    try:
        data = _blocks(source, coding, claim) if source.room else b""
    except (_EarlyEndError, struct.error):
        raise MeshdepictError(
            f"is cut off or wrong: the data of its array {name!r} end too early"
        ) from None
    except _BlocksError:
        raise MeshdepictError(
            f"is cut off or wrong: its array {name!r} claims more blocks than it holds"
        ) from None
    except _DamagedError:
        raise MeshdepictError(f"is damaged: unpacking its array {name!r} failed") from None
    usable = len(data) // kind.itemsize * kind.itemsize
    values = np.frombuffer(data[:usable], kind)
    if bits:
        return np.unpackbits(values)[: 8 * len(values) if count is None else count]
    return values.astype(kind.newbyteorder("="), copy=False)


class _EarlyEndError(Exception):
    """Data end before their claimed length."""


class _BlocksError(Exception):
    """More blocks are claimed than there can be."""


class _DamagedError(Exception):
    """A block doesn't unpack to its length."""


def _source(
    coding: Coding, attributes: Mapping[str, str], name: str, text: str
) -> _Plain | _Base64 | None:
    """Return where an array's bytes come from, None where it is written as text."""
    how = attributes.get("format", "ascii")
    offset = attributes.get("offset")
    if how == "appended" or offset is not None:  # then VTK reads appended data, whatever the format
        if not re.fullmatch(r"\d{1,18}", offset or "") or int(offset or 0) >= len(coding.appended):
            raise MeshdepictError(f"is cut off or wrong: its array {name!r} lies beyond its end")
        at = int(offset or 0)
        return _Plain(coding.appended, at) if coding.raw else _Base64(coding.appended[at:])
    if how == "binary":
        return _Base64("".join(text.split()).encode("ascii", "replace"))
    if how != "ascii":
        raise MeshdepictError(f"has its array {name!r} in the unknown format {how[:20]!r}")
    return None


def _numbers_of(text: str, kind: np.dtype[Any], name: str) -> NDArray[Any]:
    words = text.split()
    number: Any = int if kind.kind in "iu" else float
    try:
        return np.fromiter(map(number, words), kind.newbyteorder("="), len(words))
    except (ValueError, OverflowError):
        raise MeshdepictError(
            f"is cut off or wrong: it has something else than numbers of its type in its array "
            f"{name!r}"
        ) from None


def _blocks(source: _Plain | _Base64, coding: Coding, claim: Callable[[int], None]) -> bytes:
    """Return an array's bytes: in one piece, or in blocks that are each compressed."""
    width = struct.calcsize(coding.header)
    if not coding.compressor:
        (length,) = struct.unpack(coding.order + coding.header, source.take(width))
        return bytes(source.take(length))
    (blocks,) = struct.unpack(coding.order + coding.header, source.take(width))
    if not blocks:
        return b""
    if blocks * width > coding.size:
        raise _BlocksError
    each, last = struct.unpack(f"{coding.order}2{coding.header}", source.take(2 * width))
    if not each:
        raise _BlocksError
    claim(blocks * each + last)
    lengths = struct.unpack(f"{coding.order}{blocks}{coding.header}", source.take(blocks * width))
    if sum(lengths) > source.room:
        raise _EarlyEndError
    source.next_stream()
    found = bytearray()
    for at, length in enumerate(lengths):
        wanted = (last or each) if at == blocks - 1 else each
        part = unpacked(coding.compressor, source.take(length), wanted)
        if len(part) != wanted:
            raise _DamagedError
        found += part
    return bytes(found)


class _Plain:
    """Bytes that are taken one after the other."""

    def __init__(self, data: Any, at: int) -> None:
        self._data, self._at = data, at

    @property
    def room(self) -> int:
        """How many bytes are left."""
        return len(self._data) - self._at

    def take(self, count: int) -> Any:
        """Return the next bytes."""
        if count > self.room:
            raise _EarlyEndError
        self._at += count
        return self._data[self._at - count : self._at]

    def next_stream(self) -> None:
        """Go on behind the header."""


class _Base64:
    """The same in base64, where header and blocks are padded each by itself, or coded as one."""

    def __init__(self, text: Any) -> None:
        self._text, self._at, self._bytes = text, 0, b""

    @property
    def room(self) -> int:
        """How many bytes are left, at most."""
        return len(self._bytes) + (len(self._text) - self._at) * 3 // 4

    def take(self, count: int) -> bytes:
        """Return the next bytes."""
        if count > self.room:
            raise _EarlyEndError
        missing = count - len(self._bytes)
        if missing > 0:
            letters = -(-missing // 3) * 4
            try:
                more = base64.b64decode(self._text[self._at : self._at + letters], validate=True)
            except binascii.Error:
                raise _EarlyEndError from None
            self._at += letters
            self._bytes += more
        found, self._bytes = self._bytes[:count], self._bytes[count:]
        if len(found) < count:
            raise _EarlyEndError
        return found

    def next_stream(self) -> None:
        """Go on behind the header and its padding."""
        self._bytes = b""
