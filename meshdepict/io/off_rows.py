"""The rows of vertices and faces in an OFF file of text, one a line or with free line breaks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io import text

__all__ = ["Faces", "Rows", "read_rows"]

Ints = NDArray[np.int64]

_LEAST_VERTEX, _LEAST_FACE = 6, 2  # bytes that a row takes: "0 0 0\n" and "0\n"
_ABSURD = 1000  # times the file's length: no file is cut off that short


class Faces(NamedTuple):
    """Rows of faces: a number of corners, the corners, and what follows them."""

    values: NDArray[Any]
    start: Ints  # where each row begins
    size: Ints  # how many corners it has
    width: Ints  # how many numbers


class Rows(NamedTuple):
    """What an OFF file holds below its first word."""

    vertices: NDArray[np.float64]  # (n, k)
    faces: Faces
    said: str  # what is odd about it, empty if nothing is


def read_rows(body: bytes, widths: Sequence[int]) -> Rows:
    """Read counts, vertices and faces.

    Parameters
    ----------
    body : bytes
        What follows the word OFF, without comments.
    widths : sequence of int
        How many numbers a vertex may have, the likeliest first: asked where lines don't tell.

    Raises
    ------
    MeshdepictError
        For missing counts, rows that don't fit them, and a file that is cut off.
    """
    lines = [line for line in body.splitlines() if line and not line.isspace()]
    counted = len(lines[0].split()) if lines else 0  # 2 or 3; else line breaks mean nothing
    try:
        counts = text.integers(b" ".join(body.split(None, 2)[:2]))
    except ValueError:
        counts = np.empty(0, np.int64)
    if len(counts) < 2 or (counts < 0).any():
        raise MeshdepictError("has no numbers of vertices and faces below the word OFF")
    points, polygons = int(counts[0]), int(counts[1])
    if points * _LEAST_VERTEX + polygons * _LEAST_FACE > _ABSURD * max(len(body), 1):
        raise MeshdepictError(
            f"claims more vertices and faces below the word OFF than its {len(body):,} bytes hold"
        )
    if counted in (2, 3) and len(lines) > points + polygons:
        return _of_lines(lines[1:], points, polygons)
    try:
        found = _of_words(
            text.floats(body), points, polygons, widths, (counted,) if counted in (2, 3) else (3, 2)
        )
    except ValueError:
        found = None
    if found is None:
        raise MeshdepictError(
            f"is cut off: {points:,} vertices and {polygons:,} faces are due, "
            f"but only {len(lines) - 1:,} lines are there"
        )
    return found


def _of_lines(lines: list[bytes], points: int, polygons: int) -> Rows:
    """Read one vertex or face from each line; more faces than counted are faces, too."""
    vertices = _table(lines[:points])
    last = points + polygons
    faces = _faces(lines[points:last])
    if faces is None:
        raise MeshdepictError(f"has a line among the {polygons:,} faces that doesn't fit OFF")
    if len(lines) == last:
        return Rows(vertices, faces, "")
    beyond = len(lines) - last
    everything = _faces(lines[points:])
    if everything is not None and (everything.size[polygons:] > 2).all():
        if (faces.size < 3).any():  # then these are vertices
            raise MeshdepictError(
                f"contradicts itself: below its {points:,} vertices are {polygons + beyond:,} "
                f"lines, not {polygons:,} faces; correct its counts"
            )
        said = f"counts {polygons:,} faces but holds {polygons + beyond:,}: all are read"
        return Rows(vertices, everything, said)
    lines_are = "line is" if beyond == 1 else "lines are"
    return Rows(vertices, faces, f"goes on after its faces: {beyond:,} {lines_are} not read")


def _table(lines: list[bytes]) -> NDArray[np.float64]:
    width = len(lines[0].split()) if lines else 3
    try:
        values = text.floats(b" ".join(lines))
        if width >= 3 and all(len(line.split()) == width for line in lines):
            return values.reshape(len(lines), width)
    except ValueError:
        pass
    raise MeshdepictError(f"has a line among the {len(lines):,} vertices that doesn't fit OFF")


def _faces(lines: list[bytes]) -> Faces | None:
    block = b" ".join(lines)
    try:
        try:
            values: NDArray[Any] = text.integers(block)
        except ValueError:  # colours as fractions
            values = text.floats(block)
    except ValueError:
        return None
    width = np.array([len(line.split()) for line in lines], np.int64)
    start = np.cumsum(width) - width
    given = values[start]
    if ((given < 0) | (given >= width) | (given != np.rint(given))).any():
        return None
    return Faces(values, start, given.astype(np.int64), width)


def _of_words(
    values: NDArray[np.float64],
    points: int,
    polygons: int,
    widths: Sequence[int],
    heads: Sequence[int],
) -> Rows | None:
    """Read numbers whose line breaks mean nothing, if some width of vertices uses up all of them.

    Then faces have no colours: a number more could be anything. ``heads`` is how many counts may
    stand in front: edges are often left out.
    """
    for counts in heads:
        for width in widths:
            first = counts + points * width
            if first > len(values):
                continue
            starts = _walk(values[first:], polygons)
            if starts is None:
                continue
            start = np.array(starts, np.int64)
            size = values[first + start].astype(np.int64)
            vertices = values[counts:first].reshape(points, width)
            return Rows(vertices, Faces(values, first + start, size, size + 1), "")
    return None


def _walk(values: NDArray[np.float64], polygons: int) -> list[int] | None:
    """Return where each face starts if so many of them use up all numbers, else None."""
    listed = values.tolist()
    starts = []
    at = 0
    for _ in range(polygons):
        if at >= len(listed) or not 1 <= listed[at] <= len(listed) or listed[at] % 1:
            return None
        starts.append(at)
        at += 1 + int(listed[at])
    return starts if at == len(listed) else None
