"""How the rows of a PLY element are laid out, be they counted in bytes or in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.ply_header import Element, Property

__all__ = [
    "Column",
    "Layout",
    "Ragged",
    "Section",
    "Width",
    "as_ragged",
    "cut_off",
    "layout_of",
    "walk",
]

Ints = NDArray[np.int64]

_ABSURD = 1000  # rows for a byte: no file is cut off that short

Width = Callable[[str | None], int]  # how many bytes (or words) a value of a type takes


class Ragged(NamedTuple):
    """Lists of different lengths: row i has ``values[offsets[i]:offsets[i + 1]]``."""

    values: NDArray[Any]
    offsets: Ints


Column = NDArray[Any] | Ragged  # (n,) scalars, (n, k) lists of one length, or lists of several


class Section(NamedTuple):
    """An element with its columns, and its rows as they stand in the file."""

    element: Element
    columns: dict[str, Column]
    rows: bytes | list[bytes]  # a list of lines in ASCII files
    odd: Mapping[str, str]  # properties with values of another kind, and one of these


def as_ragged(column: Column) -> Ragged:
    """Return lists of one length in the form of lists of several."""
    if isinstance(column, Ragged):
        return column
    count, size = column.shape
    return Ragged(column.reshape(-1), np.arange(count + 1, dtype=np.int64) * size)


def walk(
    element: Element,
    rows: int,
    at: int,
    end: int,
    width: Width,
    reader: Callable[[Property], Callable[[int], int]],
) -> dict[str, Ints]:
    """Go through the first rows and return the lengths of their lists.

    Places count bytes or words, as ``width`` says of every type; ``reader`` gives for a list the
    function that reads its length at a place.
    """
    lists = [item.name for item in element.properties if item.count]
    if not lists:
        return {}
    start = at
    steps = []
    skip = 0
    for item in element.properties:
        if item.count:
            steps.append((skip, reader(item), width(item.count), width(item.kind)))
            skip = 0
        else:
            skip += width(item.kind)
    lengths = []
    try:
        for _ in range(rows):
            for before, read, counter, each in steps:
                at += before
                length = read(at)
                lengths.append(length)
                at += counter + length * each
            at += skip
            if at > end:
                raise cut_off(element, end - start)
    except IndexError:
        raise cut_off(element, end - start) from None
    table = np.array(lengths, np.int64).reshape(rows, len(lists))
    if (table < 0).any():
        raise MeshdepictError(f"contradicts its PLY header: a list in {element.name} is negative")
    return dict(zip(lists, table.T, strict=True))


class Layout(NamedTuple):
    """Where the values of an element's rows stand, in bytes or words."""

    places: dict[str, Ints]  # of a scalar, or of a list's length, in every row
    items: dict[str, Ints]  # of the items of all lists
    offsets: dict[str, Ints]
    stop: int

    def gathered(self, element: Element, view: Callable[[str], NDArray[Any]]) -> dict[str, Column]:
        """Return the columns; ``view`` gives for a type the values at every place."""
        return {
            item.name: Ragged(view(item.kind)[self.items[item.name]], self.offsets[item.name])
            if item.count
            else view(item.kind)[self.places[item.name]]
            for item in element.properties
        }


def layout_of(
    element: Element,
    lengths: Mapping[str, Ints],
    start: int,
    width: Width,
) -> Layout:
    """Return where the values of rows stand, their lists having the given lengths."""
    rows = np.zeros(element.count, np.int64)
    for item in element.properties:
        rows += width(item.count or item.kind)
        if item.count:
            rows += lengths[item.name] * width(item.kind)
    at = start + np.cumsum(rows) - rows
    layout = Layout({}, {}, {}, start + int(rows.sum()))
    for item in element.properties:
        layout.places[item.name] = at
        at = at + width(item.count or item.kind)
        if item.count:
            length, each = lengths[item.name], width(item.kind)
            offsets = np.concatenate(([0], np.cumsum(length)))
            first = np.repeat(at - offsets[:-1] * each, length)
            layout.items[item.name] = first + np.arange(len(first)) * each
            layout.offsets[item.name] = offsets
            at = at + length * each
    return layout


def cut_off(element: Element, left: int) -> MeshdepictError:
    """Return the error for a file that ends too early, ``left`` bytes after an element's start."""
    if element.count > _ABSURD * max(left, 1):
        return MeshdepictError(
            f"counts more rows of {element.name} in its PLY header than the {left:,} bytes hold "
            "that are left for them"
        )
    return MeshdepictError(
        f"is cut off: it ends within the {element.count:,} rows of {element.name} in its PLY header"
    )
