"""Buffers, buffer views and accessors of glTF: numbers, as far as the file really holds them."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.files.reach import inside

__all__ = ["COMPONENTS", "Buffers", "as_fractions", "pick", "whole"]

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_COPIES = 2  # of an array of doubles: as it is, and joined with others
_DRACO = 16  # times as tight as numbers are otherwise, at most
_SHORT = "its buffers are shorter than its glTF header says"
_MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")


class Buffers:
    """What the header's accessors name, read when it is asked for.

    Parameters
    ----------
    header : dict
        The JSON part. Where it doesn't follow the standard, reading raises what Python raises.
    chunk : bytes
        The binary part, empty if there is none.
    folder : Path
        Where buffers in files of their own lie, or below.
    size : int
        Of the file, in bytes: memory is bounded by it.

    Attributes
    ----------
    folder : Path
        As given.
    """

    def __init__(self, header: dict[str, Any], chunk: bytes, folder: Path, size: int) -> None:
        self._header = header
        self.folder = folder
        self._chunk = chunk
        self._files: dict[str, bytes] = {}
        self._decoded: dict[int, bytes] = {}
        self._size = size
        self._claimed = 0

    def claim(self, numbers: int, what: str) -> None:
        """Count numbers that will be kept; refuse what no file of this size should ask for."""
        self._claimed += 8 * _COPIES * numbers
        check_claim(self._claimed, self._size, what)

    def forget_claims(self) -> None:
        """Begin to count anew: what was kept so far is kept no longer."""
        self._claimed = 0

    def count(self, index: int) -> int:
        """Return how many values an accessor has."""
        return whole(pick(self._header, "accessors", index), "count")

    def accessor(self, index: int, *, fractions: bool = False) -> NDArray[Any]:
        """Return an accessor's values as (count, components), normalised where it says so.

        ``fractions`` takes integers as fractions of their range in any case.
        """
        accessor = pick(self._header, "accessors", index)
        kind = np.dtype("<" + COMPONENTS[accessor["componentType"]])
        shape = (whole(accessor, "count"), _SIZES[accessor["type"]])
        if "bufferView" in accessor:
            values = self._viewed(accessor, kind, shape)
        else:
            needed = 8 * _COPIES * shape[0] * shape[1]
            check_claim(needed, self._size, "numbers in an accessor without data")
            values = np.zeros(shape, kind)
        if sparse := accessor.get("sparse"):
            count = whole(sparse, "count")
            index_kind = np.dtype("<" + COMPONENTS[sparse["indices"]["componentType"]])
            at = self._viewed(sparse["indices"], index_kind, (count, 1))[:, 0]
            values = values.copy()
            values[at] = self._viewed(sparse["values"], kind, (count, shape[1]))
        return as_fractions(values) if fractions or accessor.get("normalized") else values

    def indices(self, index: int) -> NDArray[np.int64]:
        """Return an accessor's values as (count, components) of whole numbers.

        Raises
        ------
        MeshdepictError
            For floats.
        """
        values = self.accessor(index)
        if values.dtype.kind not in "iu":
            raise MeshdepictError(f"is wrong as glTF: accessor {index} holds floats as indices")
        return values.astype(np.int64)

    def packed(self, index: int, numbers: int) -> bytes:
        """Return a buffer view that Draco packed, having counted the numbers that are in it."""
        data = self.view(index)
        self._size += (_DRACO - 1) * len(data)
        self.claim(numbers, "triangles")
        return bytes(data)

    def view(self, index: int) -> memoryview:
        """Return the bytes of a buffer view."""
        view = pick(self._header, "bufferViews", index)
        described = pick(self._header, "buffers", view["buffer"])
        for extension in _MESHOPT:  # where it isn't required, data may be there uncompressed
            if extension in described.get("extensions", {}):
                raise MeshdepictError(
                    f"is compressed ({extension}), which is not read; export it uncompressed"
                )
        buffer = self.content(view["buffer"])
        start, length = whole(view, "byteOffset", 0), whole(view, "byteLength", len(buffer))
        if start + length > len(buffer):
            due = whole(described, "byteLength", 0)
            cut = "is cut off" if due > len(buffer) else "is wrong as glTF"
            raise MeshdepictError(f"{cut}: {_SHORT}")
        return memoryview(buffer)[start : start + length]

    def _viewed(
        self, described: dict[str, Any], kind: np.dtype[Any], shape: tuple[int, int]
    ) -> NDArray[Any]:
        index = described["bufferView"]
        data = self.view(index)
        start = whole(described, "byteOffset", 0)
        count, components = shape
        row = kind.itemsize * components
        stride = whole(self._header["bufferViews"][index], "byteStride", row)
        if stride < row:
            raise MeshdepictError(
                f"is wrong as glTF: bufferView {index} puts values of {row} bytes only {stride} "
                "bytes apart"
            )
        if count and start + (count - 1) * stride + row > len(data):
            raise MeshdepictError(
                f"is wrong as glTF: an accessor reaches beyond bufferView {index}; {_SHORT}"
            )
        return np.ndarray(shape, kind, data, start if count else 0, (stride, kind.itemsize))

    def content(self, index: int) -> bytes:
        """Return all bytes of a buffer."""
        buffer = pick(self._header, "buffers", index)
        uri = buffer.get("uri")
        if uri is None:
            if index or not self._chunk:
                raise MeshdepictError(f"is wrong as glTF: there are no data for its buffer {index}")
            return self._chunk
        if uri.startswith("data:"):
            if index not in self._decoded:
                self._decoded[index] = base64.b64decode(uri.partition(",")[2])
            return self._decoded[index]
        if uri not in self._files:
            path = inside(self.folder, unquote(uri), "buffer")
            try:
                with path.open("rb") as file:
                    self._files[uri] = file.read(whole(buffer, "byteLength", -1))
            except OSError as error:
                raise MeshdepictError(
                    f"needs the file {uri!r} beside it, which can't be read ({error.strerror})"
                ) from None
            self._size += len(self._files[uri])
        return self._files[uri]


def as_fractions(values: NDArray[Any]) -> NDArray[Any]:
    """Return integers as fractions of their range, other numbers as they are."""
    if values.dtype.kind in "iu":
        return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
    return values


def pick(header: dict[str, Any], name: str, index: Any) -> Any:
    """Return one of what the header lists: an accessor, a node.

    Raises
    ------
    MeshdepictError
        Where there is none of that number.
    KeyError
        Where there are none at all.
    """
    listed = header[name]
    if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(listed):
        raise MeshdepictError(
            f"is wrong as glTF: it refers to number {index!r:.40} of its {len(listed):,} {name}"
        )
    return listed[index]


def whole(described: dict[str, Any], name: str, default: int | None = None) -> int:
    """Return a count or an offset of the header.

    Raises
    ------
    MeshdepictError
        Where it is no whole number, or negative.
    KeyError
        Where it is missing and there is no default.
    """
    number = described[name] if default is None else described.get(name, default)
    if number is default:
        return default
    if not isinstance(number, int) or isinstance(number, bool) or number < 0:
        raise MeshdepictError(f"is wrong as glTF: {name} {number!r:.40} is no count")
    return number
