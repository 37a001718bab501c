"""The elements of a DICOM file, word for word: libraries correct what they read without a word.

Only elements that matter for a volume are kept, so that memory doesn't follow what a file claims.
What nests is followed a few levels deep.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import allowance

__all__ = ["DicomFile", "Texts", "looks_like_dicom", "parse"]

Texts = dict[str, str]
"""Elements by "gggg|eeee", numbers as texts, several parted by backslashes."""

_UNDEFINED = 0xFFFFFFFF
_ITEM, _ITEM_END, _SEQUENCE_END = 0xFFFEE000, 0xFFFEE00D, 0xFFFEE0DD
_LONG = (b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV")
_NUMBERS = {b"US": "H", b"SS": "h", b"UL": "I", b"SL": "i", b"FL": "f", b"FD": "d"}
_PIXELS = {0x7FE00008: "f4", 0x7FE00009: "f8", 0x7FE00010: ""}
_DEEPEST = 16  # sequences within sequences; enhanced CT has three

# Of the same type in every file; needed where the file doesn't say types (implicit VR).
_SHORTS = (0x00280002, 0x00280006, 0x00280010, 0x00280011, 0x00280100, 0x00280101, 0x00280102,
           0x00280103, 0x00280120, 0x00280121)  # fmt: skip
_KEPT = frozenset(_SHORTS) | {
    0x00020010,  # transfer syntax
    0x00041430, 0x00041500,  # of a DICOMDIR: type of record, file
    0x00080005, 0x00080008, 0x00080016, 0x00080018, 0x00080060, 0x0008103E,
    0x00180050, 0x00180088, 0x0020000E, 0x00200011, 0x00200032, 0x00200037,
    0x00209161, 0x00209163,  # concatenation: its id, and of how many files
    0x00280004, 0x00280008, 0x00280030, 0x00281052, 0x00281053, 0x00281054, 0x3004000C,
}  # fmt: skip
_SEQUENCES = frozenset({
    0x00041220,  # records of a DICOMDIR
    0x52009229, 0x52009230,  # functional groups: shared, per frame
    0x00209113, 0x00209116, 0x00289110, 0x00289145,  # in these: place, spacing, rescaling
})  # fmt: skip


@dataclass
class DicomFile:
    """What a file's elements say.

    Attributes
    ----------
    texts : Texts
        Of the file itself.
    shared, frames : Texts, list of Texts
        Of enhanced images: what holds for all frames, and for each.
    records : list of Texts
        Of a DICOMDIR.
    syntax : str
        Transfer syntax.
    pixels : (int, int) or None
        Where the pixels are in `data`, and their length; −1 for compressed fragments.
    kind : str
        Of the pixels where they are floats, else "".
    data : bytes-like
        The file, unpacked where it is deflated.
    """

    texts: Texts = field(default_factory=dict)
    shared: Texts = field(default_factory=dict)
    frames: list[Texts] = field(default_factory=list)
    records: list[Texts] = field(default_factory=list)
    syntax: str = ""
    pixels: tuple[int, int] | None = None
    kind: str = ""
    data: Any = b""

    @property
    def order(self) -> str:
        """Order of bytes, as `struct` and NumPy write it."""
        return ">" if self.syntax == "1.2.840.10008.1.2.2" else "<"


class _DamagedError(Exception):
    """The elements end too early, or are none."""


def looks_like_dicom(start: bytes, size: int) -> bool:
    """Whether a file is DICOM, with the preamble of 128 bytes or, of old archives, without.

    Parameters
    ----------
    start : bytes
        The first 132 bytes.
    size : int
        The file's size.
    """
    if start[128:132] == b"DICM":
        return True
    if len(start) < 16 or start[1] or start[0] not in (2, 8) or start[3] or start[2] > 0x20:
        return False  # the first element is one of the groups 0002 and 0008
    if start[4:6] in (*_LONG, *_NUMBERS, b"CS", b"UI", b"LO", b"SH", b"DA", b"TM", b"AE"):
        return True
    return struct.unpack_from("<I", start, 4)[0] <= min(size, 1 << 10)


def parse(data: Any) -> DicomFile:
    """Return the elements of a file, up to its pixels.

    Parameters
    ----------
    data : bytes-like
        The whole file, mapped into memory for instance.

    Raises
    ------
    MeshdepictError
        For a file that is cut off, damaged or no DICOM: one clause whose subject is the file.
    """
    file = DicomFile(data=data)
    at = 132 if bytes(data[128:132]) == b"DICM" else 0
    try:
        if bytes(data[at : at + 2]) == b"\2\0":
            reader = _Elements(data, "<", explicit=True)
            while at < len(data) and bytes(data[at : at + 2]) == b"\2\0":
                at = reader.element(at, len(data), file.texts, None)
        file.syntax = file.texts.get("0002|0010", "").strip(" \0")
        if file.syntax == "1.2.840.10008.1.2.1.99":
            unpacking, most = zlib.decompressobj(-15), allowance(len(data))
            file.data = unpacking.decompress(bytes(data[at:]), most)
            at = 0
            if not unpacking.eof:
                raise _DamagedError
        explicit = file.syntax != "1.2.840.10008.1.2"
        if not file.syntax:  # nobody says; a type of two capitals follows the tag, or a length
            explicit = (
                bytes(data[at + 4 : at + 6]).isalpha() and bytes(data[at + 4 : at + 6]).isupper()
            )
            file.syntax = "1.2.840.10008.1.2.1" if explicit else "1.2.840.10008.1.2"
        _Elements(file.data, file.order, explicit=explicit).top(at, file)
    except (_DamagedError, struct.error, zlib.error):
        raise MeshdepictError("is cut off, damaged or no DICOM") from None
    return file


class _Elements:
    """Elements in one order of bytes, with or without types."""

    def __init__(self, data: Any, order: str, *, explicit: bool) -> None:
        self._data, self._order, self._explicit = data, order, explicit
        self._signed = False

    def top(self, at: int, file: DicomFile) -> None:
        """Read all elements up to the pixels."""
        end = len(self._data)

        def item(tag: int, texts: Texts) -> None:
            if tag == 0x52009230:
                file.frames.append(texts)
            elif tag == 0x00041220:
                file.records.append(texts)
            elif tag == 0x52009229:
                file.shared.update(texts)

        while at < end:
            tag, _, length, start = self._head(at)
            if tag in _PIXELS:
                file.kind = _PIXELS[tag]
                file.pixels = start, -1 if length == _UNDEFINED else length
                if length != _UNDEFINED and start + length > end:
                    raise _DamagedError
                return
            at = self.element(at, end, file.texts, item)

    def element(
        self, at: int, end: int, texts: Texts, item: Callable[[int, Texts], None] | None,
        depth: int = 0,
    ) -> int:  # fmt: skip
        """Read one element into texts, or its items; return where the next begins."""
        tag, vr, length, start = self._head(at)
        if length != _UNDEFINED and start + length > end:
            raise _DamagedError
        if depth > _DEEPEST:
            raise _DamagedError
        wanted = tag in _SEQUENCES
        if length == _UNDEFINED or (wanted and vr in (b"", b"SQ", b"UN")):
            inner = self
            if vr == b"UN":  # of unknown type: written without types
                inner = _Elements(self._data, "<", explicit=False)
            stop = end if length == _UNDEFINED else start + length
            return inner._sequence(
                tag, start, stop, texts, item if wanted else None, depth,
                ends=length == _UNDEFINED, kept=wanted,
            )  # fmt: skip
        if tag in _KEPT:
            texts[f"{tag >> 16:04x}|{tag & 0xFFFF:04x}"] = self._text(tag, vr, start, length)
        return start + length

    def _sequence(
        self, tag: int, at: int, end: int, texts: Texts,
        item: Callable[[int, Texts], None] | None, depth: int, *, ends: bool, kept: bool,
    ) -> int:  # fmt: skip
        """Read a sequence's items; those of sequences within sequences are one with their owner."""
        first = True
        while at < end:
            head, _, length, start = self._head(at)
            if head == _SEQUENCE_END:
                return start
            if head != _ITEM:
                raise _DamagedError
            own: Texts = {} if item else texts
            if not (kept and (item or first)):
                own = {}  # only the first item of what has one
            at, stop = start, end if length == _UNDEFINED else start + length
            if stop > end:
                raise _DamagedError
            if kept or length == _UNDEFINED:
                while at < stop:
                    if length == _UNDEFINED and self._head(at)[0] == _ITEM_END:
                        at += 8
                        break
                    at = self.element(at, stop, own, None, depth + 1)
                else:
                    if length == _UNDEFINED:
                        raise _DamagedError
            at = max(at, stop) if length != _UNDEFINED else at
            if item:
                item(tag, own)
            first = False
        if ends:
            raise _DamagedError
        return at

    def _head(self, at: int) -> tuple[int, bytes, int, int]:
        """Return tag, type, length and where the value begins."""
        group, element = struct.unpack_from(self._order + "HH", self._data, at)
        tag = group << 16 | element
        if group == 0xFFFE or not self._explicit:
            return tag, b"", struct.unpack_from(self._order + "I", self._data, at + 4)[0], at + 8
        vr = bytes(self._data[at + 4 : at + 6])
        if not (vr.isalpha() and vr.isupper()):
            raise _DamagedError
        if vr in _LONG:
            return tag, vr, struct.unpack_from(self._order + "I", self._data, at + 8)[0], at + 12
        return tag, vr, struct.unpack_from(self._order + "H", self._data, at + 6)[0], at + 8

    def _text(self, tag: int, vr: bytes, start: int, length: int) -> str:
        value = bytes(self._data[start : start + min(length, 1 << 16)])
        letter = _NUMBERS.get(vr, "") or ("H" if not vr and tag in _SHORTS else "")
        if letter:
            count = len(value) // struct.calcsize(letter)
            numbers = struct.unpack_from(f"{self._order}{count}{letter}", value)
            return "\\".join(f"{number:.17g}" for number in numbers)
        return value.decode("utf-8", "surrogateescape")
