"""Where heights come from: a raster's size, place and units; its cells as they are asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.files.any_numbers import any_numbers
from meshdepict.heights.cells import Transform
from meshdepict.io.height_units import METRES, height_unit

__all__ = [
    "INFINITE",
    "WORDS",
    "Cells",
    "HeightSource",
    "height_kind",
    "heights_of",
    "note_units",
    "whole_array",
]

INFINITE = "infinite cells count as cells without a height"
"""The note on them."""


class Cells(NamedTuple):
    """Heights in metres, 0 where there are none; where there are some; and whether any was ∞."""

    z: NDArray[Any]
    valid: NDArray[np.bool_]
    infinite: bool = False


_NOTHING = 1e30  # no mountain; files that forget to say so mark cells without height by -3.4e38


WORDS = "tag "
"""How the attributes begin that are a file's own words of its data; relief takes them over."""


@dataclass
class HeightSource:
    """A raster of heights, opened but not read.

    Attributes
    ----------
    rows, cols : int
    transform : tuple of six floats
        From columns and rows, counted from the first cell's corner, to x and y.
    read : callable
        ``read(rows, cols)``, of two slices with steps of 1, returns their `Cells`.
    crs : str
    degrees : bool
    unit : float
        Metres of a unit of the transform.
    attributes : dict
        What else the file says.
    notes : list of str
        What was assumed: clauses whose subject is the file, or that need none.
    kind : dtype
        Of the heights.
    is_placed : bool
        Whether the file says where its cells lie.
    size : int
        Of its files, in bytes.
    release : callable
        Gives back what is kept for the next reading.
    """

    rows: int
    cols: int
    transform: Transform
    read: Callable[[slice, slice], Cells]
    crs: str = ""
    degrees: bool = False
    unit: float = 1.0
    attributes: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    kind: np.dtype[Any] = np.dtype(np.float32)  # noqa: RUF009 - a dtype never changes
    is_placed: bool = True
    size: int = 0
    release: Callable[[], None] = lambda: None


def heights_of(raw: NDArray[Any], valid: NDArray[np.bool_], scale: float, offset: float) -> Cells:
    """Return a file's numbers as heights: scaled, in floats, 0 where there are none.

    Numbers of up to 16 bits, and floats of 32, become floats of 32 bits, all others of 64. What is
    not finite, or absurdly large, counts as no height.
    """
    with any_numbers():
        kind = height_kind(raw.dtype)
        z = raw.astype(kind)
        if (scale, offset) != (1, 0):
            z = (z.astype(np.float64) * scale + offset).astype(kind)
        there = valid & (np.abs(z) < _NOTHING)
    odd = z[valid & ~there]
    z[~there] = 0
    return Cells(z, there, bool(np.isinf(odd).any()))


def height_kind(kind: np.dtype[Any]) -> np.dtype[Any]:
    """Return the type of float that holds a type of number, 32 bits where they do."""
    wide = kind.itemsize > (4 if kind.kind == "f" else 2)
    return np.dtype(np.float64 if wide else np.float32)


def whole_array(z: NDArray[Any], valid: NDArray[np.bool_]) -> Callable[[slice, slice], Cells]:
    """Return what reads parts of heights that are in memory."""

    def read(rows: slice, cols: slice) -> Cells:
        return Cells(z[rows, cols].copy(), valid[rows, cols].copy())

    return read


def note_units(
    source: HeightSource, said: str, vertical: float | None, chosen: str, notes: list[str]
) -> float:
    """Return how many metres a unit of a file's heights is, and note what was assumed.

    Parameters
    ----------
    source : HeightSource
        For its CRS; gets the attribute "vertical_unit".
    said : str
        The unit that the file says beside its heights; "" where it doesn't.
    vertical : float or None
        Metres of the unit of the CRS's heights.
    chosen : str
        The unit that somebody chose, "" for none.
    notes : list of str
    """
    name = chosen or height_unit(said)
    if not name and vertical is not None:
        near = [n for n, metres in METRES.items() if abs(metres / vertical - 1) < 1e-9]
        source.attributes["vertical_unit"] = near[0] if near else f"{vertical:.12g} m"
        return METRES[near[0]] if near else vertical
    if not name:
        name = "m"
        if said.strip():
            notes.append(
                f"the unit of its heights, {said.strip()[:40]!r}, is unknown: metres are taken"
            )
        elif source.degrees:
            notes.append("it doesn't say in which unit its heights are: metres are taken")
        elif source.unit != 1:
            notes.append(
                "its cells are in feet, or another unit, and its heights in none: metres are taken "
                "for them (unit=, --height-unit)"
            )
    source.attributes["vertical_unit"] = name
    return METRES[name]
