"""NumPy's arrays, mapped into memory."""

from __future__ import annotations

import math
import tokenize
import warnings
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.io.volume_contents import VolumeContents, check_amount

__all__ = ["npy_header", "read_npy"]

_FAULTS = (
    ValueError, EOFError, TypeError, KeyError, SyntaxError, OverflowError, MemoryError,
    RecursionError, AttributeError, tokenize.TokenError, UnicodeError,
)  # fmt: skip


def read_npy(path: Path) -> VolumeContents:
    """Return an array (z, y, x) of a file, which stays on the disk.

    Raises
    ------
    MeshdepictError
        For a damaged file, objects instead of numbers, and another number of them than claimed:
        one clause whose subject is the file.
    """
    notes: list[str] = []
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(4) == b"PK\3\4":
            raise MeshdepictError(
                "is an archive of arrays (.npz): save one of them with numpy.save"
            )
        file.seek(0)
        shape, kind = npy_header(file)
        start = file.tell()
    if kind.hasobject:
        raise MeshdepictError(
            "holds Python objects, not numbers: save it with numpy.save as floats"
        )
    if not all(isinstance(n, int) and 0 <= n < 1 << 60 for n in shape):
        raise MeshdepictError("is damaged: its header says an impossible shape")
    if math.prod(shape) and kind.itemsize:
        counts = (*shape[::-1],) or (1,)
        check_amount(counts, kind.itemsize, size - start, notes)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            values = np.load(path, mmap_mode="r", allow_pickle=False)
    except _FAULTS as error:
        text = str(error).partition("\n")[0][:100]
        raise MeshdepictError(f"is cut off, damaged or no array: {text}") from error
    return VolumeContents(values, notes=notes)


def npy_header(file: BinaryIO) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Return the shape and the type that a file at its beginning says of its array.

    Raises
    ------
    MeshdepictError
        For what is no array: a clause whose subject is the file.
    """
    try:
        version = np.lib.format.read_magic(file)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote
            if version == (1, 0):
                shape, _, kind = np.lib.format.read_array_header_1_0(file)
            else:
                shape, _, kind = np.lib.format.read_array_header_2_0(file)
    except _FAULTS as error:
        text = str(error).partition("\n")[0][:100]
        raise MeshdepictError(f"is cut off, damaged or no array: {text}") from error
    return shape, kind
