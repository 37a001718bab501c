"""Local dominance (Hesse 2016): how far down one looks from a cell on the land around."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.heights.dominance import dominances
from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shapes.height_field import HeightField

__all__ = ["local_dominance"]

Ring = Annotated[int, Range(1, 1000, help="radius of a ring of cells", soft=(1, 50))]
Bound = Annotated[
    float, Range(0, 1e6, help="dominance at an end of the grey scale; level is 1", soft=(0, 4))
]


def _reads(last: int, *, farthest: int, **_: Any) -> Reads:
    return Reads(around=farthest + 1)


@method(
    local=False, lights="none", needs=("heights",), reads=_reads,
    source="Local dominance (Hesse 2016)",
)  # fmt: skip
def local_dominance(
    space: ScaleSpace,
    light: Any,
    *,
    nearest: Ring = 10,
    farthest: Ring = 20,
    observer: Annotated[
        float, Range(1e-3, 1e6, unit="m", help="height of the eye above the ground", soft=(0.1, 10))
    ] = 1.7,
    darkest: Bound = 0.5,
    brightest: Bound = 1.8,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by how steeply an observer looks down on rings of cells around: rises are bright.

    Shows gentle rises, levelled banks for instance, that hillshade shows faintly; the toolbox's
    rule, and its grey scale.

    Parameters
    ----------
    nearest, farthest : int
        The rings, in cells.
    darkest, brightest : float
        What is shown black and white.
    """
    del light
    for low, high, names in (
        (nearest, farthest + 1, "nearest, farthest"), (darkest, brightest, "darkest, brightest")
    ):  # fmt: skip
        if low >= high:
            raise MeshdepictError(f"local_dominance: {names} are in the wrong order")

    def dominance(field: HeightField) -> NDArray[np.float32]:
        valid = None if field.whole else field.valid
        return dominances(
            field.z, valid,
            nearest=nearest, farthest=farthest, observer=observer,
        )  # fmt: skip

    found = space.from_heights(dominance)
    shown = (found - np.float32(darkest)) / np.float32(brightest - darkest)
    return exposed(np.clip(shown, 0, 1), exposure)
