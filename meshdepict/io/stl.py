"""STL, binary and ASCII: triangles without shared vertices, joined where positions are equal."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import text
from meshdepict.shapes.document import Contents, Document
from meshdepict.surface.welding import same_position

__all__ = ["decode", "provenance"]

_HEADER = 84  # bytes: 80 of text and the number of triangles
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_SOLID = re.compile(rb"(?i)\s*solid\b")
# Every pattern below reads a byte a bounded number of times, whatever the file holds.
_FACET = re.compile(rb"(?im)^[ \t]*facet\b|\bfacet[ \t]+normal\b")
_VERTEX = re.compile(rb"(?i)\bvertex\s+(\S+\s+\S+\s+\S+)")
_NAME = re.compile(rb"(?im)^[ \t]*(?:end)?solid\b(?![^\n]*facet[ \t]+normal)[^\n]*")
_UNKNOWN = 2**31 - 1  # triangles and more: what programs write that don't know the count yet
_ABSURD = 1000  # times the file's own length: no file is cut off that short


def decode(data: bytes, path: Path) -> Contents:
    """Read a mesh whose vertices are the distinct positions, in the order of their appearance.

    Raises
    ------
    MeshdepictError
        For a file that is cut off, and for one that is no STL.
    """
    corners = _ascii_corners(data) if _is_text(data) else _binary_corners(data, path)
    with np.errstate(invalid="ignore"):  # a signalling NaN: `Mesh` says what it thinks of those
        corners = corners.astype(np.float64)
    vertices, faces = _joined(corners)
    return Contents(vertices, faces, {}, Document(up="z"))  # of whoever prints it


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return nothing: this program writes no STL."""
    return ()


def _is_text(data: bytes) -> bool:
    """Whether this is ASCII STL; a binary one may begin with "solid", too.

    Its count, its normals or its attributes hold bytes that no text has.
    """
    if not _SOLID.match(data):
        return False
    count = int.from_bytes(data[80:_HEADER], "little")
    if len(data) == _HEADER + count * _TRIANGLE.itemsize:
        return False
    start = data[: _HEADER + 10 * _TRIANGLE.itemsize].rstrip(b"\0")
    return not re.search(rb"[\x00-\x08\x0e-\x1a]", start)


def _binary_corners(data: bytes, path: Path) -> NDArray[np.float32]:
    size = _TRIANGLE.itemsize
    count = int.from_bytes(data[80:_HEADER], "little") if len(data) >= _HEADER else 0
    held, rest = divmod(max(len(data) - _HEADER, 0), size)
    if count > held or len(data) < _HEADER:
        due = _HEADER + count * size
        if count >= _UNKNOWN and held and not rest:
            _note(path, f"counts no triangles in its header; all {held:,} of its length are read")
        elif due > _ABSURD * len(data):
            raise MeshdepictError(
                f"is no STL: neither text that begins with 'solid' nor as long as its header says "
                f"({len(data):,} bytes are there)"
            )
        else:
            raise MeshdepictError(
                f"is cut off or no STL: {due:,} bytes are due, but {len(data):,} are there"
            )
    triangles = np.frombuffer(data, _TRIANGLE, held, _HEADER)
    if count < held:
        if _go_on(triangles, count):
            _note(
                path, f"counts {count:,} triangles in its header but holds {held:,}: all are read"
            )
        else:
            _note(
                path,
                f"goes on after the {count:,} triangles that its header counts: the rest, "
                f"{(held - count) * size + rest:,} bytes that are no triangles, is not read",
            )
            triangles = triangles[:count]
    corners: NDArray[np.float32] = triangles["corners"].reshape(-1, 3)
    return corners


def _go_on(triangles: NDArray[Any], count: int) -> bool:
    """Whether the bytes after the counted triangles are triangles, too.

    Then all their numbers are finite, not all of them zero, and none is more than a hundred times
    the largest of its kind among the counted ones (of which a normal has one at least).
    """
    later, counted = triangles[count:], triangles[:count]
    if not later["corners"].any():
        return False  # padding
    for kind, least in (("normal", 1.0), ("corners", 0.0 if count else 1e30)):
        with np.errstate(all="ignore"):  # any bytes may stand here
            reach = float(np.abs(later[kind]).max())
            known = max(float(np.abs(counted[kind]).max(initial=0)), least)
        if not reach <= 100 * known:  # NaN isn't, either
            return False
    return True


def _ascii_corners(data: bytes) -> NDArray[np.float64]:
    data = data.rstrip(b"\0 \t\r\n\x1a").replace(b"\r", b"\n")
    body = _NAME.sub(b"", data)  # a name may hold any word
    found = _VERTEX.findall(body)
    facets = sum(1 for _ in _FACET.finditer(body))
    if len(found) != 3 * facets or not re.search(rb"(?i)endsolid", data[-1000:]):
        raise MeshdepictError(
            f"is cut off or wrong as ASCII STL: {facets:,} facets with {len(found):,} corners"
            f"{'' if b'endsolid' in data.lower() else ', no endsolid'}"
        )
    try:
        return text.floats(b" ".join(found)).reshape(-1, 3)
    except ValueError:
        raise MeshdepictError("has an ASCII STL vertex that is not three numbers") from None


def _note(path: Path, said: str) -> None:
    warnings.warn(f"{path} {said}", MeshdepictWarning, stacklevel=4)


def _joined(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """Return the distinct positions by first appearance, and the (m, 3) faces of them."""
    label = same_position(corners) if len(corners) else None
    if label is None:
        return corners, np.arange(len(corners)).reshape(-1, 3)
    first = np.empty(label.max() + 1, np.int64)
    first[label[::-1]] = np.arange(len(label))[::-1]
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return corners[first[order]], rank[label].reshape(-1, 3)
