"""PLY: every value of every element survives, in the file's own encoding."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictWarning
from meshdepict.io.ply_binary import encode_binary
from meshdepict.io.ply_document import (
    PlyDocument,
    geometry_of,
    hold,
    index_list,
    is_grid,
    line_end,
    split_sections,
)
from meshdepict.io.ply_header import (
    POSITION,
    Element,
    Header,
    Property,
    fresh_header,
    parse_header,
    read_header,
)
from meshdepict.io.ply_properties import as_properties, exact_float
from meshdepict.io.ply_rows import Column, Ragged, Section
from meshdepict.io.ply_text import encode_text, rewrite_text
from meshdepict.io.ply_textures import ply_notes, with_pictures
from meshdepict.shapes.document import COLOR, Contents, Document, Saving, new_names, recolored
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["decode", "edited_rows", "encode", "provenance"]


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return the lines that this program wrote, reading little more than the header."""
    return read_header(file).provenance


# --- reading ----------------------------------------------------------------------------------


def decode(data: bytes, path: Path) -> Contents:
    """Read a mesh with all its vertex and face properties.

    Raises
    ------
    MeshdepictError
        For a wrong header, data that contradict it or end early, and for missing positions.
    """
    header = parse_header(data)
    sections, rest = split_sections(header, data)
    vertices, faces = geometry_of(header, sections)
    said = [*_notes(sections, rest), *ply_notes(header, path.parent)]
    if said:
        warnings.warn(f"{path} {'; '.join(said)}", MeshdepictWarning, stacklevel=2)
    attributes = {"vertex": _attributes(sections["vertex"], POSITION)}
    if "face" in sections and "tristrips" not in sections:
        # Texture coordinates belong to corners: they stay with the document.
        corners = (index_list(sections["face"]), "texcoord")
        attributes["face"] = _attributes(sections["face"], corners)
    document = PlyDocument(
        provenance=header.provenance, header=header, data=data, folder=path.parent
    )
    return Contents(vertices, faces, attributes, document)


def _notes(sections: Mapping[str, Section], rest: bytes) -> Iterator[str]:
    """Yield what is odd about a file, its name being the subject."""
    if rest.strip():
        yield "goes on after what its PLY header declares; the rest is kept but not read"
    if is_grid(sections):
        yield "holds a range grid: neighbours in it make its triangles"
    for name, section in sections.items():
        for item, word in section.odd.items():
            done = "taken as NaN" if item in section.columns else "kept but not read"
            yield f"has {word!r} for a number in {item!r} of {name}: {done}"


def _attributes(section: Section, without: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    return {
        name: column.astype(column.dtype.newbyteorder("="), copy=False)
        for name, column in section.columns.items()
        if name not in without and not isinstance(column, Ragged)
    }


# --- writing ----------------------------------------------------------------------------------


def encode(file: BinaryIO, mesh: Mesh, saving: Saving) -> None:
    """Write a mesh: the file that it was read from with new colours, or a new file."""
    polygons = mesh.polygons or as_polygons(mesh.faces)
    document = mesh.document
    if isinstance(document, PlyDocument):
        sections, rest = split_sections(document.header, document.data)
        if hold(document.header, sections, mesh.vertices, polygons):
            _write_edited(file, mesh, saving, document, sections)
            file.write(rest)
            return
    _write_fresh(file, mesh, polygons, saving)


def _write_edited(
    file: BinaryIO,
    mesh: Mesh,
    saving: Saving,
    document: PlyDocument,
    sections: Mapping[str, Section],
) -> None:
    """Write the file as it was, except what gets another name, goes or comes."""
    header = document.header
    edited: dict[str, list[Property]] = {}
    rows: list[Any] = []
    for name, section in sections.items():
        element = section.element
        names = {old: old for old in element.names}
        colors: dict[str, Any] = {}
        if name == "vertex" and saving.colors is not None:
            ours = document.is_recolored
            names = new_names(element.names, ours=ours, keep=saving.keep_colors)
            colors = dict(zip(COLOR, saving.colors.T, strict=True))
        added = {
            key: values
            for key, values in mesh.attributes.get(name, {}).items()
            if key not in element.names and len(values) == element.count
        } | colors
        if added:
            edited[name], changed = edited_rows(section, names, added, header)
            rows.append(changed)
        else:
            rows.append(section.rows)
    comments = saving.comments if saving.comments or saving.colors is not None else None
    top = header.rewritten(edited, comments)
    if saving.companions is not None:
        top = with_pictures(top, header, document.folder, saving.companions)
    file.write(top)
    for part in rows:
        if isinstance(part, list):
            file.writelines(line + line_end(header) for line in part)
        else:
            file.write(part)


def edited_rows(
    section: Section, names: Mapping[str, str], added: Mapping[str, Any], header: Header
) -> tuple[list[Property], Any]:
    """Return an element's properties under their new names with new ones, and its rows."""
    element = section.element
    kept = [item for item in element.properties if item.name in names]
    fresh, columns = as_properties(added, taken=set(names.values()))
    properties = [replace(item, name=names[item.name]) for item in kept] + fresh
    if isinstance(section.rows, list):
        return properties, rewrite_text(section.rows, element, names, list(columns.values()))
    changed = Element(element.name, element.count, tuple(properties))
    unchanged = {names[item.name]: section.columns[item.name] for item in kept}
    return properties, encode_binary(changed, unchanged | columns, header.order).data


def _write_fresh(file: BinaryIO, mesh: Mesh, polygons: Polygons, saving: Saving) -> None:
    """Write a new file that every reader we know of reads.

    Binary and little-endian where all polygons have as many corners; else ASCII, because trimesh
    refuses binary lists of several lengths. Texture coordinates are an element "corner" with a row
    for each corner of the faces, NaN where it has none, which readers skip: as a second list of the
    faces they part colours from vertices (trimesh) and are refused, or end the program, with
    other polygons than triangles (PyMeshLab, PyVista).
    """
    document = mesh.document if isinstance(mesh.document, Document) else Document()
    attributes = recolored(mesh.attributes["vertex"], saving, ours=document.is_recolored)
    extra, columns = as_properties(attributes, taken=POSITION)
    kind = exact_float(mesh.vertices)
    properties = [*(Property(name, kind) for name in POSITION), *extra]
    vertex = Element("vertex", len(mesh.vertices), tuple(properties))
    tables: list[tuple[Element, Mapping[str, Column]]] = [
        (vertex, dict(zip(POSITION, mesh.vertices.T, strict=True)) | columns)
    ]
    sizes = np.diff(polygons.offsets)
    largest = int(sizes.max())
    even = bool((sizes == largest).all())
    properties = [Property("vertex_indices", "i4", "u1" if largest < 256 else "i4")]
    lists: dict[str, Column] = {"vertex_indices": Ragged(*polygons)}
    if even:
        lists["vertex_indices"] = polygons.connectivity.reshape(-1, largest)
    corners = None
    if (own := document.texcoords) and document.describes(None, polygons):
        texcoords, corner = own
        items = tuple(Property(name, exact_float(texcoords)) for name in ("s", "t"))
        corners = Element("corner", len(corner), items)
        rows = np.where(corner[:, None] >= 0, texcoords[corner], np.nan)
    extra, more = as_properties(mesh.attributes["face"], taken=lists)
    face = Element("face", len(polygons.offsets) - 1, (*properties, *extra))
    tables.append((face, lists | more))
    if corners is not None:
        tables.append((corners, dict(zip(("s", "t"), rows.T, strict=True))))

    file.write(fresh_header([element for element, _ in tables], saving.comments, in_words=not even))
    for element, held in tables:
        if even:
            file.write(encode_binary(element, held, "<").data)
        else:
            file.write(encode_text(element, held))
