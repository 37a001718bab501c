"""Numbers that may be anything: what NumPy would warn of is for the shapes to refuse."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = ["any_numbers", "quiet", "real_array"]


def any_numbers() -> np.errstate:
    """Return a context, or a decorator, in which a file's numbers are converted without a word.

    They overflow, and some NaN are "signalling", of which NumPy warns at every use: even where one
    becomes a double. Whoever needs finite numbers looks for the others afterwards.
    """
    return np.errstate(over="ignore", under="ignore", invalid="ignore")


def quiet(values: Any) -> Any:
    """Return an array in which no NaN is signalling, the same one where there is no NaN at all."""
    array: NDArray[Any] = np.asarray(values)
    if array.dtype.kind != "f" or not np.isnan(array).any():
        return values
    with any_numbers():
        return array * array.dtype.type(1)  # exact, but for the kind of NaN


def real_array(given: ArrayLike, kind: DTypeLike = np.float64) -> NDArray[Any] | None:
    """Return real numbers as a new array, rows first; None of texts, dates, complex numbers, ….

    What is beyond the largest number of its kind becomes infinite, and NaN what a mask hides:
    whoever needs finite numbers looks for the others afterwards.
    """
    try:
        array = np.asanyarray(given)
        if array.dtype.kind not in "biufO":  # NumPy would make numbers of texts and dates
            return None
        with any_numbers():
            found = np.array(array, kind, order="C")
    except (TypeError, ValueError, OverflowError):
        return None
    if isinstance(array, np.ma.MaskedArray):
        found[np.ma.getmaskarray(array)] = np.nan
    return found
