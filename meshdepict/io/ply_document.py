"""A PLY file taken apart: its elements, its vertices and its faces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers
from meshdepict.io.ply_binary import decode_binary
from meshdepict.io.ply_grid import grid_of, grid_triangles
from meshdepict.io.ply_header import POSITION, Element, Header
from meshdepict.io.ply_rows import Column, Ragged, Section, as_ragged
from meshdepict.io.ply_text import decode_text, reflowed
from meshdepict.io.ply_textures import has_coordinates, picture_names, ply_textures
from meshdepict.shapes.document import Document, same_vertices
from meshdepict.shapes.textures import Textures
from meshdepict.surface.polygons import Polygons, as_polygons, strip_triangles, whole_numbers

__all__ = [
    "PlyDocument",
    "geometry_of",
    "hold",
    "index_list",
    "is_grid",
    "line_end",
    "split_sections",
]


@dataclass(frozen=True, kw_only=True)
class PlyDocument(Document):
    """A whole PLY file."""

    header: Header
    data: bytes
    folder: Path
    formats: tuple[str, ...] = (".ply",)

    @property
    def is_textured(self) -> bool:
        """Whether the file names pictures, and has coordinates in them."""
        return bool(picture_names(self.header)) and has_coordinates(self.header)

    @any_numbers()
    def textures(self, corners: NDArray[np.int64]) -> Textures | None:
        """Return what the file lays on its triangles, or None."""
        if not self.is_textured or self.has_strips:
            return None
        sections = split_sections(self.header, self.data)[0]
        polygons = as_polygons(geometry_of(self.header, sections)[1])
        return ply_textures(self.header, sections, self.texcoords, polygons, self.folder, corners)

    @property
    @any_numbers()
    def texcoords(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
        """(t, 2) texture coordinates, and which of them each corner has (−1: none), or None."""
        sections = split_sections(self.header, self.data)[0]
        face = sections.get("face")
        if face is None or not index_list(face):
            return None
        corners = sections.get("corner")
        if corners is not None and {"s", "t"} <= set(corners.columns):
            return _of_corners(corners, len(as_ragged(face.columns[index_list(face)]).values))
        if "texcoord" not in face.columns:
            return None
        listed = as_ragged(face.columns["texcoord"])
        sizes = np.diff(as_ragged(face.columns[index_list(face)]).offsets)
        length = np.diff(listed.offsets)
        fitting = length == 2 * sizes
        values = listed.values[np.repeat(fitting, length)].astype(np.float64).reshape(-1, 2)
        corner = np.repeat(fitting, sizes)
        return values, np.where(corner, np.cumsum(corner) - 1, -1)

    @property
    def has_strips(self) -> bool:
        """Whether triangle strips are among the file's faces."""
        return any(item.name == "tristrips" and item.count for item in self.header.elements)

    @any_numbers()
    def describes(self, vertices: NDArray[np.float64] | None, polygons: Polygons) -> bool:
        """Whether these are the file's vertices (if given) and polygons, not changed ones."""
        sections = split_sections(self.header, self.data)[0]
        return hold(self.header, sections, vertices, polygons)


def _of_corners(
    corner: Section, count: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Return the coordinates of an element that has a row for each corner of the faces."""
    if corner.element.count != count:
        return None
    values = np.stack([corner.columns[name] for name in ("s", "t")], axis=1).astype(np.float64)
    known = np.isfinite(values).all(axis=1)
    if not known.any():
        return None
    return values[known], np.where(known, np.cumsum(known) - 1, -1)


def split_sections(header: Header, data: bytes) -> tuple[dict[str, Section], bytes]:
    """Read all elements; also return what follows the last one."""
    sections: dict[str, Section] = {}
    if header.order:
        at = header.size
        for element in header.elements:
            columns, stop = decode_binary(data, at, element, header.order)
            sections[element.name] = Section(element, columns, data[at:stop], {})
            at = stop
        return sections, data[at:]
    lines = data[header.size :].split(line_end(header))
    lines = [line for line in lines if line and not line.isspace()]
    counts = [element.count if element.properties else 0 for element in header.elements]
    ends = list(accumulate(counts))
    try:
        for element, count, end in zip(header.elements, counts, ends, strict=True):
            rows = lines[end - count : end]
            sections[element.name] = Section(element, *_with(rows, element))
    except MeshdepictError:
        if not ends or len(lines) == ends[-1]:
            raise
        # Not a row for each line: some programs break lines anywhere.
        parts = reflowed(b" ".join(lines).split(), header.elements)
        if parts is None:
            raise
        for element, rows in zip(header.elements, parts, strict=True):
            sections[element.name] = Section(element, *_with(rows, element))
        return sections, b""
    return sections, line_end(header).join(lines[ends[-1] if ends else 0 :])


def _with(
    rows: list[bytes], element: Element
) -> tuple[dict[str, Column], list[bytes], dict[str, str]]:
    columns, odd = decode_text(rows, element)
    return columns, rows, odd


def line_end(header: Header) -> bytes:
    """Return what the lines of an ASCII file end with (before it, a carriage return may stand)."""
    return b"\r" if header.newline == b"\r" else b"\n"


def hold(
    header: Header,
    sections: Mapping[str, Section],
    vertices: NDArray[np.float64] | None,
    polygons: Polygons,
) -> bool:
    """Whether a file's elements hold these vertices (if given) and polygons."""
    own_vertices, own_faces = geometry_of(header, sections)
    return same_vertices(vertices, own_vertices) and all(
        map(np.array_equal, as_polygons(own_faces), polygons)
    )


def geometry_of(header: Header, sections: Mapping[str, Section]) -> tuple[NDArray[Any], Any]:
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
    if not parts and is_grid(sections):
        grid = sections["range_grid"]
        lists = as_ragged(grid.columns[index_list(grid)])
        parts.append(grid_triangles(vertices, grid_of(header, lists)))
    if len(parts) == 1 and not isinstance(parts[0], Ragged) and parts[0].shape[1] >= 3:
        return vertices, parts[0]
    ragged = [as_ragged(part) for part in parts]
    connectivity = np.concatenate([np.empty(0, np.int64), *(part.values for part in ragged)])
    sizes = np.concatenate([np.zeros(1, np.int64), *(np.diff(part.offsets) for part in ragged)])
    return vertices, Polygons(connectivity, np.cumsum(sizes))


def is_grid(sections: Mapping[str, Section]) -> bool:
    """Whether a file has a range grid and no faces."""
    faces = any(sections[kind].element.count for kind in ("face", "tristrips") if kind in sections)
    grid = sections.get("range_grid")
    return bool(not faces and grid and grid.element.count and index_list(grid))


def index_list(section: Section) -> str:
    """Return the name of the list that holds a face's corners, an empty one if there is none."""
    lists = [item for item in section.element.properties if item.count]
    named = [item.name for item in lists if item.name in ("vertex_indices", "vertex_index")]
    whole = [item.name for item in lists if item.kind[0] in "iu"]
    return (named + whole + [""])[0]


def _cut_strips(rows: Ragged) -> Polygons:
    """Cut strips where a row or an index of −1 ends them."""
    row = np.repeat(np.arange(len(rows.offsets) - 1), np.diff(rows.offsets))
    values = whole_numbers(rows.values)
    real = values >= 0
    strip = row + np.cumsum(~real)
    sizes = np.bincount(strip[real])
    return Polygons(values[real], np.concatenate(([0], np.cumsum(sizes))))
