"""Topographic position in three scales (Lindsay, Cockburn and Russell 2015), as a colour."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shapes.height_field import HeightField

__all__ = ["topographic_position"]

Window = Annotated[int, Range(1, 1_000_000, help="cells to the window's edge", soft=(1, 2000))]


def _reads(last: int, *, broad: int, meso: int, local: int, **_: Any) -> Reads:
    return Reads(around=max(broad, meso, local) + 1)


@method(
    local=False, lights="none", needs=("heights",), reads=_reads,
    source="Topographic position (Lindsay, Cockburn and Russell 2015)",
)  # fmt: skip
def topographic_position(
    space: ScaleSpace,
    light: Any,
    *,
    broad: Window = 670,
    meso: Window = 67,
    local: Window = 8,
    lightness: Annotated[
        float, Range(0, 1e6, help="how soon a deviation is bright", soft=(0, 4))
    ] = 1.2,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by how far a cell stands above or below those around it, near and far, as a colour.

    Red is broad, green meso and blue local: ``1 − exp(−lightness |h − mean|/deviation)`` over
    squares of three sizes, which are in the middle of the ranges that the authors search.

    Parameters
    ----------
    broad, meso, local : int
        Radii of the squares, in cells.

    Returns
    -------
    (n, 3) array of float32
        Display values.
    """
    from meshdepict.heights.deviation import deviations  # a kernel, for those who shade

    del light

    def colours(field: HeightField) -> NDArray[np.float32]:
        valid = None if field.whole else field.valid
        return np.stack(
            [deviations(field.z, valid, radius) for radius in (broad, meso, local)],
            axis=2,
        )

    found = np.abs(space.from_heights(colours))
    return exposed(1 - np.exp(np.float32(-lightness) * found), exposure)
