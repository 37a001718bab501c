"""VTK's XML files, read without VTK, which believes whatever counts and places a file claims.

Elements become a small tree; arrays are decoded from text, base64 or the appended data, and never
to more than the file's allowance.
"""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import struct
import zlib
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim

__all__ = ["Element", "VtkXml", "parse_vtk"]

_DEEPEST = 32
_MOST = 1 << 18  # elements; a file has a few for each array
_TYPES = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4",
    "Int64": "i8", "UInt64": "u8", "Float32": "f4", "Float64": "f8", "String": "i1",
}  # fmt: skip
_WRONG = "is cut off or wrong as VTK's XML"


@dataclass
class Element:
    """An element with its attributes, text and children."""

    name: str
    attributes: dict[str, str]
    children: list[Element] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """What is written in the element itself."""
        return "".join(self.parts)

    def all(self, name: str) -> list[Element]:
        """Return the children of a name."""
        return [child for child in self.children if child.name == name]

    def first(self, name: str) -> Element:
        """Return the first child of a name, an empty element where there is none."""
        return next((child for child in self.children if child.name == name), Element(name, {}))


@dataclass
class VtkXml:
    """A file's tree, and what it takes to decode its arrays.

    Attributes
    ----------
    root : Element
    kind : str
        Of data, such as "ImageData".
    size : int
        Of the file, in bytes.
    appended : bytes-like
        Data behind the tree, as they are or in base64.
    """

    root: Element
    kind: str
    size: int
    appended: Any
    in_base64: bool
    order: str
    header: str
    compressor: str

    def array(self, element: Element, count: int | None = None) -> NDArray[Any]:
        """Return an array's numbers, flat.

        Parameters
        ----------
        element : Element
            A ``DataArray`` or ``Array``.
        count : int, optional
            How many there have to be.

        Raises
        ------
        MeshdepictError
            For damaged data, another type or count, and more than a file of its size may hold.
        """
        name = element.attributes.get("type", "")
        if name not in _TYPES:
            raise MeshdepictError(f"{_WRONG}: it has an array of the unknown type {name[:20]!r}")
        kind = np.dtype(_TYPES[name]).newbyteorder(self.order)  # type: ignore[arg-type]
        if count is not None:
            check_claim(count * kind.itemsize, self.size, "values")
        how = element.attributes.get("format", "ascii")
        try:
            if how == "ascii":
                found = self._ascii(element.text, kind)
            elif how == "binary":
                found = np.frombuffer(self._inline(element.text), kind)
            elif how == "appended":
                found = np.frombuffer(self._behind(element.attributes.get("offset", "")), kind)
            else:
                raise ValueError(f"an array in the unknown format {how[:20]!r}")
        except (ValueError, OverflowError, struct.error, zlib.error, lzma.LZMAError,
                binascii.Error, EOFError) as error:  # fmt: skip
            text = str(error)[:100]
            raise MeshdepictError(f"{_WRONG}: {text or 'an array ends too early'}") from error
        if count is not None and len(found) != count:
            short = "fewer" if len(found) < count else "more"
            raise MeshdepictError(f"{_WRONG}: an array holds {short} values than its header claims")
        return found

    def _ascii(self, text: str, kind: np.dtype[Any]) -> NDArray[Any]:
        words = text.split()
        number: Any = int if kind.kind in "iu" else float
        return np.fromiter(map(number, words), kind.newbyteorder("="), len(words))

    def _inline(self, text: str) -> bytes:
        packed = "".join(text.split()).encode("ascii")
        return self._blocks(_Base64(packed))

    def _behind(self, offset: str) -> bytes:
        if not re.fullmatch(r"\d{1,18}", offset) or int(offset) >= len(self.appended):
            raise ValueError("an array begins beyond the file's end")
        at = int(offset)
        if self.in_base64:
            return self._blocks(_Base64(self.appended[at:]))
        return self._blocks(_Plain(self.appended, at))

    def _blocks(self, source: Any) -> bytes:
        """Return an array's bytes: in one piece, or in blocks that are each compressed."""
        width = struct.calcsize(self.header)
        if not self.compressor:
            (length,) = struct.unpack(self.order + self.header, source.take(width))
            return bytes(source.take(length))
        start = source.take(3 * width, part=True)
        blocks, each, last = struct.unpack(f"{self.order}3{self.header}", start)
        if blocks * width > self.size or (blocks and not each):
            raise ValueError("an array has more blocks than the file can hold")
        if not blocks:
            return b""
        total = (blocks - 1) * each + (last or each)
        check_claim(total, self.size, "values")
        lengths = struct.unpack(f"{self.order}{blocks}{self.header}", source.take(blocks * width))
        source.next_stream()
        found = bytearray()
        for at, length in enumerate(lengths):
            wanted = (last or each) if at == blocks - 1 else each
            part = _inflated(self.compressor, source.take(length), wanted)
            if len(part) != wanted:
                raise ValueError("a compressed block is damaged")
            found += part
        return bytes(found)


class _Plain:
    """Bytes that are taken one after the other."""

    def __init__(self, data: Any, at: int) -> None:
        self._data, self._at = data, at

    def take(self, count: int, *, part: bool = False) -> Any:
        """Return the next bytes."""
        found = self._data[self._at : self._at + count]
        if len(found) < count:
            raise EOFError
        self._at += count
        return found

    def next_stream(self) -> None:
        """Go on behind the header."""


class _Base64:
    """The same in base64, where header and blocks are padded each by itself."""

    def __init__(self, text: Any) -> None:
        self._text, self._at, self._bytes = text, 0, b""

    def take(self, count: int, *, part: bool = False) -> bytes:
        """Return the next bytes; `part`: more of the same stream follow."""
        missing = count - len(self._bytes)
        if missing > 0:
            letters = -(-missing // 3) * 4
            more = base64.b64decode(self._text[self._at : self._at + letters], validate=True)
            self._at += letters
            self._bytes += more
        found, self._bytes = self._bytes[:count], self._bytes[count:]
        if len(found) < count:
            raise EOFError
        return found

    def next_stream(self) -> None:
        """Go on behind the header and its padding."""
        self._bytes = b""


def _inflated(compressor: str, data: Any, wanted: int) -> bytes:
    if compressor == "vtkZLibDataCompressor":
        unpacking = zlib.decompressobj()
        found = unpacking.decompress(bytes(data), wanted + 1)  # one more: then its sum is checked
        return found if unpacking.eof else b""
    if compressor == "vtkLZMADataCompressor":
        return lzma.LZMADecompressor().decompress(bytes(data), wanted + 1)
    if compressor == "vtkLZ4DataCompressor":
        return _unpacked_lz4(bytes(data), wanted)
    raise ValueError(f"it is compressed by the unknown {compressor[:40]!r}")


def _unpacked_lz4(data: bytes, wanted: int) -> bytes:
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
            raise ValueError("a compressed block is damaged")
        first = len(found) - back
        piece = found[first : first + length]
        found += (piece * (length // len(piece) + 1))[:length]
    return bytes(found)


def parse_vtk(data: bytes) -> VtkXml:
    """Return a file's tree.

    Raises
    ------
    MeshdepictError
        For a file that is cut off or no XML of VTK's, with entities, or nested too deeply.
    """
    start, appended, in_base64 = _apart(data)
    stack: list[Element] = [Element("", {})]
    parser = expat.ParserCreate()
    parser.buffer_text = True

    count = 0

    def open_(name: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if len(stack) > _DEEPEST or count > _MOST:
            what = "are too many" if count > _MOST else f"nest deeper than {_DEEPEST}"
            raise MeshdepictError(f"{_WRONG}: its elements {what}")
        element = Element(name, attributes)
        stack[-1].children.append(element)
        stack.append(element)

    def close(_: str) -> None:
        stack.pop()

    def text(part: str) -> None:
        stack[-1].parts.append(part)

    def refuse(*_: Any) -> None:
        raise MeshdepictError(f"{_WRONG}: it declares entities, and no honest file does")

    parser.StartElementHandler, parser.EndElementHandler = open_, close
    parser.CharacterDataHandler = text
    parser.EntityDeclHandler = parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(start, True)  # noqa: FBT003
    except expat.ExpatError as error:
        raise MeshdepictError(f"{_WRONG}: {expat.ErrorString(error.code)}") from error
    except (ValueError, LookupError) as error:  # an encoding that nobody knows
        if isinstance(error, MeshdepictError):
            raise
        raise MeshdepictError(f"{_WRONG}: {error}") from error
    root = stack[0].first("VTKFile")
    if not stack[0].children or root.name != "VTKFile" or not root.attributes:
        raise MeshdepictError(f"{_WRONG}: it has no element VTKFile")
    order = ">" if root.attributes.get("byte_order") == "BigEndian" else "<"
    header = "Q" if root.attributes.get("header_type") == "UInt64" else "I"
    return VtkXml(
        root, root.attributes.get("type", ""), len(data), appended, in_base64, order, header,
        root.attributes.get("compressor", ""),
    )  # fmt: skip


def _apart(data: bytes) -> tuple[bytes, Any, bool]:
    """Return the tree as XML, and the appended data, which may be no XML at all."""
    found = re.search(rb"<AppendedData\b([^<>]*)>", data)
    if not found:
        return data, b"", False
    in_base64 = b"base64" in found[1]
    mark = data.find(b"_", found.end())
    end = data.rfind(b"</AppendedData>")
    if mark < 0 or end < mark:
        raise MeshdepictError(f"{_WRONG}: its appended data don't end")
    # Slices of a view copy nothing.
    return data[: found.end()] + data[end:], memoryview(data)[mark + 1 : end], in_base64
