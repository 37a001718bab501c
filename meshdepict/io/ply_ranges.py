"""A binary PLY file of triangles read and written by ranges of rows: it is never there as a whole.

Rows are mapped into memory, which the system takes back as it needs it.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import regular
from meshdepict.io.ply_header import POSITION, Element, Header, Property, read_header

__all__ = ["PlyRanges"]

_COLORS = ("red", "green", "blue")
_LISTS = ("vertex_indices", "vertex_index")


class PlyRanges:
    """Vertices and triangles of a file.

    Parameters
    ----------
    path : path

    Attributes
    ----------
    vertices, faces : int
        How many there are.

    Raises
    ------
    MeshdepictError
        For a file that is none, or holds other things than vertices and then triangles.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        regular(self.path)
        try:
            with self.path.open("rb") as file:
                header = read_header(file)
            size = self.path.stat().st_size
        except OSError as error:
            raise MeshdepictError(f"{path} can't be read: {error.strerror}") from None
        except MeshdepictError as error:
            raise MeshdepictError(f"{path} {error}") from None
        self._header: Header = header
        names = [element.name for element in header.elements]
        if not header.order or names != ["vertex", "face"]:
            raise self._refusal("no binary file of vertices and triangles alone")
        vertex, face = header.elements
        lists = [item.name for item in face.properties if item.count]
        if not set(POSITION) <= set(vertex.names) or any(item.count for item in vertex.properties):
            raise self._refusal("without x, y and z alone at its vertices")
        if len(lists) != 1 or lists[0] not in _LISTS:
            raise self._refusal("with other lists than the faces' vertices")
        if any(item.kind != "u1" for item in vertex.properties if item.name in _COLORS):
            raise self._refusal("with colours that are no bytes")
        self.vertices, self.faces = vertex.count, face.count
        self._row, self._face_row = self._rows(vertex), self._rows(face)
        self._list = lists[0]
        self._start = header.size + self.vertices * self._row.itemsize
        if size != self._start + self.faces * self._face_row.itemsize:
            raise self._refusal("that is cut off, or whose faces are not all triangles")
        if not self.vertices or not self.faces:
            raise MeshdepictError(f"{path} has no faces: shading needs a surface")

    def _refusal(self, what: str) -> MeshdepictError:
        return MeshdepictError(
            f"{self.path} is a file {what}, which can't be read by ranges: leave --tiles out, or "
            "save it as binary PLY of triangles"
        )

    def _rows(self, element: Element) -> np.dtype[Any]:
        fields: list[Any] = []
        for item in element.properties:
            if item.count:
                fields.append(("count\n", self._header.order + item.count))
                fields.append((item.name, self._header.order + item.kind, (3,)))
            else:
                fields.append((item.name, self._header.order + item.kind))
        return np.dtype(fields)

    @cached_property
    def _vertex_rows(self) -> NDArray[Any]:
        return np.memmap(self.path, self._row, "r", self._header.size, (self.vertices,))

    @cached_property
    def _face_rows(self) -> NDArray[Any]:
        return np.memmap(self.path, self._face_row, "r", self._start, (self.faces,))

    def points(self, which: slice | NDArray[np.int64]) -> NDArray[np.float64]:
        """Return positions (k, 3) of a range of vertices, or of some.

        Raises
        ------
        MeshdepictError
            Where one is not finite.
        """
        rows = self._vertex_rows[which]
        found = np.stack([rows[axis].astype(np.float64) for axis in POSITION], axis=1)
        if not np.isfinite(found).all():
            raise MeshdepictError(f"{self.path} has vertices that are NaN or infinite")
        return found

    def triangles(self, which: slice) -> NDArray[np.int64]:
        """Return the vertices (k, 3) of a range of faces.

        Raises
        ------
        MeshdepictError
            For other polygons, and vertices that aren't there.
        """
        rows = self._face_rows[which]
        if not (rows["count\n"] == 3).all():
            raise self._refusal("whose faces are not all triangles")
        found = rows[self._list].astype(np.int64)
        if found.size and not (found.min() >= 0 and found.max() < self.vertices):
            raise MeshdepictError(f"{self.path} has faces of vertices that are not there")
        return found

    # --- writing ----------------------------------------------------------------------------

    @cached_property
    def _colored(self) -> list[Property]:
        """The vertices' properties, with colours."""
        properties = list(self._header.elements[0].properties)
        names = {item.name for item in properties}
        return properties + [Property(name, "u1") for name in _COLORS if name not in names]

    @cached_property
    def _colored_row(self) -> np.dtype[Any]:
        return self._rows(Element("vertex", self.vertices, tuple(self._colored)))

    def colored_header(self, comments: Sequence[str]) -> bytes:
        """Return the header of the file with colours at its vertices."""
        return self._header.rewritten({"vertex": self._colored}, comments)

    def colored_size(self, header: int) -> int:
        """Return the bytes of that file, its header so long."""
        rows = self.vertices * self._colored_row.itemsize
        return header + rows + self.faces * self._face_row.itemsize

    def write_vertices(
        self, file: Any, header: int, which: slice, colors: NDArray[np.uint8]
    ) -> None:
        """Write the rows of a range of vertices with their colours (k, 3) at their place."""
        given = self._vertex_rows[which]
        rows = np.empty(len(given), self._colored_row)
        for name in given.dtype.names or ():
            rows[name] = given[name]
        for name, column in zip(_COLORS, colors.T, strict=True):
            rows[name] = column
        file.seek(header + which.start * rows.itemsize)
        file.write(rows.tobytes())

    def write_faces(self, file: Any, header: int, which: slice) -> None:
        """Write the rows of a range of faces, as they are, at their place."""
        rows = self._face_rows[which]
        start = header + self.vertices * self._colored_row.itemsize
        file.seek(start + which.start * rows.itemsize)
        file.write(rows.tobytes())
