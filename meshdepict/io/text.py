"""Numbers in text, many at a time."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.polygons import Polygons

__all__ = ["corners", "floats", "integers", "rows", "spelled"]


def floats(text: bytes) -> NDArray[np.float64]:
    """Return the numbers in a text, separated by any white space.

    Raises
    ------
    ValueError
        Where something is no number.
    """
    return _parsed(text, np.float64)


def integers(text: bytes) -> NDArray[np.int64]:
    """Return the whole numbers in a text; ten times as fast as `floats`.

    Raises
    ------
    ValueError
        Where something is no whole number; ``1.0`` isn't one here.
    """
    return _parsed(text, np.int64)


def _parsed(text: bytes, kind: type) -> NDArray[Any]:
    if not text or text.isspace():  # NumPy finds a −1 in blanks
        return np.empty(0, kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # NumPy < 2.4 only warns of a misfit
        try:
            return np.fromstring(text, kind, sep=" ")
        except DeprecationWarning as misfit:
            raise ValueError(str(misfit)) from None


def spelled(values: NDArray[Any]) -> list[bytes]:
    """Return numbers as short texts that read back as the same numbers of their type."""
    if values.dtype == np.float32:
        return [b"%.9g" % value for value in values.tolist()]
    return [repr(value).encode() for value in values.tolist()]


def rows(template: str, *columns: NDArray[Any] | Sequence[str]) -> bytes:
    """Return the template filled with every row of the columns; ``%r`` keeps doubles exactly."""
    listed = [c.tolist() if isinstance(c, np.ndarray) else c for c in columns]
    return "".join([template % row for row in zip(*listed, strict=True)]).encode()


def corners(polygons: Polygons, *, first: int = 0) -> list[str]:
    """Return the corners of every polygon as one text, vertices being numbered from ``first``."""
    connectivity = polygons.connectivity + first
    sizes = np.diff(polygons.offsets)
    if len(sizes) and (sizes == sizes[0]).all():
        template = " ".join(["%d"] * int(sizes[0]))
        table = connectivity.reshape(len(sizes), -1)
        return [template % row for row in zip(*table.T.tolist(), strict=True)]
    words = list(map(str, connectivity.tolist()))
    return [" ".join(words[start:stop]) for start, stop in pairwise(polygons.offsets.tolist())]
