"""The textures of a PLY file: pictures named in comments, coordinates in one of four places."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshdepict.files.companions import Companions
from meshdepict.io.ply_header import Header
from meshdepict.io.ply_rows import Column, Section, as_ragged
from meshdepict.io.texture_files import file_fault, named_texture, texture_notes
from meshdepict.shapes.textures import Textures, laid_textures
from meshdepict.surface.polygons import Polygons

__all__ = [
    "COORDINATES", "COORDINATE_ELEMENTS", "has_coordinates", "picture_names", "ply_notes",
    "ply_textures", "renamed_pictures", "with_pictures",
]  # fmt: skip

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_COMMENT = re.compile(rb"(?mi)^[ \t]*comment[ \t]+TextureFile[ \t]+([^\r\n]*[^\r\n\s])")
_PAIRS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))  # of vertices
_REPEAT = ("repeat", "repeat")

COORDINATES = {
    "vertex": tuple(name for pair in _PAIRS for name in pair),
    "face": ("texcoord", "texnumber"),
}
"""Properties of elements that say where pictures lie, and which ones."""

_MULTI = ("multi_texture_vertex", "multi_texture_face")

COORDINATE_ELEMENTS = (*_MULTI, "corner")
"""Elements that hold nothing else."""


def picture_names(header: Header) -> list[str]:
    """Return the pictures that a header names, in order."""
    return [_text(match[1]) for match in _COMMENT.finditer(b"".join(header.lines))]


def _text(word: bytes) -> str:
    name = word.decode("utf-8", "surrogateescape")
    quoted = len(name) > 2 and name[0] == name[-1] == '"'
    return name[1:-1] if quoted else name


def has_coordinates(header: Header) -> bool:
    """Whether a file has texture coordinates, of whatever kind."""
    names = {element.name: set(element.names) for element in header.elements if element.count}
    return (
        "texcoord" in names.get("face", ())
        or all(name in names for name in _MULTI)
        or {"s", "t"} <= names.get("corner", set())
        or any(set(pair) <= names.get("vertex", set()) for pair in _PAIRS)
    )


def ply_notes(header: Header, folder: Path) -> list[str]:
    """Say what is wrong with the pictures that a header names; the file is the subject."""
    names = picture_names(header)
    said = texture_notes([file_fault(folder, name) for name in names])
    if names and not has_coordinates(header):
        said.append("names textures, but holds no texture coordinates: they are not shown")
    return said


def ply_textures(
    header: Header,
    sections: Mapping[str, Section],
    listed: tuple[Floats, Ints] | None,
    polygons: Polygons,
    folder: Path,
    corners: Ints,
) -> Textures | None:
    """Return what a PLY file lays on its triangles, or None.

    Parameters
    ----------
    header : Header
    sections : mapping of Section
    listed : (t, 2) and (c,) arrays, or None
        Coordinates of corners as lists hold them, and which of them each corner has.
    polygons : Polygons
        Of the file.
    folder : Path
        Of the file.
    corners : (m, 3) array
        The polygons' corners that those of the triangles are.
    """
    names = picture_names(header)
    if not names:
        return None
    count = len(polygons.offsets) - 1
    number = np.zeros(count, np.int64)
    of_faces = sections["face"].columns.get("texnumber") if "face" in sections else None
    if isinstance(of_faces, np.ndarray) and of_faces.shape == (count,):
        number = of_faces.astype(np.int64)
    uv = None
    if listed is not None:
        texcoords, corner = listed
        uv = np.where(corner[:, None] >= 0, texcoords[corner], np.nan)
    elif all(name in sections for name in _MULTI):
        uv, number = _of_multi(sections, polygons)
    else:
        uv = _of_vertices(sections["vertex"].columns, polygons)
    if uv is None:
        return None
    owner = np.searchsorted(polygons.offsets, corners[:, 0], side="right") - 1
    k = len(names)
    return laid_textures(
        uv[corners], number[owner], [named_texture(folder, name, _REPEAT) for name in names],
        np.ones((k, 4)), [None] * k, np.ones(k),
    )  # fmt: skip


def _of_vertices(columns: Mapping[str, Column], polygons: Polygons) -> Floats | None:
    for pair in _PAIRS:
        each = [columns.get(name) for name in pair]
        if all(isinstance(values, np.ndarray) and values.ndim == 1 for values in each):
            uv = np.stack(each, axis=1).astype(np.float64)  # type: ignore[arg-type]
            return np.asarray(uv[polygons.connectivity])
    return None


def _of_multi(sections: Mapping[str, Section], polygons: Polygons) -> tuple[Floats | None, Ints]:
    """Return coordinates of all corners and pictures of all faces, kept in elements of their own.

    ``tn`` is the face that a row is about; without it, rows follow the faces.
    """
    vertex, face = (sections[name].columns for name in _MULTI)
    count = len(polygons.offsets) - 1
    number = np.full(count, -1, np.int64)
    u, v, lists = vertex.get("u"), vertex.get("v"), face.get("texture_vertex_indices")
    if not isinstance(u, np.ndarray) or not isinstance(v, np.ndarray) or lists is None:
        return None, number
    table = np.stack([u, v], axis=1).astype(np.float64)
    rows = as_ragged(lists)
    length = np.diff(rows.offsets)
    about = face.get("tn")
    where = np.arange(len(length)) if not isinstance(about, np.ndarray) else about.astype(np.int64)
    known = (where >= 0) & (where < count)
    sizes = np.diff(polygons.offsets)
    known[known] = sizes[where[known]] == length[known]
    picture = face.get("tx")
    number[where[known]] = picture.astype(np.int64)[known] if isinstance(picture, np.ndarray) else 0
    uv = np.full((len(polygons.connectivity), 2), np.nan)
    chosen = np.repeat(known, length)
    index = rows.values[chosen].astype(np.int64)
    step = np.arange(len(rows.values)) - np.repeat(rows.offsets[:-1], length)
    place = (polygons.offsets[np.where(known, where, 0)].repeat(length) + step)[chosen]
    inside = (index >= 0) & (index < len(table))
    uv[place[inside]] = table[index[inside]]
    return uv, number


def renamed_pictures(text: bytes, name: str) -> bytes:
    """Return a header's text that names one picture wherever it named any."""

    def edit(match: re.Match[bytes]) -> bytes:
        return match[0][: match.start(1) - match.start(0)] + name.encode()

    return _COMMENT.sub(edit, text)


def with_pictures(text: bytes, header: Header, folder: Path, companions: Companions) -> bytes:
    """Let the pictures that a header names come along; return its text naming them."""
    called = {name: companions.copied(folder, name) for name in picture_names(header)}

    def edit(match: re.Match[bytes]) -> bytes:
        name = _text(match[1])
        new = called.get(name, name)
        if new in (name, Path(name).as_posix(), name.replace("\\", "/")):
            return match[0]
        start = match[0][: match.start(1) - match.start(0)]
        return start + new.encode("utf-8", "surrogateescape")

    return _COMMENT.sub(edit, text)
