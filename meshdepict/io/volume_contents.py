"""What a volume's file holds, as its reader found it, and how a header's claims are believed.

A header's counts are claims, the file's size is the fact: nothing is allocated before both agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.voxels.volume_input import fitting_integer

__all__ = [
    "VolumeContents", "check_amount", "printable", "rescaled", "several_values", "three_counts",
]  # fmt: skip

_ABSURD = 50  # a header that claims so many times what there is isn't one of a file cut off


@dataclass
class VolumeContents:
    """Values and what is known of them.

    Attributes
    ----------
    values : (nz, ny, nx) array
    place : dict
        Of the keywords `spacing`, `origin` and `direction` of `Volume` those that the file says.
    hounsfield : bool
    length_unit : str
        What spacing and origin are in; "" where the file doesn't say.
    attributes : dict of str
    notes : list of str
        What was assumed or left out: clauses whose subject is the file, or that need none.
    """

    values: NDArray[Any]
    place: dict[str, Any] = field(default_factory=dict)
    hounsfield: bool = False
    length_unit: str = ""
    attributes: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def check_amount(counts: tuple[int, ...], itemsize: int, found: int, notes: list[str]) -> None:
    """Compare the voxels that a header claims with the bytes that are there.

    Parameters
    ----------
    counts : tuple of int
        Voxels along x, y, z: the claim.
    itemsize : int
        Bytes of a voxel.
    found : int
        Bytes that are there for them; to see that there are too many, a slice more is enough.
    notes : list of str
        Gets a clause where a few bytes are left over.

    Raises
    ------
    MeshdepictError
        For fewer bytes than claimed, and for a slice or more beyond.
    """
    size = " x ".join(f"{count:,}" for count in counts)
    needed = itemsize
    for count in counts:  # Python's integers: a claim never overflows
        needed *= count
    if found < needed:
        if needed > _ABSURD * max(found, 1):
            raise MeshdepictError(
                "is damaged or cut off: its header claims far more voxels than the file holds"
            )
        raise MeshdepictError(
            f"is cut off: it holds {100 * found / needed:.3g} % of the {size} voxels that its "
            "header claims"
        )
    if found - needed >= needed // counts[-1]:
        raise MeshdepictError(
            f"holds more voxels than the {size} that its header claims: correct the header"
        )
    if found > needed:
        notes.append(f"{found - needed:,} bytes after the voxels are left aside")


def three_counts(counts: Sequence[int]) -> tuple[int, int, int]:
    """Return the voxels along x, y and z of a file that says them; further axes hold one.

    Raises
    ------
    MeshdepictError
        For other numbers of axes, and counts that are none.
    """
    if not counts or not all(1 <= count < 1 << 40 for count in counts):
        raise MeshdepictError("is damaged: its header says an impossible number of voxels")
    several = [count for count in counts[3:] if count > 1]
    if len(counts) < 3 or several:
        kept = counts if len(counts) < 3 else [*counts[:3], *several]
        size = " x ".join(map(str, kept))
        advice = "extract one volume first" if several else "a volume has x, y and z"
        raise MeshdepictError(f"has {len(kept)} dimensions ({size}), not three: {advice}")
    return counts[0], counts[1], counts[2]


def several_values(count: int) -> MeshdepictError:
    """Return the refusal of a volume with several values in a voxel."""
    what = {3: "colours", 4: "colours", 2: "complex numbers"}.get(count, "channels")
    return MeshdepictError(
        f"has {count:,} values in a voxel, not one: take one of the {what}' parts, or their "
        "grey values, as a volume of its own"
    )


_WHOLE = 2.0**31  # beyond it products of 32-bit numbers leave 64 bits


def rescaled(values: NDArray[Any], slope: float, intercept: float) -> NDArray[Any]:
    """Return ``slope · values + intercept``: integers where all of them are, narrow, else floats.

    Floats are of 32 bits where the values' own precision is no higher.
    """
    if (slope, intercept) == (1, 0):
        return values
    whole = all(float(x).is_integer() and abs(x) < _WHOLE for x in (slope, intercept))
    if whole and values.dtype.kind in "iu" and values.dtype.itemsize <= 4:
        ends = [int(slope) * int(end) + int(intercept) for end in (values.min(), values.max())]
        kind = fitting_integer(min(ends), max(ends))
        return (values.astype(np.int64) * int(slope) + int(intercept)).astype(kind)
    with np.errstate(over="ignore", invalid="ignore"):  # `Volume` refuses what is not finite
        found = values * np.float64(slope) + intercept
        wide = values.dtype.itemsize > 4 and values.dtype.kind == "f"
        return found if wide else found.astype(np.float32)


def printable(text: str) -> str:
    """Return a file's text without what a terminal would obey."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
