"""PLY with a baked texture: a new file, or the one that was read with other coordinates.

Coordinates are a list in every face, and a comment names the picture, as MeshLab writes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.io.ply import edited_rows
from meshdepict.io.ply_binary import encode_binary
from meshdepict.io.ply_document import (
    PlyDocument,
    hold,
    index_list,
    is_grid,
    line_end,
    split_sections,
)
from meshdepict.io.ply_header import POSITION, Element, Header, Property, fresh_header
from meshdepict.io.ply_properties import as_properties, exact_float
from meshdepict.io.ply_rows import Column, Ragged, Section, as_ragged
from meshdepict.io.ply_text import encode_text
from meshdepict.io.ply_textures import (
    COORDINATE_ELEMENTS,
    COORDINATES,
    picture_names,
    renamed_pictures,
)
from meshdepict.shapes.document import Document, restored_names
from meshdepict.shapes.own_texcoords import file_texcoords
from meshdepict.surface.polygons import as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.document import Saving
    from meshdepict.shapes.mesh import Mesh

__all__ = ["encode_textured_ply"]

Ints = NDArray[np.int64]

_TEXCOORD = Property("texcoord", "f4", "u1")


def encode_textured_ply(
    file: BinaryIO, mesh: Mesh, given: Mesh, saving: Saving, picture: str
) -> None:
    """Write a mesh that names a picture; see `textured.write_textured`.

    Where other coordinates are written, polygons become the triangles that are shaded: readers take
    no coordinates of others.

    Parameters
    ----------
    file, saving
        As for every format.
    mesh : Mesh
        With the texture.
    given : Mesh
        As it was read: the same triangles. Where it came from a PLY file all else of that stays.
    picture : str
        What the picture is called.
    """
    document = given.document
    if isinstance(document, PlyDocument) and not document.has_strips:
        header = document.header
        sections, rest = split_sections(header, document.data)
        polygons = given.polygons or as_polygons(given.faces)
        if not is_grid(sections) and hold(header, sections, given.vertices, polygons):
            _write_kept(file, mesh, given, document, sections, saving.comments, picture)
            file.write(rest)
            return
    _write_fresh(file, mesh, saving, picture)


def _write_fresh(file: BinaryIO, mesh: Mesh, saving: Saving, picture: str) -> None:
    assert mesh.texcoords is not None
    document, known = mesh.document, mesh.attributes["vertex"]
    if isinstance(document, Document) and document.is_recolored:
        known = {new: known[old] for old, new in restored_names(known).items()}
    extra, columns = as_properties(known, taken=POSITION)
    kind = exact_float(mesh.vertices)
    vertex = Element(
        "vertex", len(mesh.vertices), (*(Property(name, kind) for name in POSITION), *extra)
    )
    lists: dict[str, Column] = {
        "vertex_indices": mesh.faces,
        "texcoord": mesh.texcoords.reshape(-1, 6),
    }
    face_data = mesh.attributes["face"] if mesh.polygons is None else {}
    extra, more = as_properties(face_data, taken=lists)
    face = Element(
        "face", len(mesh.faces), (Property("vertex_indices", "i4", "u1"), _TEXCOORD, *extra)
    )
    tables: list[tuple[Element, Mapping[str, Column]]] = [
        (vertex, dict(zip(POSITION, mesh.vertices.T, strict=True)) | columns),
        (face, lists | more),
    ]
    comments = (*saving.comments, f"TextureFile {picture}")
    file.write(fresh_header([element for element, _ in tables], comments))
    for element, held in tables:
        file.write(encode_binary(element, held, "<").data)


# --- the file that was read ---------------------------------------------------------------------


def _write_kept(
    file: BinaryIO, mesh: Mesh, given: Mesh, document: PlyDocument,
    sections: Mapping[str, Section], comments: tuple[str, ...], picture: str,
) -> None:  # fmt: skip
    """Write all of the file but for coordinates that change, and a former bake's colours."""
    header = document.header
    laid = document.textures(given.triangle_corners)
    own = file_texcoords(given) if laid is None else laid.texcoords
    same = own is not None and np.array_equal(own, np.asarray(mesh.texcoords))
    edited: dict[str, list[Property]] = {}
    counts = {} if same else {b"face": len(mesh.faces)} | dict.fromkeys(_ELEMENTS, 0)
    rows: list[Any] = []
    for name, section in sections.items():
        if name.encode() in counts and name != "face":
            continue
        there = section.element.names
        names = {old: old for old in there if same or old not in COORDINATES.get(name, ())}
        if name == "vertex" and document.is_recolored:
            names = restored_names(names)
        added = {
            key: values
            for key, values in given.attributes.get(name, {}).items()
            if key not in there and len(values) == section.element.count
        }
        if name == "face" and not same:
            edited[name], part = _triangles(section, names, added, mesh, given, header)
        elif added or names != {old: old for old in there}:
            edited[name], part = edited_rows(section, names, added, header)
        else:
            part = section.rows
        rows.append(part)
    if not picture_names(header):
        comments = (*comments, f"TextureFile {picture}")
    top = renamed_pictures(header.rewritten(edited, comments), picture)
    file.write(b"".join(_recounted(top, counts, header.newline)))
    for part in rows:
        if isinstance(part, list):
            file.writelines(line + line_end(header) for line in part)
        else:
            file.write(part)


_ELEMENTS = [name.encode() for name in COORDINATE_ELEMENTS]


def _triangles(
    section: Section, names: Mapping[str, str], added: Mapping[str, Any], mesh: Mesh, given: Mesh,
    header: Header,
) -> tuple[list[Property], Any]:  # fmt: skip
    """Return the properties of triangles in place of polygons, and their rows."""
    polygons = given.polygons or as_polygons(given.faces)
    first = given.triangle_corners[:, 0]
    owner = np.searchsorted(polygons.offsets, first, side="right") - 1
    items = [item for item in section.element.properties if item.name in names]
    items = [item for item in items if item.name in section.columns]
    columns = {item.name: _of_rows(section.columns[item.name], owner) for item in items}
    columns[index_list(section)] = mesh.faces
    fresh, more = as_properties(
        {name: values[owner] for name, values in added.items()}, taken={*columns, "texcoord"}
    )
    assert mesh.texcoords is not None
    columns |= more | {"texcoord": mesh.texcoords.reshape(-1, 6)}
    properties = [*items, *fresh, _TEXCOORD]
    element = Element("face", len(mesh.faces), tuple(properties))
    if header.order:
        return properties, encode_binary(element, columns, header.order).data
    return properties, encode_text(element, columns).splitlines()


def _of_rows(column: Column, rows: Ints) -> Column:
    """Return some rows of a column."""
    if not isinstance(column, Ragged):
        return column[rows]
    values, offsets = as_ragged(column)
    sizes = np.diff(offsets)[rows]
    ends = np.cumsum(sizes)
    step = np.arange(int(sizes.sum())) - np.repeat(ends - sizes, sizes)
    return Ragged(values[np.repeat(offsets[rows], sizes) + step], np.concatenate(([0], ends)))


def _recounted(top: bytes, counts: Mapping[bytes, int], newline: bytes) -> Iterator[bytes]:
    """Yield the lines of a header with other numbers of rows; an element without any goes."""
    gone = False
    for line in top.splitlines(keepends=True):
        keyword, *words = line.split() or [b""]
        if keyword == b"element":
            count = counts.get(words[0], -1)
            gone = count == 0
            if count > 0:
                line = b"element %s %d" % (words[0], count) + newline
        if not (gone and keyword in (b"element", b"property")):
            yield line
