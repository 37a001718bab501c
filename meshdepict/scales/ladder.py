"""The ladder of a scale space: its widths, what they may be, and progress along it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import real

__all__ = [
    "FACING",
    "MEMORY",
    "TOLERANCE",
    "Progress",
    "check_ladder",
    "checked_scale",
    "checked_scales",
    "ladder",
    "reporter",
]

FACING = 1
TOLERANCE = 1e-4
"""What scale spaces are made with unless somebody says otherwise: see `scale_space`."""

MEMORY = 2e9
"""Bytes that the normals of a volume's voxels may take unless more is allowed."""

Progress = Callable[[float, float], None]


def ladder(scales: int, ratio: float, first: float) -> NDArray[np.float64]:
    """Return the widths (scales + 1,): 0, then the first one and its followers.

    Raises
    ------
    MeshdepictError
        Where they grow beyond all numbers.
    """
    with np.errstate(over="ignore"):
        widths = np.concatenate(([0.0], first * ratio ** np.arange(scales, dtype=float)))
    if not np.isfinite(widths).all():
        raise MeshdepictError(f"{scales} scales of ratio {ratio:g} grow beyond all numbers")
    return widths


def check_ladder(scales: int, ratio: float, facing: int, tolerance: float) -> None:
    """Refuse parameters of a scale space that are out of their range, or of another type."""
    count, step, angle = map(real, (scales, ratio, tolerance))
    if count is None or not count.is_integer() or not 0 <= count <= 64:
        raise MeshdepictError(f"scales={scales!r} is not a whole number from 0 to 64")
    if step is None or not 1 < step <= 10:
        raise MeshdepictError(f"ratio={ratio!r} is not a number above 1 and up to 10")
    if real(facing) not in (0, 1) and not isinstance(facing, bool):
        raise MeshdepictError(f"facing={facing!r} is neither 0 (the paper's sum) nor 1")
    if angle is None or not 1e-7 <= angle <= 0.1:
        raise MeshdepictError(f"tolerance={tolerance!r} is not an angle from 1e-7 to 0.1 radians")


def checked_scale(scale: int, last: int) -> int:
    """Return the number of a scale; refuse what is none of 0 to the last."""
    whole = real(scale)
    if whole is None or whole not in range(last + 1):
        raise MeshdepictError(
            f"scale={scale!r} is not one of the scale space's, 0 to {last}; make more with scales=…"
        )
    return int(scale)


def checked_scales(scales: Iterable[int] | None, last: int) -> set[int]:
    """Return the numbers of some scales, of all where none are given; refuse what are none."""
    if scales is None:
        return set(range(last + 1))
    try:
        given = list(scales)
    except TypeError:
        raise MeshdepictError(
            f"{scales!r:.80} are no scales: give numbers, (0, 1, 2) for instance"
        ) from None
    return {checked_scale(scale, last) for scale in given}


def reporter(progress: Progress | None, scale: int, scales: int) -> Callable[[float], None] | None:
    """Turn shares of one scale's work into ``progress(done, total)`` over all scales."""
    if progress is None:
        return None
    finished = 0.0

    def done(share: float) -> None:
        nonlocal finished
        finished = min(finished + share, 1.0)
        progress(scale - 1 + finished, scales)

    return done
