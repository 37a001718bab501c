"""The faces of an OBJ file: ``f 1 2 3``, ``f 1/4 2/5 3/6``, ``f 1//7 …``, ``f -3 -2 -1``."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io import text
from meshdepict.surface.polygons import Polygons

__all__ = ["parse_faces", "parse_normals"]

Ints = NDArray[np.int64]

_CORNER = re.compile(rb"-?\d+(/-?\d*){0,2}")
_NEWLINE, _SLASH, _BLANK = ord("\n"), ord("/"), ord(" ")


def parse_faces(
    block: bytes,
    vertices_before: Callable[[], Ints],
    textures_before: Callable[[], Ints],
) -> tuple[Polygons, Ints]:
    """Return the faces' polygons, and each corner's texture coordinate (−1: none), from 0.

    Parameters
    ----------
    block : bytes
        The corners of each face on a line of its own.
    vertices_before, textures_before : function
        Give for every face the number of vertices (texture coordinates) listed before it: negative
        indices count back from there.

    Raises
    ------
    MeshdepictError
        For a face that is not understood, and for the index 0.
    """
    values, at, numbers, offsets = _numbers(block)
    vertex = values[at]
    if not vertex.all():
        face = int(np.searchsorted(offsets, np.argmin(vertex != 0), side="right")) - 1
        raise MeshdepictError(f"has a face, number {face + 1}, with the index 0; OBJ counts from 1")
    texture = np.where(numbers > 1, values[np.minimum(at + 1, len(values) - 1)], 0)
    polygons = Polygons(_from_zero(vertex, offsets, vertices_before), offsets)
    return polygons, _from_zero(texture, offsets, textures_before)


def parse_normals(block: bytes, normals_before: Callable[[], Ints]) -> Ints:
    """Return each corner's normal (−1: none), from 0; the rest is as for `parse_faces`."""
    values, at, numbers, offsets = _numbers(block)
    normal = np.where(numbers > 2, values[np.minimum(at + 2, len(values) - 1)], 0)
    return _from_zero(normal, offsets, normals_before)


def _numbers(block: bytes) -> tuple[Ints, Ints, Ints, Ints]:
    """Return all numbers, where each corner's begin, how many it has, and where faces begin."""
    if b"/" in block:  # numbers that are left out become 0: 1//3, 1/, 1/2/
        block = re.sub(rb"/(?=[/\s])", b"/0", block)
    letters = np.frombuffer(block, np.uint8)
    filled = letters > _BLANK
    start = np.flatnonzero(filled & ~np.concatenate(([False], filled[:-1])))
    ends = np.flatnonzero(letters == _NEWLINE)
    offsets = np.concatenate(([0], np.searchsorted(start, ends)))
    slashes = np.searchsorted(start, np.flatnonzero(letters == _SLASH), side="right") - 1
    numbers = 1 + np.bincount(slashes, minlength=len(start))  # at every corner
    try:
        values = text.integers(block.replace(b"/", b" "))
        if len(values) != numbers.sum() or (numbers > 3).any():
            raise ValueError
    except ValueError:
        raise _misfit(block) from None
    return values, np.cumsum(numbers) - numbers, numbers, offsets


def _from_zero(index: Ints, offsets: Ints, before: Callable[[], Ints]) -> Ints:
    if len(index) == 0 or index.min() >= 0:
        return index - 1
    counted = np.repeat(before(), np.diff(offsets))
    # Further back than the beginning stays out of range, and is reported as such.
    return np.where(index < 0, index + counted, index - 1)


def _misfit(block: bytes) -> MeshdepictError:
    faces = enumerate(block.splitlines(), 1)
    number, line = next(face for face in faces if not all(map(_CORNER.fullmatch, face[1].split())))
    shown = line.strip()[:80].decode(errors="replace")
    return MeshdepictError(f"has a face, number {number}, that is not understood: {shown!r}")
