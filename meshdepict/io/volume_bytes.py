"""The voxels' bytes of NIfTI, NRRD and MetaImage, and no more of them than the header claims."""

from __future__ import annotations

import bz2
import gzip
import os
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.io.volume_contents import check_amount

__all__ = ["GZIP", "Inflated", "text_numbers", "voxels", "voxels_of_files"]

GZIP = b"\x1f\x8b"

_PART = 1 << 20  # bytes at a time


class Inflated:
    """A zlib or gzip stream as a file that is read from its beginning to its end.

    Parameters
    ----------
    file : binary file
        Where the stream begins.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._unpacking = file, zlib.decompressobj(47)  # either header

    def read(self, count: int) -> bytes:
        """Return so many bytes, fewer at the end only."""
        found: list[bytes] = []
        while count > 0 and not self._unpacking.eof:
            packed = self._unpacking.unconsumed_tail or self._file.read(_PART)
            if not packed:
                raise EOFError("the compressed stream ends too early")
            part = self._unpacking.decompress(packed, min(count, _PART))
            found.append(part)
            count -= len(part)
        return b"".join(found)


def voxels(
    stream: Any, size: int, kind: np.dtype[Any], counts: tuple[int, ...], notes: list[str]
) -> NDArray[Any]:
    """Return the voxels (nz, ny, nx) that a stream holds from here on.

    Parameters
    ----------
    stream : file-like
        Its ``read(count)`` gives unpacked bytes.
    size : int
        Of the file on the disk, in bytes: what it may unpack to depends on it.
    kind : dtype
        Of a voxel, in the file's order of bytes.
    counts : (nx, ny, nz)
    notes : list of str
        Gets a clause where bytes are left over.

    Raises
    ------
    MeshdepictError
        Where the header claims another number of voxels than there are, and for damaged streams.
    """
    needed = prod(counts) * kind.itemsize
    check_claim(needed, size, "voxels")
    data = bytearray()
    try:
        # In parts: what is claimed need not be there.
        while len(data) < needed and (part := stream.read(min(_PART, needed - len(data)))):
            data += part
        beyond = 0
        if len(data) == needed:  # the file's end, with its checksum, or more voxels
            slice_ = needed // counts[-1]
            while beyond < slice_ and (part := stream.read(min(_PART, slice_ - beyond))):
                beyond += len(part)
    except (EOFError, OSError, zlib.error, ValueError) as error:
        if isinstance(error, OSError) and error.errno:
            raise
        raise MeshdepictError(f"is cut off or damaged: {error}") from error
    check_amount(counts, kind.itemsize, len(data) + beyond, notes)
    return np.frombuffer(data, kind).reshape(counts[::-1])


def voxels_of_files(
    paths: Sequence[Path], kind: np.dtype[Any], counts: tuple[int, ...], notes: list[str], *,
    packed: str = "", start: int = 0, lines: int = 0, skip: int = 0,
) -> NDArray[Any]:  # fmt: skip
    """Return the voxels of a header's data files, each with as many slices as the others.

    Parameters
    ----------
    paths : sequence of Path
    kind, counts, notes
        As for `voxels`.
    packed : "", "zlib", "gzip" or "bzip2"
    start : int
        Where data begin in each file; −1 where they are its end.
    lines, skip : int
        Lines of text before the data, and then bytes, which are packed with them.
    """
    if not paths or counts[-1] % len(paths):
        raise MeshdepictError(
            f"names {len(paths):,} data files for its {counts[-1]:,} slices: correct the header"
        )
    each = (*counts[:-1], counts[-1] // len(paths))
    parts = []
    for path in paths:
        if not path.is_file():
            raise MeshdepictError(f"names the data file {path.name!r}, which is not there")
        size = path.stat().st_size
        check_claim(prod(counts) * kind.itemsize, size * len(paths), "voxels")
        with path.open("rb") as file:
            file.seek(max(size - prod(each) * kind.itemsize, 0) if start < 0 else min(start, size))
            for _ in range(lines):
                if not file.readline(_PART):
                    break
            with _unpacked(file, packed) as stream:
                if skip and packed:
                    check_claim(skip, size, "bytes before its voxels")
                    stream.read(skip)
                elif skip:
                    file.seek(min(skip, size), os.SEEK_CUR)
                parts.append(voxels(stream, size, kind, each, notes))
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


@contextmanager
def _unpacked(file: BinaryIO, packed: str) -> Iterator[Any]:
    """Give a file's contents from here on, unpacked."""
    if packed == "bzip2":
        with bz2.BZ2File(file) as stream:
            yield stream
    elif packed == "gzip":
        with gzip.GzipFile(fileobj=file) as unpacked:
            yield unpacked
    else:
        yield Inflated(file) if packed else file


def text_numbers(
    text: bytes, kind: np.dtype[Any], counts: tuple[int, ...], notes: list[str]
) -> NDArray[Any]:
    """Return voxels written as text, parted by blanks or commas.

    Raises
    ------
    MeshdepictError
        For what is no number of this type, and more or fewer of them than claimed.
    """
    words = text.replace(b",", b" ").split()
    check_amount(counts, 1, len(words), notes)
    number: Any = int if kind.kind in "iu" else float
    try:
        found = np.fromiter(map(number, words[: prod(counts)]), kind, prod(counts))
    except (ValueError, OverflowError):
        raise MeshdepictError(
            f"is damaged: its voxels are text, and not all of it is numbers of type {kind}"
        ) from None
    return found.reshape(counts[::-1])
