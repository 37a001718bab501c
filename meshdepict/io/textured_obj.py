"""OBJ with a baked texture: a new file, or the one that was read with other coordinates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.files.mark import MARK
from meshdepict.io import text
from meshdepict.io.obj import ObjDocument, vertex_rows, without_provenance
from meshdepict.io.obj_lines import Lines, joined, line_end
from meshdepict.shapes.document import Document, only_colors
from meshdepict.surface.polygons import Polygons, as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.document import Saving
    from meshdepict.shapes.mesh import Mesh

__all__ = ["encode_textured_obj"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_MATERIAL = b"depiction"
_LIBRARY = re.compile(rb"(?m)^[ \t]*mtllib[ \t][^\n]*\n?")
_LINE = re.compile(rb"[^\n]*\n|[^\n]+")
_REWRITTEN = rb"(?:f|l|v|vt)[ \t]"


class _Laid(NamedTuple):
    """Where a picture lies on polygons.

    Attributes
    ----------
    places : (t, 2) array
    rows : sequence of list of (corners, places)
        For each polygon the faces that it becomes: which of its corners they have, and of each
        corner which place.
    """

    places: Floats
    rows: Sequence[list[tuple[list[int], list[int]]]]


def encode_textured_obj(
    file: BinaryIO, mesh: Mesh, given: Mesh, saving: Saving, picture: str, stem: str
) -> None:
    """Write a mesh with a picture on it, and its material beside; see `textured.write_textured`.

    Parameters
    ----------
    file, saving
        As for every format.
    mesh : Mesh
        With the texture.
    given : Mesh
        As it was read: the same triangles. Where it came from an OBJ file all other lines of that
        stay.
    picture : str
        What the picture is called.
    stem : str
        What the library is called, without its suffix.
    """
    polygons = given.polygons or as_polygons(given.faces)
    kept: ObjDocument | None = None
    if isinstance(given.document, ObjDocument) and given.document.describes(
        given.vertices, polygons
    ):
        kept = given.document
    names, bare = ([], True) if kept is None else _materials(kept.data)
    if bare:
        names = [_MATERIAL, *(name for name in names if name != _MATERIAL)]
    library = _library(saving, picture, stem, names)
    file.writelines(f"# {line}\n".encode() for line in saving.comments)
    file.write(f"mtllib {library}\n".encode())
    if bare:
        file.write(b"usemtl " + _MATERIAL + b"\n")
    if kept is None:
        _write_fresh(file, mesh, saving)
    else:
        _write_kept(file, mesh, given, kept, polygons)


def _materials(data: bytes) -> tuple[list[bytes], bool]:
    """Return the names of the materials that faces have, and whether any has none."""
    lines = Lines(data)
    used = [row.strip() for row in lines.bodies(b"usemtl").split(b"\n")[:-1]]
    bare = not used or bool((lines.before(b"f", b"usemtl") == 0).any())
    return [*dict.fromkeys(filter(None, used))], bare


def _library(saving: Saving, picture: str, stem: str, names: list[bytes]) -> str:
    """Write a library beside, whose materials all show the picture; return its name."""
    assert saving.companions is not None
    mark = f"# {MARK}".encode()
    shown = f"Kd 1 1 1\nillum 0\nmap_Kd {picture}\n".encode()
    content = mark + b"material of a baked texture\n"
    content += b"\n".join(b"newmtl " + name + b"\n" + shown for name in names)
    return saving.companions.written(f"{stem}.mtl", content, mark=mark)


def _write_fresh(file: BinaryIO, mesh: Mesh, saving: Saving) -> None:
    polygons = mesh.polygons or as_polygons(mesh.faces)
    found = np.zeros((len(polygons.connectivity), 2))
    assert mesh.texcoords is not None
    found[mesh.triangle_corners.reshape(-1)] = mesh.texcoords.reshape(-1, 2)
    places, number = _numbered(found)
    document = mesh.document
    baked = isinstance(document, Document) and document.is_recolored
    own = None if baked else only_colors(mesh.attributes["vertex"], document, saving, "OBJ")
    file.write(vertex_rows(mesh.vertices, own))
    file.write(text.rows("vt %.9g %.9g\n", *places.T))
    words = [
        f"{v + 1}/{t + 1}" for v, t in zip(polygons.connectivity.tolist(), number, strict=True)
    ]
    spans = pairwise(polygons.offsets.tolist())
    file.write("".join("f " + " ".join(words[a:b]) + "\n" for a, b in spans).encode())


def _numbered(texcoords: Floats) -> tuple[Floats, list[int]]:
    """Return the different places among coordinates, and which of them each is."""
    places, number = np.unique(texcoords.reshape(-1, 2), axis=0, return_inverse=True)
    return places, number.reshape(-1).tolist()


# --- the file that was read ---------------------------------------------------------------------


def _write_kept(
    file: BinaryIO, mesh: Mesh, given: Mesh, document: ObjDocument, polygons: Polygons
) -> None:
    """Write all lines of the file but for libraries, and for coordinates that change."""
    data = document.data
    if line_end(data) == b"\r":
        data = data.replace(b"\r", b"\n")
    data = _LIBRARY.sub(b"", without_provenance(data))
    laid = _laid(mesh, given, document, polygons)
    if laid is None and not document.is_recolored:
        file.write(data)
        return
    if laid is not None:
        file.write(text.rows("vt %.9g %.9g\n", *laid.places.T))
    file.writelines(_edited(data, laid, plain=document.is_recolored))


def _laid(mesh: Mesh, given: Mesh, document: ObjDocument, polygons: Polygons) -> _Laid | None:
    """Return where the picture lies; None where the file's own coordinates say so."""
    corners = given.triangle_corners
    assert mesh.texcoords is not None
    wanted = np.full((len(polygons.connectivity), 2), np.nan)
    wanted[corners.reshape(-1)] = mesh.texcoords.reshape(-1, 2)
    whole = np.array_equal(wanted[corners], mesh.texcoords)  # of polygons, not of triangles
    own = np.where(
        document.corners[:, None] >= 0, _rows(document.texture, document.corners), np.nan
    )
    if whole and np.array_equal(own[corners], mesh.texcoords):
        return None
    rows: list[list[tuple[list[int], list[int]]]] = [[] for _ in range(len(polygons.offsets) - 1)]
    starts = polygons.offsets.tolist()
    if whole:
        places, number = _numbered(np.nan_to_num(wanted))
        drawn = np.isfinite(wanted).all(axis=1)
        for face, (a, b) in enumerate(pairwise(starts)):
            if drawn[a:b].any():
                rows[face].append(([*range(b - a)], number[a:b]))
        return _Laid(places, rows)
    places, number = _numbered(mesh.texcoords)
    owner = np.searchsorted(polygons.offsets, corners[:, 0], side="right") - 1
    for triangle, (face, three) in enumerate(zip(owner.tolist(), corners.tolist(), strict=True)):
        at = [corner - starts[face] for corner in three]
        rows[face].append((at, number[3 * triangle : 3 * triangle + 3]))
    return _Laid(places, rows)


def _rows(table: Floats, index: Ints) -> Floats:
    return table[np.maximum(index, 0)] if len(table) else np.zeros((len(index), 2))


def _edited(data: bytes, laid: _Laid | None, *, plain: bool) -> Iterator[bytes]:
    """Yield a file's lines: faces with other coordinates, and ``plain`` vertices without colours.

    Lines and points lose coordinates, which are no longer there; a face that isn't drawn, too.
    """
    face = 0
    for line in _LINE.findall(joined(data, _REWRITTEN)):
        keyword = line.split(None, 1)[:1]
        if keyword == [b"v"] and plain:
            yield b" ".join(line.partition(b"#")[0].split()[:4]) + b"\n"
        elif laid is None or keyword not in ([b"f"], [b"l"], [b"vt"]):
            yield line
        elif keyword != [b"vt"]:
            numbers, hash_, comment = line.rstrip(b"\r\n").partition(b"#")
            words = [word.split(b"/") for word in numbers.split()[1:]]
            tail = (b" #" + comment if hash_ else b"") + (
                b"\r\n" if line[-2:-1] == b"\r" else b"\n"
            )
            rows = []
            if keyword == [b"f"]:
                rows = laid.rows[face]
                face += 1
            for corners, places in rows:
                named = zip((words[corner] for corner in corners), places, strict=True)
                yield (
                    b"f " + b" ".join(_corner(word, b"%d" % (at + 1)) for word, at in named) + tail
                )
            if not rows:
                yield keyword[0] + b" " + b" ".join(_corner(word, b"") for word in words) + tail


def _corner(word: list[bytes], place: bytes) -> bytes:
    """Return a corner with another texture coordinate, or with none."""
    normal = word[2] if len(word) > 2 else b""
    parts = [word[0], place, normal] if normal else [word[0], place] if place else [word[0]]
    return b"/".join(parts)
