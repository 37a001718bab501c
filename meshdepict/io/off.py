"""OFF: ASCII with normals, colours and texture coordinates (COFF, NOFF, …), and OFF BINARY."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.mark import MARK
from meshdepict.io import text
from meshdepict.shapes.document import (
    COLOR,
    Contents,
    Document,
    Saving,
    as_bytes,
    only_colors,
)
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["decode", "encode", "provenance"]

_KEYWORD = re.compile(
    rb"\s*(?:#[^\r\n]*[\r\n]\s*)*(?P<texture>ST)?(?P<color>C)?(?P<normal>N)?(?P<other>4?n?)OFF\b"
    rb"(?P<binary>[ \t]+BINARY[ \t]*\r?\n)?"
)
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
        vertices, faces = _binary(data[keyword.end() :])
        return Contents(vertices, faces, {}, Document())
    lines = re.sub(rb"#[^\r\n]*", b"", data[keyword.end() :]).splitlines()
    lines = [line for line in lines if line and not line.isspace()]
    try:
        counts = text.integers(lines[0] if lines else b"")
    except ValueError:
        counts = np.empty(0, np.int64)
    if len(counts) < 2 or (counts < 0).any():
        raise MeshdepictError("has no numbers of vertices and faces below the word OFF")
    points, polygons = int(counts[0]), int(counts[1])
    if len(lines) < 1 + points + polygons:
        raise MeshdepictError(
            f"is cut off: {points:,} vertices and {polygons:,} faces are due, "
            f"but only {len(lines) - 1:,} lines are there"
        )
    table = _vertex_table(lines[1 : 1 + points])
    vertex = _vertex_attributes(table, keyword)
    faces, face = _faces(lines[1 + points : 1 + points + polygons])
    document = Document(provenance=_written(data))
    return Contents(table[:, :3], faces, {"vertex": vertex, "face": face}, document)


def _vertex_table(lines: list[bytes]) -> NDArray[np.float64]:
    width = len(lines[0].split()) if lines else 3
    try:
        values = text.floats(b" ".join(lines))
        if width >= 3:
            return values.reshape(len(lines), width)
    except ValueError:
        pass
    raise MeshdepictError(f"has a line among the {len(lines):,} vertices that doesn't fit OFF")


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
    if end - at in (3, 4):  # also without a C in the keyword, as some programs write it
        attributes |= _colors(table[:, at:end])
    elif end > at:
        raise MeshdepictError(f"has OFF vertices of {table.shape[1]} numbers, which is unclear")
    return attributes


def _colors(values: NDArray[Any]) -> dict[str, NDArray[np.uint8]]:
    colors = as_bytes(values).T
    opaque = len(colors) > 3 and (colors[3] == 255).all()
    return dict(zip((*COLOR, "alpha"), colors[:3] if opaque else colors, strict=False))


def _faces(lines: list[bytes]) -> tuple[Polygons, dict[str, NDArray[Any]]]:
    try:
        block = b" ".join(lines)
        try:
            values: NDArray[Any] = text.integers(block)
        except ValueError:  # colours as fractions
            values = text.floats(block)
        width = np.array([len(line.split()) for line in lines], np.int64)
        start = np.cumsum(width) - width
        size = values[start].astype(np.int64)
        if (size < 0).any() or (size >= width).any():
            raise ValueError
    except ValueError:
        raise MeshdepictError(
            f"has a line among the {len(lines):,} faces that doesn't fit OFF"
        ) from None
    offsets = np.concatenate(([0], np.cumsum(size)))
    corner = np.arange(offsets[-1]) + np.repeat(start + 1 - offsets[:-1], size)
    polygons = Polygons(values[corner].astype(np.int64), offsets)
    beyond = np.unique(width - 1 - size)
    if len(beyond) == 1 and beyond[0] in (3, 4):
        return polygons, _colors(values[(start + 1 + size)[:, None] + np.arange(beyond[0])])
    return polygons, {}


def _binary(data: bytes) -> tuple[NDArray[Any], Polygons]:
    """Read counts, float points, and per face its number of corners and the corners.

    Geomview's are big-endian and have the number of colour components after the corners, other
    programs' are little-endian without: the length of the file tells.
    """
    for order in "<>":
        words = np.frombuffer(data, order + "i4", len(data) // 4)
        if len(words) < 3:
            break
        points, faces = int(words[0]), int(words[1])
        first = 3 + 3 * points
        if points < 0 or faces < 0 or first + faces > len(words):
            continue
        for colored in (False, True):
            polygons = _binary_faces(words[first:], faces, colored=colored)
            if polygons:
                vertices = words[3:first].view(order + "f4").reshape(-1, 3)
                return vertices, polygons
    raise MeshdepictError("is cut off or wrong as OFF BINARY: its length doesn't fit its counts")


def _binary_faces(words: NDArray[np.int32], count: int, *, colored: bool) -> Polygons | None:
    """Return the faces if they fill the words exactly."""
    listed = words.tolist()
    starts: list[int] = []
    sizes: list[int] = []
    at = 0
    for _ in range(count):
        if at >= len(listed) or listed[at] < 0:
            return None
        starts.append(at + 1)
        sizes.append(listed[at])
        at += 1 + listed[at]
        if colored:
            if at >= len(listed) or listed[at] < 0:
                return None
            at += 1 + listed[at]
    if at != len(listed):
        return None
    offsets = np.concatenate(([0], np.cumsum(sizes, dtype=np.int64)))
    corner = np.arange(offsets[-1]) + np.repeat(np.array(starts, np.int64) - offsets[:-1], sizes)
    return Polygons(words[corner].astype(np.int64), offsets)


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
        file.write(text.rows("%r %r %r %d %d %d 255\n", *mesh.vertices.T, *colors.T))
    template = "%d %s"
    columns: list[Any] = [np.diff(polygons.offsets), text.corners(polygons)]
    face = mesh.attributes["face"]
    if all(channel in face for channel in COLOR):
        template += " %d %d %d"
        columns += list(as_bytes(np.stack([face[channel] for channel in COLOR])))
    file.write(text.rows(template + "\n", *columns))
