"""A PLY file taken apart: its elements, its vertices and its faces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.ply_binary import decode_binary
from meshdepict.io.ply_header import Element, Header
from meshdepict.io.ply_rows import Column, Ragged, as_ragged
from meshdepict.io.ply_text import decode_text
from meshdepict.shapes.document import Document
from meshdepict.surface.polygons import Polygons, as_polygons, strip_triangles

__all__ = [
    "POSITION",
    "PlyDocument",
    "Section",
    "geometry_of",
    "hold",
    "index_list",
    "line_end",
    "split_sections",
]

POSITION = ("x", "y", "z")


class Section(NamedTuple):
    """An element with its columns, and its rows as they stand in the file."""

    element: Element
    columns: dict[str, Column]
    rows: bytes | list[bytes]  # a list of lines in ASCII files


@dataclass(frozen=True, kw_only=True)
class PlyDocument(Document):
    """A whole PLY file."""

    header: Header
    data: bytes

    @property
    def texcoords(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
        """(t, 2) texture coordinates, and which of them each corner has (−1: none), or None."""
        face = split_sections(self.header, self.data)[0].get("face")
        if face is None or "texcoord" not in face.columns or not index_list(face):
            return None
        listed = as_ragged(face.columns["texcoord"])
        sizes = np.diff(as_ragged(face.columns[index_list(face)]).offsets)
        length = np.diff(listed.offsets)
        fitting = length == 2 * sizes
        values = listed.values[np.repeat(fitting, length)].astype(np.float64).reshape(-1, 2)
        corner = np.repeat(fitting, sizes)
        return values, np.where(corner, np.cumsum(corner) - 1, -1)

    def describes(self, vertices: NDArray[np.float64] | None, polygons: Polygons) -> bool:
        """Whether these are the file's vertices (if given) and polygons, not changed ones."""
        return hold(split_sections(self.header, self.data)[0], vertices, polygons)


def split_sections(header: Header, data: bytes) -> tuple[dict[str, Section], bytes]:
    """Read all elements; also return what follows the last one."""
    sections = {}
    if header.order:
        at = header.size
        for element in header.elements:
            columns, stop = decode_binary(data, at, element, header.order)
            sections[element.name] = Section(element, columns, data[at:stop])
            at = stop
        return sections, data[at:]
    lines = data[header.size :].split(line_end(header))
    lines = [line for line in lines if line and not line.isspace()]
    for element in header.elements:
        count = element.count if element.properties else 0
        rows, lines = lines[:count], lines[count:]
        sections[element.name] = Section(element, decode_text(rows, element), rows)
    return sections, line_end(header).join(lines)


def line_end(header: Header) -> bytes:
    """Return what the lines of an ASCII file end with (before it, a carriage return may stand)."""
    return b"\r" if header.newline == b"\r" else b"\n"


def hold(
    sections: Mapping[str, Section], vertices: NDArray[np.float64] | None, polygons: Polygons
) -> bool:
    """Whether a file's elements hold these vertices (if given) and polygons."""
    own_vertices, own_faces = geometry_of(sections)
    same = vertices is None or np.array_equal(vertices, own_vertices)
    return same and all(map(np.array_equal, as_polygons(own_faces), polygons))


def geometry_of(sections: Mapping[str, Section]) -> tuple[NDArray[Any], Any]:
    """Return positions, and faces in a form that `as_polygons` takes."""
    vertex = sections.get("vertex")
    if vertex is None or not set(POSITION) <= set(vertex.element.names):
        raise MeshdepictError("has no vertices with x, y and z in its PLY header")
    vertices = np.empty((vertex.element.count, 3))
    for axis, name in enumerate(POSITION):
        vertices[:, axis] = vertex.columns[name]
    parts: list[Column] = []
    for kind in ("face", "tristrips"):
        section = sections.get(kind)
        if section and section.element.count and (name := index_list(section)):
            rows = section.columns[name]
            strips = kind == "tristrips"
            parts.append(strip_triangles(_cut_strips(as_ragged(rows)))[0] if strips else rows)
    if len(parts) == 1 and not isinstance(parts[0], Ragged) and parts[0].shape[1] >= 3:
        return vertices, parts[0]
    ragged = [as_ragged(part) for part in parts]
    connectivity = np.concatenate([np.empty(0, np.int64), *(part.values for part in ragged)])
    sizes = np.concatenate([np.zeros(1, np.int64), *(np.diff(part.offsets) for part in ragged)])
    return vertices, Polygons(connectivity, np.cumsum(sizes))


def index_list(section: Section) -> str:
    """Return the name of the list that holds a face's corners, an empty one if there is none."""
    lists = [item for item in section.element.properties if item.count]
    named = [item.name for item in lists if item.name in ("vertex_indices", "vertex_index")]
    whole = [item.name for item in lists if item.kind[0] in "iu"]
    return (named + whole + [""])[0]


def _cut_strips(rows: Ragged) -> Polygons:
    """Cut strips where a row or an index of −1 ends them."""
    row = np.repeat(np.arange(len(rows.offsets) - 1), np.diff(rows.offsets))
    real = rows.values >= 0
    strip = row + np.cumsum(~real)
    sizes = np.bincount(strip[real])
    return Polygons(rows.values[real].astype(np.int64), np.concatenate(([0], np.cumsum(sizes))))
