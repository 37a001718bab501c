"""What VTK's XML files claim, compared with what they hold, before VTK allocates memory for it.

VTK believes every count, extent, offset and length, and ends the process where memory ends. Each
array here has to hold the values that its piece counts, in data that lie within the file.
"""

from __future__ import annotations

import base64
import binascii
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.files.vtk_errors import vtk_errors
from meshdepict.files.vtk_xml import XmlArray, XmlFile, parsed, whole_numbers

__all__ = ["check_xml"]

_TYPES = {
    "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4",
    "Int64": "i8", "UInt64": "u8", "Float32": "f4", "Float64": "f8",
    "String": "u1",  # a byte at least for each
}  # fmt: skip
_CELLS = ("Verts", "Lines", "Strips", "Polys")
_COUNTS = {role: f"NumberOf{role}" for role in _CELLS}
_COMPRESSORS = ("vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor")
_MOST = 1000  # components of a value


def check_xml(data: bytes) -> XmlFile:
    """Refuse a VTP or VTI file that claims what it doesn't hold.

    Parameters
    ----------
    data : bytes
        The whole file.

    Returns
    -------
    XmlFile
        What it declares.

    Raises
    ------
    MeshdepictError
        One clause whose subject is the file.
    """
    file = parsed(data)
    if file.compressor and file.compressor not in _COMPRESSORS:
        raise MeshdepictError(f"is compressed by {file.compressor[:40]!r}, which is not known")
    total = _whole_points(file)
    for array in file.arrays:
        total += _checked(file, array)
        check_claim(total, len(data), "values")
    return file


def _whole_points(file: XmlFile) -> int:
    """Return the bytes that VTK allocates for an image, whatever its pieces hold."""
    if "WholeExtent" not in file.whole:
        return 0
    whole = _dimensions(file.whole["WholeExtent"], "WholeExtent")
    held = [_dimensions(piece.get("Extent", ""), "Extent") for piece in file.pieces]
    if sum(map(math.prod, held)) < math.prod(whole):
        raise MeshdepictError("claims a larger extent than its pieces have")
    return 0


def _dimensions(text: str, name: str) -> list[int]:
    numbers = whole_numbers(text, name, 6)
    return [
        max(last - first + 1, 0) for first, last in zip(numbers[::2], numbers[1::2], strict=True)
    ]


def _checked(file: XmlFile, array: XmlArray) -> int:
    """Check one array, and return how many bytes its values take."""
    kind = array.attributes.get("type", "")
    components = array.count("NumberOfComponents", 1)
    if not 0 <= components <= _MOST:
        raise MeshdepictError(f"claims impossible components of its array {array.name[:40]!r}")
    bits = 1 if kind == "Bit" else 8 * np.dtype(_kind(array)).itemsize
    needed = -(-_tuples(file, array) * max(components, 1) * bits // 8)
    held = _Held(file, array)
    if needed > held.size:
        raise MeshdepictError(
            f"is cut off or wrong: its array {array.name[:40]!r} claims more values than it holds"
        )
    if array.role in _CELLS and array.name == "offsets" and needed:
        _check_offsets(file, array, held.values()[: _tuples(file, array)])
    return max(needed, held.size)


def _kind(array: XmlArray) -> str:
    kind = array.attributes.get("type", "")
    if kind != "Bit" and kind not in _TYPES:
        raise MeshdepictError(f"has an array {array.name[:40]!r} of the unknown type {kind[:40]!r}")
    return _TYPES.get(kind, "u1")


def _tuples(file: XmlFile, array: XmlArray) -> int:
    """Return how many values VTK will read; those of connectivity its offsets tell."""
    piece = array.piece
    if piece is None:
        return _natural(array.attributes.get("NumberOfTuples", "0"), "NumberOfTuples")
    if "Extent" in piece:
        dimensions = _dimensions(piece["Extent"], "Extent")
        cells = array.role == "CellData"
        return math.prod(max(n - 1, 1) if cells else n for n in dimensions)
    if array.role in ("Points", "PointData"):
        return _natural(piece.get("NumberOfPoints", "0"), "NumberOfPoints")
    if array.role == "CellData":
        names = [*_COUNTS.values(), "NumberOfCells"]
        return sum(_natural(piece.get(name, "0"), name) for name in names)
    if array.role in _CELLS and array.name == "offsets":
        return _natural(piece.get(_COUNTS[array.role], "0"), _COUNTS[array.role])
    return 0


def _natural(text: str, name: str) -> int:
    number = whole_numbers(text, name, 1)[0]
    if number < 0:
        raise MeshdepictError(f"is wrong as VTK's XML: {name}={number}")
    return number


def _check_offsets(file: XmlFile, array: XmlArray, offsets: NDArray[Any]) -> None:
    """Refuse offsets that fall, or lead beyond the connectivity of the same cells."""
    same = [
        other for other in file.arrays
        if other.piece is array.piece and other.role == array.role and other.name == "connectivity"
    ]  # fmt: skip
    items = 0
    if same:
        held = _Held(file, same[0])
        items = held.size // np.dtype(_kind(same[0])).itemsize
    rising = bool((np.diff(offsets.astype(np.float64), prepend=0) >= 0).all())
    if not rising or not offsets[-1] <= items:
        raise MeshdepictError(
            f"is wrong as VTK's XML: the offsets of its {array.role} don't fit their connectivity"
        )


class _Held:
    """The data of one array, as far as they lie within the file."""

    def __init__(self, file: XmlFile, array: XmlArray) -> None:
        self._file, self._array = file, array
        self._type = np.dtype(_kind(array))
        self._words: str | None = None
        self._plain, self._coded, self._at = True, b"", 0
        attributes = array.attributes
        if "offset" in attributes:  # then VTK reads appended data, whatever the format
            offset = _natural(attributes["offset"], "offset")
            if file.start < 0 or file.start + offset >= len(file.data):
                raise MeshdepictError(
                    f"is cut off or wrong: its array {array.name[:40]!r} lies beyond its end"
                )
            self._plain, self._coded, self._at = file.raw, file.data, file.start + offset
        elif attributes.get("format") == "binary":
            self._plain = False
            self._coded = "".join("".join(array.text).split()).encode("ascii", "replace")
        else:
            self._words = " ".join(array.text)
        if self._words is not None:
            self.size = len(self._words.split()) * self._type.itemsize
        elif not self._plain and not self._coded.strip():
            self.size = 0
        else:
            self._lengths = self._read_lengths()
            self.size = self._uncompressed()

    def _bytes(self, start: int, count: int) -> bytes:
        """Return so many bytes of the data, ``start`` bytes after the array's beginning.

        In base64, what is in front of the data is coded by itself, so ``start`` is 0 or its length.
        """
        if self._plain:
            found = self._coded[self._at + start : self._at + start + count]
        else:
            skipped = -(-start // 3) * 4
            letters = self._coded[self._at + skipped :][: -(-count // 3) * 4]
            try:
                found = base64.b64decode(letters)[:count]
            except binascii.Error:
                found = b""
        if len(found) < count:
            raise MeshdepictError(
                f"is cut off: the data of its array {self._array.name[:40]!r} end too early"
            )
        return found

    def _numbers(self, start: int, count: int) -> list[int]:
        kind = f"{self._file.order}u{self._file.header}"
        return np.frombuffer(self._bytes(start, count * self._file.header), kind).tolist()

    def _room(self) -> int:
        """Return how many bytes of data there are at most."""
        left = len(self._coded) - self._at
        return left if self._plain else left * 3 // 4

    def _read_lengths(self) -> list[int]:
        """Return the numbers in front of the data: their length, or those of compressed blocks."""
        if not self._file.compressor:
            return self._numbers(0, 1)
        blocks = self._numbers(0, 1)[0]
        if blocks * self._file.header > self._room():
            raise MeshdepictError(
                f"is cut off or wrong: its array {self._array.name[:40]!r} claims more blocks than "
                "it holds"
            )
        return self._numbers(0, 3 + blocks) if blocks else [0, 0, 0]

    def _uncompressed(self) -> int:
        """Return the length of the data as VTK will allocate it."""
        if not self._file.compressor:
            needed = self._lengths[0]
            if needed > self._room():
                raise MeshdepictError(
                    f"is cut off: the data of its array {self._array.name[:40]!r} end too early"
                )
            return needed
        blocks, size, last, *packed = self._lengths
        if sum(packed) > self._room():
            raise MeshdepictError(
                f"is cut off: the data of its array {self._array.name[:40]!r} end too early"
            )
        check_claim(blocks * size + last, len(self._file.data), "values")
        return (blocks - 1) * size + (last or size) if blocks else 0

    def values(self) -> NDArray[Any]:
        """Return the values; short ones where they can't be read, which VTK says itself."""
        if self._words is not None:
            try:
                return np.array(self._words.split(), np.float64)
            except ValueError:
                raise MeshdepictError(
                    f"has something else than numbers in its array {self._array.name[:40]!r}"
                ) from None
        front = len(self._lengths) * self._file.header
        kind = self._file.order + self._type.str[1:]
        plain = not self._file.compressor
        data = self._after(front, self.size) if plain else self._unpacked(front)
        usable = len(data) // self._type.itemsize * self._type.itemsize
        return np.frombuffer(data[:usable], kind)

    def _after(self, front: int, count: int) -> bytes:
        """Return the data behind the numbers in front; some programs code both in one go."""
        if not self._plain:
            letters = -(-front // 3) * 4
            if b"=" not in self._coded[self._at : self._at + letters] and front % 3:
                return self._bytes(0, front + count)[front:]
        return self._bytes(front, count)

    def _unpacked(self, front: int) -> bytes:
        from vtkmodules import vtkIOCore

        blocks, size, last, *packed = self._lengths
        coded = self._bytes(front, sum(packed))
        compressor = getattr(vtkIOCore, self._file.compressor)()
        parts, at = [], 0
        for number, length in enumerate(packed):
            wanted = last if last and number == blocks - 1 else size
            block = np.zeros(wanted, np.uint8)
            with vtk_errors() as errors:
                found = compressor.Uncompress(coded[at : at + length], length, block, wanted)
            at += length
            if errors or found != wanted:
                raise MeshdepictError(
                    f"is damaged: unpacking its array {self._array.name[:40]!r} failed"
                )
            parts.append(block.tobytes())
        return b"".join(parts)
