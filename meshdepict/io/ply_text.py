"""The rows of one element of an ASCII PLY file, as columns and back."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io import text
from meshdepict.io.ply_header import NAMES, Element, Property
from meshdepict.io.ply_rows import Column, Ragged, cut_off, layout_of, walk

__all__ = ["decode_text", "rewrite_text"]


def decode_text(lines: Sequence[bytes], element: Element) -> dict[str, Column]:
    """Read an element's rows from lines of text, one row each.

    Raises
    ------
    MeshdepictError
        Where a line doesn't hold what the header declares.
    """
    if len(lines) < element.count:
        raise cut_off(element)
    try:
        values = _numbers(lines, element)
        listed = values.tolist() if any(item.count for item in element.properties) else []

        def reader(_item: Property) -> Callable[[int], int]:
            return listed.__getitem__ if values.dtype == np.int64 else lambda at: int(listed[at])

        first = walk(element, min(element.count, 1), 0, len(values), _one, reader)
        sizes = {name: int(lengths.sum()) for name, lengths in first.items()}
        columns = _table_columns(values, element, sizes)
        if columns is None:
            lengths = walk(element, element.count, 0, len(values), _one, reader)
            layout = layout_of(element, lengths, 0, _one)
            if layout.stop != len(values):
                raise ValueError("some line is longer than declared")
            columns = layout.gathered(element, lambda _: values)
        return {item.name: _cast(columns[item.name], item.kind) for item in element.properties}
    except (ValueError, IndexError, MeshdepictError):
        raise _misfit(lines, element) from None


def _numbers(lines: Sequence[bytes], element: Element) -> NDArray[Any]:
    block = b" ".join(lines)
    if all(item.kind[0] in "iu" for item in element.properties):
        with suppress(ValueError):  # 1.0 for an integer is odd, but clear
            return text.integers(block)
    return text.floats(block)


def _table_columns(
    values: NDArray[Any], element: Element, sizes: Mapping[str, int]
) -> dict[str, Column] | None:
    """Return the columns of rows that are all as long as the first, else None."""
    width = len(element.properties) + sum(sizes.values())
    if len(values) != element.count * width:
        return None
    table = values.reshape(element.count, width)
    columns: dict[str, Column] = {}
    at = 0
    for item in element.properties:
        if item.count:
            size = sizes[item.name]
            if (table[:, at] != size).any():
                return None
            columns[item.name] = table[:, at + 1 : at + 1 + size]
            at += 1 + size
        else:
            columns[item.name] = table[:, at]
            at += 1
    return columns


def _cast(column: Column, kind: str) -> Column:
    if isinstance(column, Ragged):
        return Ragged(_cast(column.values, kind), column.offsets)  # type: ignore[arg-type]
    if kind[0] == "f":
        with np.errstate(over="ignore"):  # 1e300 as a float is infinite, as in any C program
            return column.astype(kind)
    limits = np.iinfo(kind)
    fits = (column >= limits.min) & (column <= limits.max)
    if not fits.all() or (column.dtype.kind == "f" and (column != np.rint(column)).any()):
        raise ValueError(f"not all values are of type {kind}")
    return column.astype(kind)


def _one(_kind: str | None) -> int:
    return 1


def _misfit(lines: Sequence[bytes], element: Element) -> MeshdepictError:
    """Find the line that contradicts the header."""
    problems = ((row, _problem(line.split(), element)) for row, line in enumerate(lines))
    row, problem = next(found for found in problems if found[1])
    return MeshdepictError(
        f"contradicts its PLY header: row {row} (from 0) of {element.name} {problem}"
    )


def _problem(words: list[bytes], element: Element) -> str | None:
    at = 0
    for item in element.properties:
        repeat = 1
        if item.count and at < len(words):
            if not words[at].isdigit():
                return f"has a list {item.name!r} of {words[at].decode(errors='replace')} items"
            repeat = int(words[at])
            at += 1
        for word in words[at : at + repeat]:
            try:
                _cast(text.floats(word), item.kind)
            except ValueError:
                shown = word.decode(errors="replace")
                return f"has {shown!r} for {item.name!r}, which is no {NAMES[item.kind]}"
        at += repeat
    if at != len(words):
        return f"has {len(words)} values where {at} are declared"
    return None


def rewrite_text(
    lines: Sequence[bytes],
    element: Element,
    kept: Collection[str],
    added: Sequence[NDArray[Any]],
) -> list[bytes]:
    """Return an element's lines without the properties that aren't kept, and with new columns."""
    everything = set(element.names) <= set(kept)
    tails = [b" ".join(row) for row in zip(*map(text.spelled, added), strict=True)]
    rewritten = []
    for row, line in enumerate(lines):
        words = [line.rstrip()] if everything else _kept_words(line.split(), element, kept)
        if tails:
            words.append(tails[row])
        rewritten.append(b" ".join(words) + (b"\r" if line.endswith(b"\r") else b""))
    return rewritten


def _kept_words(words: list[bytes], element: Element, kept: Collection[str]) -> list[bytes]:
    found: list[bytes] = []
    at = 0
    for item in element.properties:
        after = at + 1 + (int(float(words[at])) if item.count else 0)
        if item.name in kept:
            found += words[at:after]
        at = after
    return found
