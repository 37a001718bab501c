"""VTK's XML files taken apart without VTK: which arrays they declare, and where their data lie.

No entities, no deep nesting: what a stranger's XML can do to a parser ends here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from meshdepict.errors import MeshdepictError

__all__ = ["XmlArray", "XmlFile", "parsed", "whole_numbers"]

_DEPTH = 20  # VTK's own files have six levels
_APPENDED = b"<AppendedData"
_HEADERS = {"UInt32": 4, "UInt64": 8}


@dataclass
class XmlArray:
    """A ``DataArray``, where it stands, and its text if that is where its data are."""

    role: str  # the element round it: "Points", "PointData", "Polys", …
    piece: Mapping[str, str] | None  # attributes of the piece that it belongs to
    attributes: Mapping[str, str]
    text: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Its name, "Points" for what has none."""
        return self.attributes.get("Name", self.role)

    def count(self, name: str, default: int) -> int:
        """Return an attribute that counts something; raise `MeshdepictError` for what can't."""
        return whole_numbers(self.attributes.get(name, str(default)), name, 1)[0]


@dataclass
class XmlFile:
    """A VTK file: its kind, its arrays, and how their data are written."""

    data: bytes
    kind: str = ""
    order: str = "<"  # of bytes
    header: int = 4  # bytes of each number in front of an array's data
    compressor: str = ""
    whole: Mapping[str, str] = field(default_factory=dict)  # attributes of the whole grid
    arrays: list[XmlArray] = field(default_factory=list)
    pieces: list[Mapping[str, str]] = field(default_factory=list)
    start: int = -1  # where appended data begin; −1: there are none
    raw: bool = False  # whether those are bytes; else base64


def parsed(data: bytes) -> XmlFile:
    """Parse a VTK file without decoding its data.

    Raises
    ------
    MeshdepictError
        For what is no XML, for entities and deep nesting: one clause whose subject is the file.
    """
    file = XmlFile(data)
    at = data.find(_APPENDED)
    end = len(data) if at < 0 else data.find(b">", at) + 1
    if end == 0:
        raise MeshdepictError("is cut off in its XML: <AppendedData is not complete")
    parser = _Parser(file)
    parser.read(data[:end], final=at < 0)
    if at >= 0:
        if parser.stack[-1:] != ["AppendedData"]:
            raise MeshdepictError("is wrong as XML: it has <AppendedData where no element can be")
        start = data.find(b"_", end)
        if start < 0:
            raise MeshdepictError("is cut off: its appended data don't begin with '_'")
        file.start = start + 1
    return file


def whole_numbers(text: str, name: str, count: int) -> list[int]:
    """Return so many whole numbers that an attribute holds.

    Raises
    ------
    MeshdepictError
        For anything else: VTK would guess.
    """
    words = text.split()
    if len(words) != count or not all(re.fullmatch(r"-?\d{1,18}", word) for word in words):
        numbers = "a whole number" if count == 1 else f"{count} whole numbers"
        raise MeshdepictError(f"is wrong as VTK's XML: {name}={text[:40]!r} is not {numbers}")
    return [int(word) for word in words]


class _Parser:
    """Expat, told to keep what `XmlFile` holds and to refuse what may hurt."""

    def __init__(self, file: XmlFile) -> None:
        self.file = file
        self.stack: list[str] = []
        self._piece: Mapping[str, str] | None = None
        self._array: XmlArray | None = None
        expat_parser = expat.ParserCreate()
        expat_parser.buffer_text = True
        expat_parser.StartDoctypeDeclHandler = self._refuse
        expat_parser.EntityDeclHandler = self._refuse
        expat_parser.StartElementHandler = self._start
        expat_parser.EndElementHandler = self._end
        expat_parser.CharacterDataHandler = self._characters
        self._expat = expat_parser

    def read(self, data: bytes, *, final: bool) -> None:
        try:
            self._expat.Parse(data, final)
        except expat.ExpatError as error:
            raise MeshdepictError(
                f"is wrong as VTP: Error parsing its XML in line {error.lineno} "
                f"({expat.ErrorString(error.code)})"
                if self.file.kind == "PolyData"
                else f"is wrong as VTK's XML in line {error.lineno} "
                f"({expat.ErrorString(error.code)})"
            ) from error

    def _refuse(self, *_: object) -> None:
        raise MeshdepictError("declares a document type or entities, which VTK's XML doesn't need")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        file = self.file
        if len(self.stack) >= _DEPTH:
            raise MeshdepictError(f"is nested more than {_DEPTH} levels deep, unlike VTK's XML")
        if not self.stack:
            if name != "VTKFile":
                raise MeshdepictError(f"is XML, but not VTK's: it begins with <{name[:40]}>")
            file.kind = attributes.get("type", "")
            file.order = ">" if attributes.get("byte_order") == "BigEndian" else "<"
            file.header = _HEADERS.get(attributes.get("header_type", "UInt32"), 4)
            file.compressor = attributes.get("compressor", "")
        elif name == file.kind:
            file.whole = attributes
        elif name == "Piece":
            self._piece = attributes
            file.pieces.append(attributes)
        elif name in ("DataArray", "Array"):
            self._array = XmlArray(self.stack[-1], self._piece, attributes)
            file.arrays.append(self._array)
        elif name == "AppendedData":
            file.raw = attributes.get("encoding", "base64") == "raw"
        self.stack.append(name)

    def _end(self, name: str) -> None:
        self.stack.pop()
        if name == "Piece":
            self._piece = None
        elif name in ("DataArray", "Array"):
            self._array = None

    def _characters(self, text: str) -> None:
        if self._array is not None and self.stack[-1] in ("DataArray", "Array"):
            self._array.text.append(text)
