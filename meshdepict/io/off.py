"""OFF: ASCII with normals, colours and texture coordinates (COFF, NOFF, …), and OFF BINARY."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.mark import MARK
from meshdepict.io import text
from meshdepict.io.off_binary import read_binary
from meshdepict.io.off_rows import Rows, read_rows
from meshdepict.shapes.colors import after_position
from meshdepict.shapes.document import COLOR, Contents, Document, Saving, as_bytes, only_colors
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["decode", "encode", "provenance"]

_KEYWORD = re.compile(
    rb"\s*(?:#[^\r\n]*[\r\n]\s*)*(?P<texture>ST)?(?P<color>C)?(?P<normal>N)?(?P<other>4?n?)"
    rb"(?:OFF|off)(?:\b|(?=\d))"  # ModelNet's counts touch the word
    rb"(?P<binary>[ \t]+BINARY[ \t]*\r?\n)?"
)
_LARGEST = 2.0**62  # of numbers that are compared as indices: beyond it 64 bits end
_PROVENANCE = re.compile(rb"\A\w*OFF[ \t]*\r?\n((?:#[^\n]*\n)*)")


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return the comments that this program wrote below the first line."""
    return _written(file.read(1 << 16))


def _written(start: bytes) -> tuple[str, ...]:
    found = _PROVENANCE.match(start)
    lines = found[1].decode("utf-8", "replace").splitlines() if found else []
    return tuple(line[2:] for line in lines if line.startswith(f"# {MARK}"))


# --- reading ----------------------------------------------------------------------------------


def decode(data: bytes, path: Path) -> Contents:
    """Read a mesh.

    Raises
    ------
    MeshdepictError
        For points that aren't three-dimensional, a line that doesn't fit, a file that is cut off.
    """
    keyword = _KEYWORD.match(data)
    if keyword is None:
        raise MeshdepictError("is no OFF file: its first line has no OFF")
    if keyword["other"]:
        raise MeshdepictError("holds points of other than three dimensions, which can't be shaded")
    if keyword["binary"]:
        vertices, faces = read_binary(data[keyword.end() :])
        return Contents(vertices, faces, {}, Document())
    least = 3 + 3 * bool(keyword["normal"]) + 2 * bool(keyword["texture"])
    colored = [least + 4, least + 3]
    widths = [*colored, least] if keyword["color"] else [least, *colored]
    rows = read_rows(re.sub(rb"#[^\r\n]*", b"", data[keyword.end() :]), widths)
    if rows.said:
        warnings.warn(f"{path} {rows.said}", MeshdepictWarning, stacklevel=2)
    vertex = _vertex_attributes(rows.vertices, keyword)
    faces, face = _faces(rows)
    document = Document(provenance=_written(data))
    return Contents(rows.vertices[:, :3], faces, {"vertex": vertex, "face": face}, document)


def _vertex_attributes(
    table: NDArray[np.float64], keyword: re.Match[bytes]
) -> dict[str, NDArray[Any]]:
    """Return what follows a vertex's x, y, z: normal, colour, texture coordinates."""
    attributes: dict[str, NDArray[Any]] = {}
    at, end = 3, table.shape[1]
    if keyword["normal"] and end - at >= 3:
        attributes |= {name: table[:, at + k] for k, name in enumerate(("nx", "ny", "nz"))}
        at += 3
    if keyword["texture"] and end - at >= 2:
        attributes |= {"s": table[:, end - 2], "t": table[:, end - 1]}
        end -= 2
    rest = table[:, at:end]
    # Also without a C in the keyword, as some programs write it. A weight is 1.
    weighted = rest.shape[1] in (1, 5) and bool((rest[:, 0] == 1).all())
    colors = after_position(rest, w_first=False) if rest.shape[1] in (3, 4) or weighted else None
    if colors is not None:
        attributes |= _colors(colors)
    elif end > at and not weighted:
        raise MeshdepictError(f"has OFF vertices of {table.shape[1]} numbers, which is unclear")
    return attributes


def _colors(values: NDArray[Any]) -> dict[str, NDArray[np.uint8]]:
    colors = as_bytes(values).T
    opaque = len(colors) > 3 and (colors[3] == 255).all()
    return dict(zip((*COLOR, "alpha"), colors[:3] if opaque else colors, strict=False))


def _faces(rows: Rows) -> tuple[Polygons, dict[str, NDArray[Any]]]:
    values, start, size, width = rows.faces
    offsets = np.concatenate(([0], np.cumsum(size)))
    corner = np.arange(offsets[-1]) + np.repeat(start + 1 - offsets[:-1], size)
    index = values[corner]
    if not (np.abs(index) < _LARGEST).all() or (index != np.rint(index)).any():
        raise MeshdepictError(f"has a line among the {len(size):,} faces that doesn't fit OFF")
    polygons = Polygons(index.astype(np.int64), offsets)
    beyond = np.unique(width - 1 - size)
    if len(beyond) == 1 and beyond[0] in (3, 4):
        return polygons, _colors(values[(start + 1 + size)[:, None] + np.arange(beyond[0])])
    return polygons, {}


# --- writing ----------------------------------------------------------------------------------


def encode(file: BinaryIO, mesh: Mesh, saving: Saving) -> None:
    """Write OFF, or COFF where there are colours; coordinates read back bit for bit."""
    colors = only_colors(mesh.attributes["vertex"], mesh.document, saving, "OFF")
    polygons = mesh.polygons or as_polygons(mesh.faces)
    file.write(b"COFF\n" if colors is not None else b"OFF\n")
    file.writelines(f"# {line}\n".encode() for line in saving.comments)
    file.write(b"%d %d 0\n" % (len(mesh.vertices), len(polygons.offsets) - 1))
    if colors is None:
        file.write(text.rows("%r %r %r\n", *mesh.vertices.T))
    else:
        alpha = mesh.attributes["vertex"].get("alpha")
        opacity = np.full(len(colors), 255) if alpha is None else as_bytes(alpha)
        file.write(text.rows("%r %r %r %d %d %d %d\n", *mesh.vertices.T, *colors.T, opacity))
    template = "%d %s"
    columns: list[Any] = [np.diff(polygons.offsets), text.corners(polygons)]
    face = mesh.attributes["face"]
    if all(channel in face for channel in COLOR):
        template += " %d %d %d"
        columns += list(as_bytes(np.stack([face[channel] for channel in COLOR])))
    file.write(text.rows(template + "\n", *columns))
