"""The rows of one element of an ASCII PLY file, as columns and back."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io import text
from meshdepict.io.ply_header import NAMES, POSITION, Element, Property
from meshdepict.io.ply_rows import Column, Layout, Ragged, as_ragged, cut_off, layout_of, walk

__all__ = ["decode_text", "encode_text", "reflowed", "rewrite_text"]

_NAN = re.compile(rb"(?i)[-+]?(nan|1\.?#|#?ind|#?qnan|#?snan|n/?a$|null$|none$|-+$).*")


def decode_text(
    lines: Sequence[bytes], element: Element
) -> tuple[dict[str, Column], dict[str, str]]:
    """Read an element's rows from lines of text, one row each.

    Returns
    -------
    columns : {property: Column}
        Without properties whose values don't fit their type, if shading can do without.
    odd : {property: word}
        Those, and those of which some values are words: these became NaN. With one such word.

    Raises
    ------
    MeshdepictError
        Where a line doesn't hold what the header declares.
    """
    if not element.properties:
        return {}, {}
    if len(lines) < element.count:
        raise cut_off(element, sum(map(len, lines)))
    try:
        values, unknown = _numbers(lines, element)
        listed = values.tolist() if any(item.count for item in element.properties) else []

        def reader(_item: Property) -> Callable[[int], int]:
            return listed.__getitem__ if values.dtype == np.int64 else lambda at: int(listed[at])

        first = walk(element, min(element.count, 1), 0, len(values), _one, reader)
        sizes = {name: int(lengths.sum()) for name, lengths in first.items()}
        columns = None if unknown else _table_columns(values, element, sizes)
        odd: dict[str, str] = {}
        if columns is None:
            lengths = walk(element, element.count, 0, len(values), _one, reader)
            layout = layout_of(element, lengths, 0, _one)
            if layout.stop != len(values):
                raise ValueError("some line is longer than declared")
            columns = layout.gathered(element, lambda _: values)
            odd = _odd(unknown, element, layout)
        return _fitting(columns, element, odd)
    except (ValueError, OverflowError, IndexError, MeshdepictError):
        raise _misfit(lines, element) from None


def _fitting(
    columns: Mapping[str, Column], element: Element, odd: dict[str, str]
) -> tuple[dict[str, Column], dict[str, str]]:
    """Return columns in their types, without those that don't fit and aren't needed."""
    found: dict[str, Column] = {}
    for item in element.properties:
        column = columns[item.name]
        try:
            found[item.name] = _cast(column, item.kind)
        except ValueError:
            if not _is_spare(item, element) or isinstance(column, Ragged):
                raise
            odd.setdefault(item.name, _first_misfit(column, item.kind))
    return found, odd


def _is_spare(item: Property, element: Element) -> bool:
    """Whether shading can do without a property: one that is no list and no coordinate."""
    return not item.count and not (element.name == "vertex" and item.name in POSITION)


def _first_misfit(column: NDArray[Any], kind: str) -> str:
    limits = np.iinfo(kind)
    fits = (column >= limits.min) & (column <= limits.max) & (column == np.rint(column))
    return f"{column[~fits][0]:g}"


def _odd(unknown: Mapping[int, bytes], element: Element, layout: Layout) -> dict[str, str]:
    """Return which properties have words for numbers, and one word of each.

    A word for NaN may stand in a coordinate; any word, where shading can do without.
    """
    left = dict(unknown)
    odd: dict[str, str] = {}
    for item in element.properties:
        if item.count or not left:
            continue
        words = [left.pop(at) for at in layout.places[item.name].tolist() if at in left]
        if words and not _is_spare(item, element):
            if not all(map(_NAN.fullmatch, words)):
                raise ValueError("a coordinate that is no number")
        elif words:
            odd[item.name] = words[0].decode(errors="replace")
    if left:
        raise ValueError("a list with a word in it")
    return odd


def _numbers(lines: Sequence[bytes], element: Element) -> tuple[NDArray[Any], dict[int, bytes]]:
    """Return all words as numbers, and those that are none, which became NaN, by their place."""
    block = b" ".join(lines)
    if all(item.kind[0] in "iu" for item in element.properties):
        with suppress(ValueError):  # 1.0 for an integer is odd, but clear
            return text.integers(block), {}
    with suppress(ValueError):
        return text.floats(block), {}
    words = block.split()
    known: dict[bytes, bool] = {}
    unknown = {}
    for at, word in enumerate(words):
        if word not in known:
            known[word] = _is_number(word)
        if not known[word]:
            unknown[at], words[at] = word, b"nan"
    return text.floats(b" ".join(words)), unknown


def _is_number(word: bytes) -> bool:
    try:
        text.floats(word)
    except ValueError:
        return False
    return True


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
        return column.astype(kind)  # 1e300 as a float is infinite, as in any C program
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
    row, problem = next((found for found in problems if found[1]), (0, "doesn't fit"))
    return MeshdepictError(
        f"contradicts its PLY header: row {row} (from 0) of {element.name} {problem}"
    )


def _problem(words: list[bytes], element: Element) -> str | None:
    at = 0
    for item in element.properties:
        repeat = 1
        if item.count and at < len(words):
            if not words[at].isdigit() or len(words[at]) > len(str(len(words))):
                shown = words[at][:80].decode(errors="replace")
                return f"has a list {item.name!r} of {shown} items"
            repeat = int(words[at])
            at += 1
        for word in words[at : at + repeat]:
            try:
                _cast(text.floats(word), item.kind)
            except ValueError:
                if _is_spare(item, element) or (not item.count and _NAN.fullmatch(word)):
                    continue
                shown = word[:80].decode(errors="replace")
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


def encode_text(element: Element, columns: Mapping[str, Column]) -> bytes:
    """Return an element's rows as lines of text that read back as the same numbers."""
    parts: list[Iterable[bytes]] = []
    for item in element.properties:
        column = columns[item.name]
        if not item.count:
            parts.append(text.spelled(np.asarray(column).astype(item.kind, copy=False)))
            continue
        values, offsets = as_ragged(column)
        words = text.spelled(values.astype(item.kind, copy=False))
        spans = pairwise(offsets.tolist())
        parts.append([b" ".join([b"%d" % (b - a), *words[a:b]]) for a, b in spans])
    return b"".join([b" ".join(row) + b"\n" for row in zip(*parts, strict=True)])


def reflowed(words: Sequence[bytes], elements: Iterable[Element]) -> list[list[bytes]] | None:
    """Return lines, one a row, of words whose line breaks mean nothing; None if they don't fit.

    All words have to be used up.
    """
    at = 0
    found = []
    for element in elements:
        lines: list[bytes] = []
        for _ in range(element.count if element.properties else 0):
            start = at
            for item in element.properties:
                if item.count:
                    if at >= len(words) or not words[at].isdigit() or len(words[at]) > 18:
                        return None
                    at += int(words[at])
                at += 1
            if at > len(words):
                return None
            lines.append(b" ".join(words[start:at]))
        found.append(lines)
    return found if at == len(words) else None
