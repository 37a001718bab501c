"""OBJ: vertices, polygons and texture coordinates; other lines are kept as they are."""

from __future__ import annotations

import io
import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.any_numbers import any_numbers
from meshdepict.files.mark import MARK
from meshdepict.io import text
from meshdepict.io.obj_faces import parse_faces, parse_normals
from meshdepict.io.obj_lines import Lines, joined, line_end, table
from meshdepict.io.obj_materials import libraries, with_companions
from meshdepict.io.obj_textures import library_faults, obj_textures, texture_faults
from meshdepict.io.texture_files import texture_notes
from meshdepict.shapes.colors import after_position
from meshdepict.shapes.document import (
    COLOR,
    Contents,
    Document,
    Saving,
    as_bytes,
    only_colors,
    same_vertices,
)
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["ObjDocument", "decode", "encode", "provenance", "vertex_rows", "without_provenance"]

_COMMENT = f"# {MARK}".encode()
# Rounded up: some programs cut off what is behind the point when they make bytes of them again.
_FRACTIONS = [f"{math.ceil(level * 1e6 / 255) / 1e6:.6f}" for level in range(256)]


@dataclass(frozen=True, kw_only=True)
class ObjDocument(Document):
    """A whole OBJ file, what was read from it, and which texture coordinate each corner has."""

    data: bytes
    vertices: NDArray[np.float64]
    polygons: Polygons
    texture: NDArray[np.float64]
    corners: NDArray[np.int64]
    folder: Path
    formats: tuple[str, ...] = (".obj",)

    @property
    def texcoords(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
        """(t, 2) texture coordinates, and which of them each corner has (−1: none), or None."""
        return (self.texture, self.corners) if len(self.texture) else None

    @property
    def own_normals(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
        """(t, 3) normals, and which of them each corner has (−1: none), or None."""
        lines = Lines(self.data)
        normals = table(lines, b"vn", least=3)[:, :3]
        if not len(normals):
            return None
        corner = parse_normals(lines.bodies(b"f"), lambda: lines.before(b"f", b"vn"))
        return normals, np.where((corner >= 0) & (corner < len(normals)), corner, -1)

    @property
    def extras(self) -> tuple[str, ...]:
        """What the file holds that no other format keeps."""
        return ("materials and textures",) if self.is_textured else ()

    @property
    def is_textured(self) -> bool:
        """Whether a material of the file's libraries has a picture, and its faces coordinates."""
        if not len(self.texture) or b"mtllib" not in self.data:
            return False
        held = (library.materials.values() for library in libraries(self.data, self.folder))
        return any(m.base or m.normal or m.bump for materials in held for m in materials)

    @property
    def lacks(self) -> str:
        """The first library that can't be had, as a clause."""
        faults = library_faults(libraries(self.data, self.folder))
        return faults[0] if faults else ""

    @any_numbers()
    def textures(self, corners: NDArray[np.int64]) -> Textures | None:
        """Return what the file lays on its triangles, or None."""
        if not self.is_textured:
            return None
        owner = np.searchsorted(self.polygons.offsets, corners[:, 0], side="right") - 1
        return obj_textures(self.data, self.folder, self.texture, self.corners[corners], owner)

    def describes(self, vertices: NDArray[np.float64] | None, polygons: Polygons) -> bool:
        """Whether these are the file's vertices (if given) and polygons, not changed ones."""
        same = same_vertices(vertices, self.vertices)
        return same and all(map(np.array_equal, self.polygons, polygons))


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return the comments that this program wrote at the top."""
    found = []
    for line in file:
        if not line.startswith(_COMMENT):
            break
        found.append(line[2:].decode("utf-8", "replace").rstrip())
    return tuple(found)


# --- reading ----------------------------------------------------------------------------------


def decode(data: bytes, path: Path) -> Contents:
    """Read a mesh whose vertices are the file's ``v`` lines, whatever its faces share.

    Raises
    ------
    MeshdepictError
        For a file without vertices, and for a line that is not understood.
    """
    lines = Lines(data)
    numbers = table(lines, b"v", least=3)
    if not len(numbers):
        raise MeshdepictError("holds no vertices: no line of it begins with 'v'")
    polygons, of_texture = parse_faces(
        lines.bodies(b"f"),
        lambda: lines.before(b"f", b"v"),
        lambda: lines.before(b"f", b"vt"),
    )
    texture = table(lines, b"vt", least=1)
    texture = np.concatenate((texture, np.zeros_like(texture)), axis=1)[:, :2]  # v is 0 by default
    proper = np.asarray(np.isfinite(texture).all(axis=1))
    texture[~proper] = 0
    colors = after_position(numbers[:, 3:], w_first=True)
    attributes = {}
    if colors is not None:
        attributes["vertex"] = dict(zip((*COLOR, "alpha"), as_bytes(colors).T, strict=False))
    document = ObjDocument(
        provenance=provenance(io.BytesIO(data)),
        data=data,
        vertices=numbers[:, :3],
        polygons=polygons,
        texture=texture,
        corners=_known(of_texture, proper),
        folder=path.parent,
    )
    if b"mtllib" in data and (notes := _texture_notes(document)):
        warnings.warn(f"{path} {'; '.join(notes)}", MeshdepictWarning, stacklevel=2)
    return Contents(numbers[:, :3], polygons, attributes, document)


def _known(index: NDArray[np.int64], proper: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return −1 in place of indices of coordinates that are none, or that there aren't.

    That is a fault of the texture, not of the shape.
    """
    inside = (index >= 0) & (index < len(proper))
    inside[inside] = proper[index[inside]]
    return np.where(inside, index, -1)


def _texture_notes(document: ObjDocument) -> list[str]:
    """Say what is wrong with the pictures that the file's materials name."""
    found = libraries(document.data, document.folder)
    notes = texture_notes(texture_faults(found, document.folder))
    if not len(document.texture) and any(library.maps for library in found):
        notes.append("names textures, but holds no texture coordinates: they are not shown")
    return notes


# --- writing ----------------------------------------------------------------------------------


def encode(file: BinaryIO, mesh: Mesh, saving: Saving) -> None:
    """Write a mesh: the file that it was read from with colours after x, y, z, or a new file."""
    colors = only_colors(mesh.attributes["vertex"], mesh.document, saving, "OBJ")
    polygons = mesh.polygons or as_polygons(mesh.faces)
    document = mesh.document
    if isinstance(document, ObjDocument) and document.describes(mesh.vertices, polygons):
        data = document.data
        if line_end(data) == b"\r":  # one kind of line ends, with the comments
            data = data.replace(b"\r", b"\n")
        if saving.companions is not None and b"mtllib" in data:
            data = with_companions(data, document.folder, saving.companions)
        if saving.comments or saving.colors is not None:
            data = without_provenance(data)
        _write_comments(file, saving)
        file.write(data if saving.colors is None else _edited(data, saving.colors))
        return
    _write_comments(file, saving)
    file.write(vertex_rows(mesh.vertices, colors))
    file.write(text.rows("f %s\n", text.corners(polygons, first=1)))


def vertex_rows(vertices: NDArray[np.float64], colors: NDArray[np.uint8] | None) -> bytes:
    """Return the lines of vertices (n, 3), with colours (n, 3) or without."""
    if colors is None:
        return text.rows("v %r %r %r\n", *vertices.T)
    return text.rows("v %r %r %r %s %s %s\n", *vertices.T, *map(_fractions, colors.T))


def _fractions(channel: NDArray[np.uint8]) -> list[str]:
    return [_FRACTIONS[level] for level in channel.tolist()]


def _write_comments(file: BinaryIO, saving: Saving) -> None:
    file.writelines(f"# {line}\n".encode() for line in saving.comments)


def without_provenance(data: bytes) -> bytes:
    """Return a file without the comments that this program wrote at the top."""
    while data.startswith(_COMMENT):
        data = data.partition(b"\n")[2]
    return data


def _edited(data: bytes, colors: NDArray[np.uint8]) -> bytes:
    """Return the file with what follows x, y, z replaced, all other lines untouched."""
    tails = iter(text.rows(" %s %s %s\n", *map(_fractions, colors.T)).splitlines())
    lines = []
    for line in joined(data, rb"v[ \t]").split(b"\n"):
        body = line.lstrip()
        if body.startswith((b"v ", b"v\t")):
            numbers, hash_, comment = body.partition(b"#")
            words = numbers.split(None, 4)
            kept = numbers.rstrip() if len(words) == 4 else b" ".join(words[:4])
            rest = b" #" + comment if hash_ else b"\r" if line.endswith(b"\r") else b""
            line = kept + next(tails) + rest
        lines.append(line)
    return b"\n".join(lines)
