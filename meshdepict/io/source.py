"""Opening a file: its bytes, unpacked, and which format they are in."""

from __future__ import annotations

import gzip
import os
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import unpacked
from meshdepict.files.reach import regular
from meshdepict.io.folders import MAPS, SCANS, held

__all__ = [
    "FORMATS",
    "MESHES",
    "WRITABLE",
    "begins_as_ply",
    "format_of",
    "opened",
    "suffix_of",
    "unmarked",
]

# Suffix → the module of this package that reads (and, but for STL, writes) it.
FORMATS = {
    ".ply": "ply",
    ".obj": "obj",
    ".off": "off",
    ".stl": "stl",
    ".glb": "gltf",
    ".gltf": "gltf",
    ".vtp": "vtp",
}
MESHES: dict[str, tuple[str, ...]] = {"meshes": tuple(FORMATS)}
WRITABLE = tuple(suffix for suffix in FORMATS if suffix != ".stl")  # STL holds no colours

_OFF = re.compile(rb"\s*(?:#[^\r\n]*[\r\n]\s*)*(?:ST)?C?N?4?n?OFF(?:\b|(?=\d))")
_MARK = b"\xef\xbb\xbf"  # the byte-order mark in UTF-8
_STL_HEADER, _STL_TRIANGLE = 84, 50  # bytes


def suffix_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix in lower case, the one before ``.gz`` where there is one."""
    name = Path(path)
    if name.suffix.lower() == ".gz":
        name = name.with_suffix("")
    return name.suffix.lower()


def begins_as_ply(path: str | os.PathLike[str]) -> bool:
    """Whether there is a file, not packed, that begins as PLY does and nothing else."""
    if not os.path.isfile(path):
        return False
    with suppress(OSError), Path(path).open("rb") as file:
        return re.match(rb"ply\s", file.read(4)) is not None
    return False


@contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file for reading, unpacking it where it is gzipped, by content.

    Raises
    ------
    MeshdepictError
        For a file that is missing, forbidden, empty, a folder or no file (a pipe, a device), and
        for one that is damaged as gzip or unpacks to more than is allowed: one sentence.
    """
    regular(path)
    try:
        with Path(path).open("rb") as file:
            start = file.peek(2)[:2]
            if not start:
                raise MeshdepictError(f"{path} is empty")
            if start == b"\x1f\x8b":
                yield unpacked(file, path)
            else:
                yield file
    except FileNotFoundError:
        raise MeshdepictError(f"{path}: there is no such file") from None
    except IsADirectoryError:
        instead = held(path, MESHES | MAPS | SCANS) or "; there is no mesh in it"
        raise MeshdepictError(f"{path} is a folder, not a file{instead}") from None
    except PermissionError:
        raise MeshdepictError(f"{path} may not be read: permission denied") from None
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise MeshdepictError(f"{path} is damaged: unpacking it failed ({error})") from error
    except OSError as error:
        raise MeshdepictError(f"{path} could not be read: {error.strerror or error}") from error


def unmarked(data: bytes) -> bytes:
    """Return a file's bytes without the mark that some editors put in front of UTF-8.

    Raises
    ------
    MeshdepictError
        For text in UTF-16 or UTF-32, which no mesh format is.
    """
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise MeshdepictError("is text in UTF-16: save it as plain text (ASCII or UTF-8)")
    return data.removeprefix(_MARK)


def format_of(path: str | os.PathLike[str], start: bytes, size: int) -> str:
    """Return the name of the module that reads a file.

    Parameters
    ----------
    path : str or path-like
        For its suffix, which decides only where the content doesn't tell.
    start : bytes
        The first few kilobytes.
    size : int
        The length of the whole, in bytes; −1 where it isn't known.

    Raises
    ------
    MeshdepictError
        Where neither the content nor the suffix is known.
    """
    found = _by_content(start, size)
    if found:
        return found
    suffix = suffix_of(path)
    if suffix in FORMATS:
        return FORMATS[suffix]
    known = ", ".join(FORMATS)
    raise MeshdepictError(f"{path}: its format is unknown; meshes are read from {known} (also .gz)")


def _by_content(start: bytes, size: int) -> str | None:
    if re.match(rb"ply\s", start):
        return "ply"
    if start.startswith(b"glTF"):
        return "gltf"
    if _OFF.match(start):
        return "off"
    if b"<VTKFile" in start:
        return "vtp"
    # A binary STL may begin with "solid", too: its length tells.
    if len(start) >= _STL_HEADER:
        count = int.from_bytes(start[80:84], "little")
        if size == _STL_HEADER + _STL_TRIANGLE * count:
            return "stl"
    if re.match(rb"(?i)\s*solid\b", start) and re.search(rb"(?i)\b(facet|endsolid)\b", start):
        return "stl"
    if re.match(rb'\s*\{.*"asset"', start, re.DOTALL):
        return "gltf"
    return None
