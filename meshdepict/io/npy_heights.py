"""Heights as a NumPy array, mapped into memory: rows from the north, cells of a metre."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.io.height_source import Cells, HeightSource, height_kind, heights_of
from meshdepict.io.height_units import METRES
from meshdepict.io.npy import read_npy

__all__ = ["open_npy_heights"]


def open_npy_heights(path: Path, unit: str) -> HeightSource:
    """Map an array (rows, cols) of heights; NaN are no heights.

    Raises
    ------
    MeshdepictError
        For other shapes, and what is no real number: a clause whose subject is the file.
    """
    contents = read_npy(path)
    values = contents.values
    if values.ndim != 2 or 0 in values.shape:
        shape = " x ".join(map(str, values.shape)) or "a single number"
        raise MeshdepictError(
            f"holds an array that is no grid of heights (rows x columns): {shape}"
        )
    if values.dtype.kind not in "iuf" or values.dtype.itemsize > 8:
        raise MeshdepictError(f"holds numbers of type {values.dtype}, which are no heights")

    def read(rows: slice, cols: slice) -> Cells:
        part = np.asarray(values[rows, cols])
        return heights_of(part, np.ones(part.shape, bool), METRES[unit or "m"], 0)

    rows, cols = values.shape
    source = HeightSource(rows, cols, (1, 0, 0, 0, -1, rows), read, notes=contents.notes)
    source.is_placed = False
    source.kind, source.size = height_kind(values.dtype), path.stat().st_size
    source.notes.append("an array says no place: its cells count as 1 m, rows from the north")
    source.attributes["vertical_unit"] = unit or "m"
    return source
