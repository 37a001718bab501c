"""STL, binary and ASCII: triangles without shared vertices, joined where positions are equal."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io import text
from meshdepict.shapes.document import Contents, Document
from meshdepict.surface.welding import same_position

__all__ = ["decode", "provenance"]

_HEADER = 84  # bytes: 80 of text and the number of triangles
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"(?im)^\s*vertex\s+(\S+\s+\S+\s+\S+)\s*$")


def decode(data: bytes, path: Path) -> Contents:
    """Read a mesh whose vertices are the distinct positions, in the order of their appearance.

    Raises
    ------
    MeshdepictError
        For a file that is cut off.
    """
    count = int.from_bytes(data[80:_HEADER], "little") if len(data) >= _HEADER else 0
    whole = _HEADER + count * _TRIANGLE.itemsize
    if len(data) != whole and re.match(rb"(?i)\s*solid\b", data):
        corners = _ascii_corners(data)
    elif len(data) < max(whole, _HEADER):
        raise MeshdepictError(
            f"is cut off or no STL: {whole:,} bytes are due, but {len(data):,} are there"
        )
    else:
        corners = np.frombuffer(data, _TRIANGLE, count, _HEADER)["corners"].reshape(-1, 3)
    vertices, faces = _joined(corners.astype(np.float64))
    return Contents(vertices, faces, {}, Document())


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return nothing: this program writes no STL."""
    return ()


def _ascii_corners(data: bytes) -> NDArray[np.float64]:
    found = _VERTEX.findall(data)
    facets = len(re.findall(rb"(?im)^\s*facet\b", data))
    if len(found) != 3 * facets or not re.search(rb"(?i)endsolid", data[-1000:]):
        raise MeshdepictError(
            f"is cut off or wrong as ASCII STL: {facets:,} facets with {len(found):,} corners"
            f"{'' if b'endsolid' in data.lower() else ', no endsolid'}"
        )
    try:
        return text.floats(b" ".join(found)).reshape(-1, 3)
    except ValueError:
        raise MeshdepictError("has an ASCII STL vertex that is not three numbers") from None


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
