"""PLY with a texture as MeshLab writes it: a list of coordinates in every face, and a comment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, BinaryIO

from meshdepict.io.ply_binary import encode_binary
from meshdepict.io.ply_header import POSITION, Element, Property, fresh_header
from meshdepict.io.ply_properties import as_properties, exact_float
from meshdepict.io.ply_rows import Column

if TYPE_CHECKING:
    from meshdepict.shapes.document import Saving
    from meshdepict.shapes.mesh import Mesh

__all__ = ["encode_textured"]


def encode_textured(file: BinaryIO, mesh: Mesh, saving: Saving, picture: str) -> None:
    """Write a new file that names a picture; see `textured.write_textured`.

    Polygons become the triangles that are shaded: readers take no coordinates of others.
    """
    assert mesh.texcoords is not None
    extra, columns = as_properties(mesh.attributes["vertex"], taken=POSITION)
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
        "face",
        len(mesh.faces),
        (Property("vertex_indices", "i4", "u1"), Property("texcoord", "f4", "u1"), *extra),
    )
    tables: list[tuple[Element, Mapping[str, Column]]] = [
        (vertex, dict(zip(POSITION, mesh.vertices.T, strict=True)) | columns),
        (face, lists | more),
    ]
    comments = (*saving.comments, f"TextureFile {picture}")
    file.write(fresh_header([element for element, _ in tables], comments))
    for element, held in tables:
        file.write(encode_binary(element, held, "<").data)
