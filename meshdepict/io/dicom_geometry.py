"""Where the slices of a DICOM series lie: a grid, or a sentence that says why they make none.

ITK takes the distance of the first two slices for all; here every slice's place is looked at.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.dicom_header import Slice

__all__ = ["Stack", "apart_from_the_plane", "stacked"]

_SAME = 1e-3  # spacings (relative) and cosines within it are the same: files have 4 digits and more
_EVEN = 0.05  # of a slice's distance: positions are rounded, by up to 0.01 mm
_PLANE = 0.9  # cosine of the angle within which slices lie in one series' plane
_FEW = 0.25  # of the slices, at most, lie in another plane because they are localisers


@dataclass(frozen=True)
class Stack:
    """Slices from the first along their normal on, and where they are.

    Attributes
    ----------
    slices : list of Slice
    copies : list of (Slice, Slice)
        What was left out, and the same slice that was kept.
    steps : (3, 3) array
        Columns: from voxel to voxel along x, y and z, the last oblique under a tilted gantry.
    tilt : float
        Degrees.
    """

    slices: list[Slice]
    copies: list[tuple[Slice, Slice]]
    steps: NDArray[np.float64]
    tilt: float


def apart_from_the_plane(slices: list[Slice]) -> list[Slice]:
    """Return the few slices that lie across all others: localisers that don't say so."""
    placed = [one for one in slices if one.has_position]
    if len(placed) < 4:
        return []
    normals = np.array([one.direction[:, 2] for one in placed])
    # The plane of most slices: the axis that squared cosines favour.
    main = np.linalg.svd(normals, full_matrices=False)[2][0]
    across = [one for one, n in zip(placed, normals, strict=True) if abs(n @ main) < _PLANE]
    return across if len(across) <= _FEW * (len(placed) - len(across)) else []


def stacked(slices: list[Slice], same: Callable[[Slice, Slice], bool]) -> Stack:
    """Return the slices in the order of their places.

    Parameters
    ----------
    slices : list of Slice
    same : function
        Whether two slices at one place hold the same numbers.

    Raises
    ------
    MeshdepictError
        For slices that make no grid: without position, of different sizes, spacings or
        orientations, at the same place, missing, unevenly spaced, or shifted unevenly.
    """
    _check_alike(slices)
    normal = slices[0].direction[:, 2]
    slices = sorted(slices, key=lambda one: float(one.origin @ normal))
    slices, copies = _without_copies(slices, normal, same)
    origins = np.array([one.origin for one in slices])
    if len(slices) == 1:
        raise MeshdepictError("holds a single slice: gradients need two slices or more")
    step = _even_step(slices, origins @ normal)
    shift, tilt = _lean(slices, origins, normal)
    x, y, _ = slices[0].direction.T
    columns, rows = slices[0].spacing[:2]
    steps = np.stack((x * columns, y * rows, normal * step + shift * step), axis=1)
    return Stack(slices, copies, steps, tilt)


def _check_alike(slices: list[Slice]) -> None:
    first = slices[0]
    for one in slices:
        name = one.name
        if (one.frame is None and one.frames > 1) or (one.among and not one.has_position):
            raise MeshdepictError(
                "holds several files of many slices each, which don't say where they are "
                f"({name}): give the path of one of them"
            )
        if not one.has_position and one.frame is None:
            raise MeshdepictError(f"holds a slice without position and orientation, {name}")
        what = None
        if one.size[:2] != first.size[:2]:
            what = "size in pixels"
        elif not np.allclose(one.spacing[:2], first.spacing[:2], rtol=_SAME, atol=0):
            what = "pixel spacing"
        elif np.abs(one.direction - first.direction).max() > _SAME:
            what = "orientation"
        if what:
            raise MeshdepictError(
                f"holds slices of more than one {what} in one series ({first.name} and "
                f"{name}): move those that don't belong elsewhere"
            )


def _without_copies(
    slices: list[Slice], normal: NDArray[np.float64], same: Callable[[Slice, Slice], bool]
) -> tuple[list[Slice], list[tuple[Slice, Slice]]]:
    """Leave out what is at the place of another slice and holds the same numbers."""
    near = _SAME * float(slices[0].spacing[:2].min())
    kept: list[Slice] = []
    copies = []
    for one in slices:
        height = float(one.origin @ normal)
        beside = []
        for other in reversed(kept):
            if height - float(other.origin @ normal) > near:
                break
            beside.append(other)
        twin = next(
            (
                other
                for other in beside
                if np.abs(one.origin - other.origin).max() <= near and same(one, other)
            ),
            None,
        )
        if twin is None:
            kept.append(one)
        elif len(one.name) < len(twin.name):  # "IM3.dcm" rather than "IM3 (1).dcm"
            kept[kept.index(twin)] = one
            copies.append((twin, one))
        else:
            copies.append((one, twin))
    return kept, copies


def _even_step(slices: list[Slice], heights: NDArray[np.float64]) -> float:
    """Return the distance of the slices along their normal; it has to be one."""
    gaps = np.diff(heights)
    typical = float(np.median(gaps))
    at = int(gaps.argmin())
    if gaps[at] <= _EVEN * typical or typical == 0:
        files = slices[at].frame is not None and slices[at].path != slices[at + 1].path
        advice = ", give the path of one of its files" if files else ""
        raise MeshdepictError(
            f"holds two slices at one place, {_between(slices, at)}: a series of several passes "
            f"is several volumes{advice}"
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


def _lean(
    slices: list[Slice], origins: NDArray[np.float64], normal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Return by how much slices move in their plane for each mm of height, and the angle.

    Nothing where all stay within half a pixel: positions are rounded.
    """
    along = origins - origins[0]
    heights = along @ normal
    moved = along - heights[:, None] * normal
    small = slices[0].spacing[:2].min() / 2
    shift = np.linalg.norm(moved, axis=1)
    at = int(shift.argmax())
    if shift[at] <= small:
        return np.zeros(3), 0.0
    lean = moved[-1] / heights[-1]
    off = np.linalg.norm(moved - heights[:, None] * lean, axis=1)
    angle = float(np.degrees(np.arctan(np.linalg.norm(lean))))
    if off.max() > small:
        raise MeshdepictError(
            f"holds slices that are shifted against each other, {slices[at].name} by "
            f"{shift[at]:.3g} mm, and not evenly as by a tilted gantry: resample it first"
        )
    return lean, angle


def _between(slices: list[Slice], at: int) -> str:
    return f"{slices[at].name} and {slices[at + 1].name}"
