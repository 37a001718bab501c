"""The header of a PLY file: what it declares, and how to rewrite it with everything else kept."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import BinaryIO

from meshdepict.errors import MeshdepictError
from meshdepict.files.mark import MARK

__all__ = [
    "POSITION", "Element", "Header", "Property", "fresh_header", "parse_header", "read_header",
]  # fmt: skip

POSITION = ("x", "y", "z")  # of a vertex

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
NAMES = {kind: name for name, kind in reversed(TYPES.items())}  # "u1": "uchar", …
_ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
_OVERLAP = 1 << 12  # bytes that are searched again for a line in two pieces
_COUNT = re.compile(rb"[0-9]{1,18}")  # of rows; more no disk holds
_END = re.compile(rb"(?:\r\n|\n|\r)[ \t]*end_header[ \t]*(\r\n|\n|\r|\Z)")


@dataclass(frozen=True)
class Property:
    """One property: ``kind`` as NumPy names it, ``count`` the type of a list's length."""

    name: str
    kind: str
    count: str | None = None
    line: int = -1  # of the header, where it came from one

    @property
    def declaration(self) -> str:
        """The line that declares it."""
        listed = f"list {NAMES[self.count]} " if self.count else ""
        return f"property {listed}{NAMES[self.kind]} {self.name}"


@dataclass(frozen=True)
class Element:
    """One element: so many rows of such properties."""

    name: str
    count: int
    properties: tuple[Property, ...] = ()
    line: int = -1

    @property
    def names(self) -> list[str]:
        """The names of its properties."""
        return [item.name for item in self.properties]


@dataclass(frozen=True)
class Header:
    """A parsed header with its lines as they were, line ends included."""

    lines: tuple[bytes, ...]
    newline: bytes
    order: str  # "" for ASCII, else NumPy's "<" or ">"
    elements: tuple[Element, ...]
    size: int  # in bytes, with the end of its last line

    @property
    def provenance(self) -> tuple[str, ...]:
        """The comments that this program wrote."""
        comments = [_comment(line) for line in self.lines]
        return tuple(text for text in comments if text.startswith(MARK))

    def rewritten(
        self, edited: Mapping[str, Sequence[Property]], comments: Iterable[str] | None
    ) -> bytes:
        """Return the header's text with the properties of some elements and its provenance new.

        Lines that declare a property which stays as it was are not touched.

        Parameters
        ----------
        edited : {element: properties}
            The properties that the element has from now on; what has a ``line`` took its place.
        comments : iterable of str or None
            New lines of provenance in place of the old ones; None keeps those.
        """
        text: dict[int, list[bytes]] = {at: [line] for at, line in enumerate(self.lines)}
        for element in self.elements:
            if element.name not in edited:
                continue
            last = element.line
            for former in element.properties:
                text[former.line], last = [], former.line
            unchanged = set(element.properties)
            for item in edited[element.name]:
                if item.line < 0:
                    text[last].append(item.declaration.encode() + self.newline)
                elif item in unchanged:
                    text[item.line].insert(0, self.lines[item.line])
                else:
                    text[item.line].insert(0, item.declaration.encode() + self.newline)
        if comments is not None:
            for at, line in enumerate(self.lines):
                if _comment(line).startswith(MARK):
                    text[at] = []
            words = [line.split()[:1] for line in self.lines]
            text[words.index([b"format"])] += [
                f"comment {comment}".encode() + self.newline for comment in comments
            ]
        return b"".join(line for at in range(len(self.lines)) for line in text[at])


def fresh_header(
    elements: Sequence[Element], comments: Iterable[str], *, in_words: bool = False
) -> bytes:
    """Return the header of a new file, binary and little-endian or ASCII."""
    encoding = "ascii" if in_words else "binary_little_endian"
    lines = ["ply", f"format {encoding} 1.0", *(f"comment {text}" for text in comments)]
    for element in elements:
        lines.append(f"element {element.name} {element.count}")
        lines += [item.declaration for item in element.properties]
    return "".join(f"{line}\n" for line in [*lines, "end_header"]).encode()


def read_header(file: BinaryIO) -> Header:
    """Parse the header of an open file, reading little more than it."""
    read = bytearray()
    while chunk := file.read(1 << 14):
        seen = max(len(read) - _OVERLAP, 0)
        read += chunk
        if _END.search(read, seen):
            break
    return parse_header(bytes(read))


def parse_header(data: bytes) -> Header:
    """Parse the header that a file's bytes begin with.

    Raises
    ------
    MeshdepictError
        For a header that ends early, or a line that says nothing PLY knows.
    """
    begin = re.match(rb"ply[ \t]*(\r\n|\n|\r)", data)
    if not begin:
        raise MeshdepictError("is no PLY file: it doesn't begin with the line 'ply'")
    end = _END.search(data)
    if not end:
        raise MeshdepictError("is cut off in its PLY header: there is no line 'end_header'")
    newline = begin[1]
    size = end.start(1) + len(newline) if end[1] else end.end()
    lines = tuple(data[:size].splitlines(keepends=True))
    order: str | None = None
    declared: list[tuple[Element, list[Property]]] = []
    for number, line in enumerate(lines):
        words = line.split()
        match words[:1]:
            case [] | [b"ply" | b"comment" | b"obj_info" | b"end_header"]:
                pass
            case [b"format"] if len(words) > 1 and words[1] in _ORDERS:
                order = _ORDERS[words[1]]
            case [b"element"] if len(words) == 3 and _COUNT.fullmatch(words[2]):
                declared.append((Element(_text(words[1]), int(words[2]), (), number), []))
            case [b"property"] if declared and (found := _property(words, number)):
                declared[-1][1].append(found)
            case _:
                shown = _text(line).strip()[:80]
                raise MeshdepictError(
                    f"has a PLY header whose line {number + 1} is not understood: {shown!r}"
                )
    if order is None:
        raise MeshdepictError("has a PLY header without the line 'format …'")
    elements = [replace(element, properties=tuple(items)) for element, items in declared]
    _check_names("elements", [element.name for element in elements])
    for element in elements:
        _check_names(f"properties of {element.name}", element.names)
    return Header(lines, newline, order, tuple(elements), size)


def _property(words: list[bytes], line: int) -> Property | None:
    types = [TYPES.get(_text(word)) for word in words[1:-1]]
    if words[1:2] == [b"list"]:
        match types:
            case [None, str(count), str(kind)] if count[0] != "f":
                return Property(_text(words[-1]), kind, count, line)
        return None
    match types:
        case [str(kind)]:
            return Property(_text(words[-1]), kind, None, line)
    return None


def _check_names(what: str, names: list[str]) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise MeshdepictError(f"has a PLY header with two {what} called {name!r}")


def _comment(line: bytes) -> str:
    """Return the text of a comment, an empty one for other lines."""
    words = line.lstrip().split(None, 1)
    return _text(words[1]).rstrip() if len(words) == 2 and words[0] == b"comment" else ""


def _text(line: bytes) -> str:
    return line.decode("utf-8", "replace")
