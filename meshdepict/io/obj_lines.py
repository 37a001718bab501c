"""The lines of an OBJ file by keyword, without a loop over them."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io import text

__all__ = ["Lines", "joined", "line_end", "table"]

_BLANKS = np.frombuffer(b" \t", np.uint8)
_BLANK, _NEWLINE = ord(" "), ord("\n")
_PADDING = 8  # behind the last line, more than a keyword is long


def line_end(data: bytes) -> bytes:
    """Return the last byte of a line's end."""
    return b"\n" if b"\n" in data else b"\r"


def joined(data: bytes, keyword: bytes) -> bytes:
    """Return a text with those lines in one that begin with a keyword and end in a backslash.

    A comment doesn't go on: it may end in the name of a folder. Each line is looked at once.
    """
    if b"\\\n" not in data and b"\\\r\n" not in data:
        return data
    begins = re.compile(rb"[ \t]*+" + keyword)
    whole: list[bytes] = []
    parts: list[bytes] = []  # of the line that goes on
    for line in data.split(b"\n"):
        end = line.removesuffix(b"\r")
        goes_on = end.endswith(b"\\") and b"#" not in end and (parts or begins.match(line))
        parts.append(end[:-1] if goes_on else line)
        if not goes_on:
            whole.append(b" ".join(parts))
            parts = []
    if parts:
        whole.append(b" ".join(parts) + b" ")
    return b"\n".join(whole)


class Lines:
    """The lines of a text; continued ones are one, blanks in front are dropped."""

    def __init__(self, data: bytes) -> None:
        if line_end(data) == b"\r":
            data = data.replace(b"\r", b"\n")
        data = joined(data, b"")
        self._split(data)
        if np.isin(self._letters[self._starts], _BLANKS).any():
            self._split(re.sub(rb"(?m)^[ \t]+", b"", data))

    def _split(self, data: bytes) -> None:
        self._letters = np.frombuffer(data + b"\n" * _PADDING, np.uint8)
        ends = np.flatnonzero(self._letters[: 1 - _PADDING] == ord("\n"))
        self._starts = np.concatenate(([0], ends[:-1] + 1))
        self._lengths = ends + 1 - self._starts

    def begin_with(self, keyword: bytes) -> NDArray[np.bool_]:
        """Return which lines begin with a keyword and a blank."""
        found: NDArray[np.bool_] = np.isin(self._letters[self._starts + len(keyword)], _BLANKS)
        for at, letter in enumerate(keyword):
            found &= self._letters[self._starts + at] == letter
        return found

    def bodies(self, keyword: bytes) -> bytes:
        """Return the lines that begin with a keyword, blanks in its place, without comments."""
        found = self.begin_with(keyword)
        letters = self._letters[: self._lengths.sum()][np.repeat(found, self._lengths)]
        starts = np.cumsum(self._lengths[found]) - self._lengths[found]
        for at in range(len(keyword)):
            letters[starts + at] = ord(" ")
        block = letters.tobytes()
        return re.sub(rb"#.*", b"", block) if b"#" in block else block

    def before(self, keyword: bytes, other: bytes) -> NDArray[np.int64]:
        """Return for each line of one keyword how many lines of another come before it."""
        count: NDArray[np.int64] = np.cumsum(self.begin_with(other))
        return count[self.begin_with(keyword)]


def table(lines: Lines, keyword: bytes, *, least: int) -> NDArray[np.float64]:
    """Return the numbers after a keyword, one row per line, as many as every line has.

    Raises
    ------
    MeshdepictError
        Where a line has fewer than ``least``, or something that is no number.
    """
    block = lines.bodies(keyword)
    if not block:
        return np.empty((0, least))
    rows = block.count(b"\n")
    width = len(block.partition(b"\n")[0].split())
    try:
        values = text.floats(block)
        if width >= least and len(values) == width * rows and _are_even(block, width):
            return values.reshape(rows, width)
        words = [line.split() for line in block.splitlines()]
        width = min(map(len, words))
        if width >= least:
            block = b" ".join(b" ".join(row[:width]) for row in words)
            return text.floats(block).reshape(rows, width)
    except ValueError:
        pass
    raise MeshdepictError(
        f"has a line {keyword.decode()!r} with something else than {least} numbers or more"
    )


def _are_even(block: bytes, width: int) -> bool:
    """Whether every line has so many words; a sum of lengths doesn't tell."""
    filled = np.frombuffer(block, np.uint8) > _BLANK
    starts = np.flatnonzero(filled & ~np.concatenate(([False], filled[:-1])))
    ends = np.flatnonzero(np.frombuffer(block, np.uint8) == _NEWLINE)
    per_line = np.diff(np.searchsorted(starts, ends), prepend=0)
    return bool((per_line == width).all())
