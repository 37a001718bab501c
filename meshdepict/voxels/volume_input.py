"""What a volume is made of, checked once at the door: values, spacing, direction, rescaling."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import real_array

__all__ = [
    "as_list",
    "checked_direction",
    "checked_values",
    "fitting_integer",
    "three_numbers",
]

Floats = NDArray[np.float64]

_LONGEST = 250  # letters of what is shown in a message
_SKEW = 1e-3  # directions in files have 4 digits and more; what is skewed is so by much more


def fitting_integer(low: float, high: float) -> Any:
    """Return the narrowest integer type from 16 bits on that holds a range."""
    for kind in (np.int16, np.uint16, np.int32):
        if np.iinfo(kind).min <= low and high <= np.iinfo(kind).max:
            return kind
    return np.int64


def checked_values(values: ArrayLike) -> NDArray[Any]:
    """Return values as a C-ordered array (nz, ny, nx) of native numbers, copied only if it must.

    Raises
    ------
    MeshdepictError
        For other things than real numbers, another shape, none at all, a single slice.
    """
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError):
        raise MeshdepictError(
            "a volume is an array of numbers with three axes (z, y, x), and a "
            f"{type(values).__name__} like this makes none"
        ) from None
    hidden = int(np.count_nonzero(getattr(values, "mask", False)))
    if isinstance(values, np.ma.MaskedArray) and hidden:
        raise MeshdepictError(
            f"the volume has {hidden:,} masked values: fill them with the value of air, "
            "values.filled(-1000)"
        )
    if array.dtype.kind not in "biuf":
        raise MeshdepictError(f"a volume's values must be real numbers, not {array.dtype}")
    if array.dtype.itemsize > 8:
        raise MeshdepictError(
            f"a volume's values must have 64 bits or fewer, not {array.dtype}: convert them to "
            "float64"
        )
    if array.ndim != 3:
        raise MeshdepictError(
            f"a volume is a grid of three axes (z, y, x), not an array of shape {array.shape}"
        )
    if array.size == 0:
        raise MeshdepictError(f"the volume is empty: its shape is {array.shape}")
    if min(array.shape) < 2:
        axis = "zyx"[int(np.argmin(array.shape))]
        raise MeshdepictError(
            f"the volume has a single slice along {axis}: gradients need two slices or more"
        )
    kind = {"b1": np.uint8, "f2": np.float32}.get(
        array.dtype.str[1:], array.dtype.newbyteorder("=")
    )
    return np.require(array, kind, ["C"])


def three_numbers(numbers: ArrayLike, what: str) -> Floats:
    """Return three finite numbers.

    Raises
    ------
    MeshdepictError
        For anything else.
    """
    array = _floats(numbers)
    if array.shape != (3,) or not np.isfinite(array).all():
        shown = repr(numbers)
        shown = shown if len(shown) <= _LONGEST else f"{shown[:_LONGEST]}…"
        raise MeshdepictError(f"{what}={shown} is not three finite numbers (x, y, z)")
    return array


def checked_direction(direction: ArrayLike) -> Floats:
    """Return the nearest orthonormal matrix: files round theirs.

    Raises
    ------
    MeshdepictError
        For a matrix that is not nearly orthonormal, or none of 3 x 3 finite numbers.
    """
    matrix = _floats(direction)
    error = np.inf
    if matrix.shape == (3, 3) and np.abs(matrix).max() < 2:  # not NaN either
        error = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    if error > _SKEW:
        shown = repr(matrix.tolist() if matrix.shape == (3, 3) else direction)
        shown = shown if len(shown) <= _LONGEST else f"{shown[:_LONGEST]}…"
        raise MeshdepictError(
            f"direction={shown} is not a 3 x 3 matrix of orthonormal columns: resample a skewed "
            "grid first"
        )
    if error < 1e-14:
        return matrix
    u, _, vh = np.linalg.svd(matrix)
    nearest = u @ vh
    # One step of Newton's: what rounding left, a few steps of double precision, becomes one or two.
    return nearest @ (1.5 * np.eye(3) - 0.5 * (nearest.T @ nearest))


def _floats(numbers: ArrayLike) -> Floats:
    """Return real numbers as an array, an empty one where they are none."""
    array = real_array(numbers)
    return np.empty(0) if array is None else array


def as_list(numbers: Floats) -> str:
    """Return numbers for a message."""
    return "(" + ", ".join(f"{number:.6g}" for number in numbers) + ")"
