"""How much memory a file may ask for: a multiple of its own size, and never all there is.

A header's counts are claims. Before anything is allocated for them, what they need is compared
with an allowance: the file's size × 100, at least 512 MiB, at most half of the machine's memory. No
format that is read packs honest data tighter but for freak cases (a label volume of one label);
there a person raises the bound with ``--max-memory``, which then takes the allowance's place.
"""

from __future__ import annotations

import gzip
import io
import math
import os
import re
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from meshdepict.errors import MeshdepictError

__all__ = [
    "FACTOR", "LEAST", "allowance", "as_bytes", "as_text", "check_claim", "max_memory",
    "set_max_memory", "unpacked",
]  # fmt: skip

FACTOR = 100
"""Bytes of memory that each byte of a file may ask for; deflate's utmost is 1,032."""

LEAST = 512 << 20
"""Bytes that even the smallest file may ask for: a volume of 512³ in 32 bits, all of it air."""

_UNKNOWN = 8 << 30  # half of the memory of a usual machine, where none can be asked
_UNITS = {"": 1, "b": 1} | {
    f"{prefix}{end}": 1024**power
    for power, prefix in enumerate("kmgt", 1)
    for end in ("", "b", "ib")
}

_chosen: int | None = None


def set_max_memory(amount: int | float | str | None) -> None:
    """Let a file's contents take so many bytes (or "4GB") from now on; None: see `allowance`.

    Raises
    ------
    MeshdepictError
        For what is no amount of memory.
    """
    global _chosen
    _chosen = None if amount is None else as_bytes(amount)


def max_memory() -> int:
    """Return how many bytes a file's contents may take at most: as set, or half of the memory."""
    return _machine_memory() // 2 if _chosen is None else _chosen


def as_bytes(amount: int | float | str) -> int:
    """Return the number of bytes that a number, or a text such as "4GB" or "500 MB", stands for.

    Raises
    ------
    MeshdepictError
        For anything else, and for less than a byte.
    """
    number, unit = amount, ""
    if isinstance(amount, str):
        match = re.fullmatch(r"\s*(\d{1,30}(?:\.\d{1,30})?)\s*([a-z]{0,3})\s*", amount.lower())
        number, unit = (float(match[1]), match[2]) if match else (0, "")
    real = isinstance(number, (int, float)) and not isinstance(number, bool)
    if not real or unit not in _UNITS or not 1 <= number * _UNITS[unit] < math.inf:
        raise MeshdepictError(f"max-memory {amount!r} is no amount of memory such as 4GB or 500MB")
    return int(number * _UNITS[unit])


def as_text(count: float) -> str:
    """Return a number of bytes as people say it: ``"1.5 GB"``."""
    for power, unit in ((3, "GB"), (2, "MB"), (1, "kB")):
        if count >= 1024**power:
            return f"{count / 1024**power:,.1f}".removesuffix(".0") + f" {unit}"
    return f"{count:,.0f} bytes"


def allowance(size: int, *, least: int = LEAST) -> int:
    """Return how many bytes may be allocated for what a file of so many bytes says.

    Parameters
    ----------
    size : int
        Of the file, in bytes.
    least : int
        What any file may ask for.

    Returns
    -------
    int
        As `set_max_memory` says; without it `FACTOR` × the size, no less than `least` and no more
        than half of the machine's memory.
    """
    if _chosen is not None:
        return _chosen
    return min(max_memory(), max(least, FACTOR * size))


def check_claim(needed: int, size: int, what: str, *, least: int = LEAST) -> None:
    """Refuse to allocate what a file of so many bytes claims, before it is done.

    Parameters
    ----------
    needed : int
        Bytes that would be allocated.
    size : int
        Of the file, in bytes.
    what : str
        What is claimed, for the sentence: "instances", "more voxels".
    least : int
        As for `allowance`.

    Raises
    ------
    MeshdepictError
        For more than the allowance: one clause whose subject is the file.
    """
    allowed = allowance(size, least=least)
    if needed > allowed:
        raise MeshdepictError(
            f"claims more {what} than the {as_text(allowed)} of memory hold that a file of its "
            "size may fill: if it is right, allow more with --max-memory"
        )


def unpacked(file: BinaryIO, name: str | os.PathLike[str]) -> io.BufferedReader:
    """Return the contents of a gzipped file, as they are asked for and no more than allowed.

    Parameters
    ----------
    file : binary file
        At its beginning, on a disk.
    name : path
        For the sentence.

    Raises
    ------
    MeshdepictError
        When more is read than the allowance: a bomb.
    """
    return io.BufferedReader(_Bounded(file, name), 1 << 16)


class _Bounded(io.RawIOBase):
    """What a gzipped file unpacks to, up to its allowance."""

    def __init__(self, file: BinaryIO, name: str | os.PathLike[str]) -> None:
        self._allowed = allowance(os.fstat(file.fileno()).st_size)
        self._name = name
        self._unpacking = gzip.GzipFile(fileobj=file)
        self._count = 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: bytearray | memoryview) -> int:  # type: ignore[override]
        count = self._unpacking.readinto(buffer)
        self._count += count
        if self._count > self._allowed:
            raise MeshdepictError(
                f"{self._name} unpacks to more than {as_text(self._allowed)}, which no file of its "
                "size should: if it is right, allow more with --max-memory"
            )
        return count


def _machine_memory() -> int:
    """Return the bytes of memory that this process can have: the machine's, or its container's."""
    found = []
    if hasattr(os, "sysconf"):
        with suppress(OSError, ValueError):
            found.append(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    for path in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        try:
            found.append(int(Path(path).read_text(encoding="ascii")))
        except (OSError, ValueError):  # no container, or "max"
            continue
    return min((amount for amount in found if amount > 0), default=2 * _UNKNOWN)
