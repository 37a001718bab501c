"""VTK's XML files taken apart without VTK, which believes every count, extent and offset.

No entities, no deep nesting: what a stranger's XML can do to a parser ends here. What arrays claim
is compared with what they hold where they are decoded (`vtk_arrays`), before memory is allocated.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.io.vtk_arrays import Coding, decoded
from meshdepict.io.vtk_packed import COMPRESSORS

__all__ = ["WRONG", "Element", "VtkXml", "natural", "parse_vtk", "whole_numbers"]

WRONG = "is cut off or wrong as VTK's XML"

_DEEPEST = 20  # VTK's own files have six levels
_MOST = 1 << 18  # elements; a file has a few for each array
_MOST_PARTS = 1000  # components of a value
_APPENDED = b"<AppendedData"
_HEADERS = {"UInt32": "I", "UInt64": "Q"}
_ARRAYS = ("DataArray", "Array")


@dataclass
class Element:
    """An element with its attributes and children; only of arrays the text is kept."""

    name: str
    attributes: Mapping[str, str]
    children: list[Element] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)
    role: str = ""  # the element round it: "Points", "PointData", "Polys", …

    def all(self, *names: str) -> list[Element]:
        """Return the children of some names."""
        return [child for child in self.children if child.name in names]

    def first(self, name: str) -> Element:
        """Return the first child of a name, an empty element where there is none."""
        return next((child for child in self.children if child.name == name), Element(name, {}))

    def arrays(self) -> list[Element]:
        """Return the arrays in it."""
        return self.all(*_ARRAYS)

    def components(self) -> int:
        """Return how many numbers each of an array's values has."""
        count = natural(self, "NumberOfComponents", 1)
        if count > _MOST_PARTS:
            raise MeshdepictError(f"claims impossible components of its array {self.called()!r}")
        return max(count, 1)

    def called(self) -> str:
        """Return an array's name, for sentences."""
        return self.attributes.get("Name", self.role)[:40]


@dataclass
class VtkXml:
    """A file's tree, and what it takes to decode its arrays.

    Attributes
    ----------
    root : Element
    kind : str
        Of data, such as "ImageData".
    coding : Coding
        How arrays are written.
    size : int
        Of the file, in bytes: memory is bounded by it.
    """

    root: Element
    kind: str
    coding: Coding
    size: int
    _claimed: int = 0

    def array(self, element: Element, count: int | None = None) -> NDArray[Any]:
        """Return an array's numbers, flat, in the machine's order of bytes; bits as 0 and 1.

        Parameters
        ----------
        element : Element
            A ``DataArray`` or ``Array``.
        count : int, optional
            How many there have to be at least.

        Raises
        ------
        MeshdepictError
            For damaged data, an unknown type, fewer numbers, and more than a file of its size may
            hold: one clause whose subject is the file.
        """

        def claim(needed: int) -> None:
            check_claim(self._claimed + needed, self.size, "values")

        name, text = element.called(), "".join(element.parts)
        found = decoded(self.coding, element.attributes, name, text, count, claim)
        self._claimed += found.nbytes
        if count is not None and len(found) < count:
            raise MeshdepictError(
                f"is cut off or wrong: its array {name!r} claims more values than it holds"
            )
        return found

    def words(self, element: Element, count: int) -> list[str]:
        """Return so many texts of an array of them, each ended by a 0."""
        letters = self.array(element).astype(np.uint8).tobytes()
        if letters.count(b"\0") < count:
            raise MeshdepictError(
                f"is cut off or wrong: its array {element.called()!r} claims more values than it "
                "holds"
            )
        return [part.decode("utf-8", "replace") for part in letters.split(b"\0")[:count]]


def natural(element: Element, name: str, default: int | None = None) -> int:
    """Return an attribute that counts something, 0 or `default` where it is missing."""
    number = whole_numbers(element.attributes.get(name, str(default or 0)), name, 1)[0]
    if number < 0:
        raise MeshdepictError(f"is wrong as VTK's XML: {name}={number}")
    return number


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


def parse_vtk(data: bytes) -> VtkXml:
    """Return a file's tree; none of its arrays is decoded yet.

    Raises
    ------
    MeshdepictError
        For a file that is cut off or no XML of VTK's, with entities, or nested too deeply.
    """
    at = data.find(_APPENDED)
    end = len(data) if at < 0 else data.find(b">", at) + 1
    if end == 0:
        raise MeshdepictError("is cut off in its XML: <AppendedData is not complete")
    tree = _Tree()
    tree.read(data[:end], final=at < 0)
    root = tree.stack[0].first("VTKFile")
    order = ">" if root.attributes.get("byte_order") == "BigEndian" else "<"
    header = _HEADERS.get(root.attributes.get("header_type", "UInt32"), "I")
    compressor = root.attributes.get("compressor", "")
    if compressor and compressor not in COMPRESSORS:
        raise MeshdepictError(f"is compressed by {compressor[:40]!r}, which is not known")
    coding = Coding(order, header, compressor, len(data))
    if at >= 0:
        if tree.stack[-1].name != "AppendedData":
            raise MeshdepictError("is wrong as XML: it has <AppendedData where no element can be")
        mark, stop = data.find(b"_", end), data.rfind(b"</AppendedData>")
        if mark < 0:
            raise MeshdepictError("is cut off: its appended data don't begin with '_'")
        if stop < mark:
            raise MeshdepictError(f"{WRONG}: its appended data don't end")
        coding.raw = tree.stack[-1].attributes.get("encoding", "base64") == "raw"
        coding.appended = memoryview(data)[mark + 1 : stop]  # a view copies nothing
    return VtkXml(root, root.attributes.get("type", ""), coding, len(data))


class _Tree:
    """Expat, told to make elements and to refuse what may hurt."""

    def __init__(self) -> None:
        self.stack = [Element("", {})]
        self._count = 0
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartElementHandler, parser.EndElementHandler = self._start, self._end
        parser.CharacterDataHandler = self._characters
        parser.EntityDeclHandler = parser.StartDoctypeDeclHandler = self._refuse
        self._expat = parser

    def read(self, data: bytes, *, final: bool) -> None:
        try:
            self._expat.Parse(data, final)
        except expat.ExpatError as error:
            vtp = self.stack[0].first("VTKFile").attributes.get("type") == "PolyData"
            where = "is wrong as VTP: Error parsing its XML" if vtp else WRONG
            what = expat.ErrorString(error.code)
            raise MeshdepictError(f"{where} in line {error.lineno} ({what})") from error
        except MeshdepictError:
            raise
        except (ValueError, LookupError) as error:  # an encoding that nobody knows
            raise MeshdepictError(f"{WRONG}: {error}") from error

    def _refuse(self, *_: object) -> None:
        raise MeshdepictError("declares a document type or entities, which VTK's XML doesn't need")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if len(self.stack) > _DEEPEST:
            raise MeshdepictError(f"is nested more than {_DEEPEST} levels deep, unlike VTK's XML")
        if self._count > _MOST:
            raise MeshdepictError(f"{WRONG}: its elements are too many")
        if len(self.stack) == 1 and name != "VTKFile":
            raise MeshdepictError(f"is XML, but not VTK's: it begins with <{name[:40]}>")
        element = Element(name, attributes, role=self.stack[-1].name)
        self.stack[-1].children.append(element)
        self.stack.append(element)

    def _end(self, name: str) -> None:
        self.stack.pop()

    def _characters(self, text: str) -> None:
        if self.stack[-1].name in _ARRAYS:
            self.stack[-1].parts.append(text)
