"""Where the slices of a DICOM series lie: a grid, or a sentence that says why they make none.

ITK takes the distance of the first two slices for all; here every slice's place is looked at.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from meshdepict.io.dicom import Slice

__all__ = ["stacked_place"]

_SAME = 1e-3  # spacings (relative) and cosines within it are the same: files have 4 digits and more
_EVEN = 0.05  # of a slice's distance: positions are rounded, by up to 0.01 mm


def stacked_place(slices: list[Slice]) -> tuple[list[Slice], dict[str, Any]]:
    """Return the slices from the first along their normal on, and their grid's place.

    Raises
    ------
    MeshdepictError
        For slices that make no grid: without position, of different sizes, spacings or
        orientations, at the same place, missing, unevenly spaced, or shifted (a tilted gantry).
    """
    _check_alike(slices)
    normal = slices[0].direction[:, 2]
    slices = sorted(slices, key=lambda one: float(one.origin @ normal))
    origins = np.array([one.origin for one in slices])
    if len(slices) == 1:
        raise MeshdepictError("holds a single slice: gradients need two slices or more")
    step = _even_step(slices, origins @ normal)
    _check_straight(slices, origins, normal)
    spacing = np.array([*slices[0].spacing[:2], step])
    return slices, {"spacing": spacing, "origin": origins[0], "direction": slices[0].direction}


def _check_alike(slices: list[Slice]) -> None:
    first = slices[0]
    for one in slices:
        name = one.path.name
        if one.frames > 1:
            raise MeshdepictError(
                f"holds several files of many slices each ({name}): give the path of one of them"
            )
        if not one.has_position:
            raise MeshdepictError(f"holds a slice without position and orientation, {name}")
        what = None
        if one.size != first.size:
            what = "size in pixels"
        elif not np.allclose(one.spacing[:2], first.spacing[:2], rtol=_SAME, atol=0):
            what = "pixel spacing"
        elif np.abs(one.direction - first.direction).max() > _SAME:
            what = "orientation"
        if what:
            raise MeshdepictError(
                f"holds slices of more than one {what} in one series ({first.path.name} and "
                f"{name}): move those that don't belong elsewhere"
            )


def _even_step(slices: list[Slice], heights: NDArray[np.float64]) -> float:
    """Return the distance of the slices along their normal; it has to be one."""
    gaps = np.diff(heights)
    typical = float(np.median(gaps))
    at = int(gaps.argmin())
    if gaps[at] <= _EVEN * typical or typical == 0:
        raise MeshdepictError(
            f"holds two slices at one place, {_between(slices, at)}: a series of several passes "
            "is several volumes"
        )
    odd = np.abs(gaps - typical) > _EVEN * typical
    if odd.any():
        at = int(odd.argmax())
        lacking = round(gaps[at] / typical) - 1
        whole = abs(gaps[at] - (lacking + 1) * typical) <= _EVEN * typical
        where = (
            f"{_between(slices, at)}, {heights[at]:.6g} and {heights[at + 1]:.6g} mm along "
            "their normal"
        )
        if lacking > 0 and whole:
            count = "a slice is" if lacking == 1 else f"{lacking} slices are"
            raise MeshdepictError(
                f"lacks slices: {count} missing between {where} (elsewhere every {typical:.6g} mm)"
            )
        raise MeshdepictError(
            f"holds unevenly spaced slices: {gaps[at]:.6g} mm between {where}, elsewhere "
            f"{typical:.6g} mm; resample it first"
        )
    return float(heights[-1] - heights[0]) / len(gaps)


def _check_straight(
    slices: list[Slice], origins: NDArray[np.float64], normal: NDArray[np.float64]
) -> None:
    along = origins - origins[0]
    shift = np.linalg.norm(along - (along @ normal)[:, None] * normal, axis=1)
    at = int(shift.argmax())
    if shift[at] > slices[0].spacing[:2].min() / 2:
        angle = np.degrees(np.arctan2(shift[at], along[at] @ normal))
        raise MeshdepictError(
            f"holds slices that are shifted against each other, {slices[at].path.name} by "
            f"{shift[at]:.3g} mm: the gantry was tilted by {angle:.3g}°; resample it first"
        )


def _between(slices: list[Slice], at: int) -> str:
    return f"{slices[at].path.name} and {slices[at + 1].path.name}"
