"""Vectors as they come in: finite, read-only, of unit length."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import real_array

__all__ = ["Vector", "cosines", "frozen", "in_frame", "numbers_of", "unit"]

Vector = NDArray[np.float64]


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Make an array read-only, and return it."""
    array.setflags(write=False)
    return array


def cosines(vectors: NDArray[Any], direction: ArrayLike) -> NDArray[Any]:
    """Return the products (n,) of vectors (n, 3) with a direction (3,), in the vectors' type.

    Of each vector the same bits wherever it stands among the others, which a product of matrices
    doesn't give: windows of a raster then have no seams.
    """
    x, y, z = np.asarray(direction, vectors.dtype)
    products: NDArray[Any] = vectors[:, 0] * x + vectors[:, 1] * y + vectors[:, 2] * z
    return products


def in_frame(vectors: NDArray[Any], axes: ArrayLike) -> NDArray[Any]:
    """Return coordinates (n, k) of vectors (n, 3) along axes (k, 3); see `cosines`."""
    return np.stack([cosines(vectors, axis) for axis in np.asarray(axes)], axis=1)


def numbers_of(given: object) -> Vector:
    """Return a new read-only array of finite numbers, an empty one where that is impossible."""
    array = real_array(given)  # type: ignore[arg-type]
    if array is None or not np.isfinite(array).all():
        array = np.empty(0)
    array.setflags(write=False)
    return array


def unit(vector: ArrayLike, what: str) -> Vector:
    """Return a read-only unit vector; ``what`` it is goes into the sentence if it can't be one."""
    array = numbers_of(vector)
    if array.shape != (3,) or not array.any():
        raise MeshdepictError(f"{what} must be three finite numbers, not all zero, not {vector!r}")
    array = array / np.abs(array).max()  # so that squares neither overflow nor vanish
    array /= np.linalg.norm(array)
    array.setflags(write=False)
    return array
