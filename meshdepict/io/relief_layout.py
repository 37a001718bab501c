"""What a file of relief holds, and where it lies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from meshdepict.heights.cells import Transform

__all__ = ["KINDS", "ReliefLayout"]

KINDS = {"gray": 1, "color": 3, "values": 1}
"""What a cell may hold, and in how many bands."""


@dataclass(frozen=True)
class ReliefLayout:
    """What a file of relief holds, and where it lies.

    Attributes
    ----------
    rows, cols : int
    transform : tuple of six floats
    crs : str
    kind : "gray", "color" or "values"
    point_or_area : str
        What a cell of the input stands for, in GDAL's words.
    lines : tuple of str
        Provenance, a line each.
    words : tuple of (str, str)
        What the input's file says of its data, by names.
    """

    rows: int
    cols: int
    transform: Transform
    crs: str
    kind: str
    point_or_area: str
    lines: tuple[str, ...]
    words: tuple[tuple[str, str], ...] = ()

    @property
    def bands(self) -> int:
        """Bands without the one that says where there is something."""
        return KINDS[self.kind]

    @property
    def dtype(self) -> np.dtype[Any]:
        """The numbers' type."""
        return np.dtype(np.float32 if self.kind == "values" else np.uint8)
