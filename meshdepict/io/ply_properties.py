"""Arrays at vertices and faces as PLY properties: which names and types they get."""

from __future__ import annotations

import re
import warnings
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictWarning
from meshdepict.io.ply_header import NAMES, Property

__all__ = ["as_properties", "exact_float"]


def as_properties(
    attributes: Mapping[str, NDArray[Any]], taken: Collection[str]
) -> tuple[list[Property], dict[str, NDArray[Any]]]:
    """Return scalar properties that hold the attributes, and their columns by name.

    Arrays of several numbers per row become ``name_0``, ``name_1``, …, normals ``nx``, ``ny``,
    ``nz``. What PLY has no type for is left out, with a warning.
    """
    columns: dict[str, NDArray[Any]] = {}
    for name, values in attributes.items():
        typed = _typed(values)
        if typed is None:
            warnings.warn(
                f"the attribute {name!r} is left out: PLY holds numbers, not {values.dtype}",
                MeshdepictWarning,
                stacklevel=2,
            )
            continue
        parts = _part_names(name, values)
        table = typed.reshape(len(typed), len(parts))
        for part, column in zip(parts, table.T, strict=True):
            columns[_free_name(part, [*taken, *columns])] = column
    return [Property(name, column.dtype.str[1:]) for name, column in columns.items()], columns


def exact_float(values: NDArray[Any]) -> str:
    """Return ``"f4"`` where single precision holds all values exactly, else ``"f8"``."""
    with np.errstate(over="ignore"):
        exact = np.array_equal(values.astype(np.float32), values, equal_nan=True)
    return "f4" if exact else "f8"


def _typed(values: NDArray[Any]) -> NDArray[Any] | None:
    """Return values in a type that PLY has, the same one where possible."""
    native = values.dtype.newbyteorder("=")
    if native.str[1:] in NAMES:
        return values.astype(native, copy=False)
    if native.kind == "b":
        return values.astype(np.uint8)
    if native.kind in "iu":
        for kind in (np.int32, np.uint32):
            limits = np.iinfo(kind)
            if ((values >= limits.min) & (values <= limits.max)).all():
                return values.astype(kind)
        return values.astype(np.float64)
    if native.kind == "f":
        return values.astype(np.float32 if native.itemsize < 4 else np.float64)
    return None


def _part_names(name: str, values: NDArray[Any]) -> list[str]:
    if values.ndim == 1:
        return [name]
    parts = int(np.prod(values.shape[1:]))
    if name.lower() in ("normal", "normals") and parts == 3:
        return ["nx", "ny", "nz"]
    return [f"{name}_{part}" for part in range(parts)]


def _free_name(name: str, taken: Collection[str]) -> str:
    """Return the name as one word of ASCII that isn't taken."""
    word = re.sub(r"[^!-~]+", "_", name) or "_"
    number = 1
    free = word
    while free in taken:
        number += 1
        free = f"{word}_{number}"
    return free
