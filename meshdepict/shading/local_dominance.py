"""Local dominance (Hesse 2016): how far down one looks from a cell on the land around."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.spans import reach
from meshdepict.errors import MeshdepictError
from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["local_dominance", "settle"]

# The rule, and the grey scale, of the Relief Visualization Toolbox.
_NEAREST, _FARTHEST, _OBSERVER = 10, 20, 1.7
_DARKEST, _BRIGHTEST = 0.5, 1.8
_CLIPPED = 0.05  # share of the samples that may be white where these are steeper

Ring = Annotated[int, Range(1, 1000, help="radius of a ring of cells", soft=(1, 50))]


def settle(space: ScaleSpace | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is shown white: as given, else the toolbox's or what few samples are above."""
    given = options.get("brightest")
    if given is not None or space is None:
        return {"brightest": _BRIGHTEST if given is None else given}
    usual = {"nearest": _NEAREST, "farthest": _FARTHEST, "observer": _OBSERVER}
    rule = {name: options.get(name, default) for name, default in usual.items()}
    values = _dominance(space.typical(), **rule)
    high = float(np.quantile(values, 1 - _CLIPPED)) if len(values) else 0.0
    return {"brightest": max(float(f"{high:.3g}"), _BRIGHTEST)}


def _dominance(space: ScaleSpace, **rule: Any) -> NDArray[np.float32]:
    from meshdepict.heights.dominance import dominances  # a kernel, for those who shade

    if rule["nearest"] > rule["farthest"]:
        raise MeshdepictError(
            f"local_dominance: nearest={rule['nearest']} is beyond farthest={rule['farthest']}: "
            "rings go from the first to the second"
        )
    return space.from_heights(
        lambda field: dominances(field.z, None if field.whole else field.valid, **rule)
    )


def _reads(last: int, *, farthest: int, **_: Any) -> Reads:
    return Reads(around=farthest + 1)


@method(
    local=False, lights="none", needs=("heights",), fits=settle, reads=_reads,
    source="Local dominance (Hesse 2016)",
)  # fmt: skip
def local_dominance(
    space: ScaleSpace,
    light: Any,
    *,
    nearest: Ring = _NEAREST,
    farthest: Ring = _FARTHEST,
    observer: Annotated[
        float, Range(1e-3, 1e6, unit="m", help="height of the eye above the ground", soft=(0.1, 10))
    ] = _OBSERVER,
    darkest: Annotated[
        float, Range(0, 1e6, help="dominance shown black; level land has 1", soft=(0, 1))
    ] = _DARKEST,
    brightest: Annotated[
        float | None, Range(0, 1e30, help="dominance shown white", soft=(1, 4))
    ] = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by how steeply an observer looks down on rings of cells around: rises are bright.

    Shows gentle rises, levelled banks for instance, that hillshade shows faintly.

    Parameters
    ----------
    nearest, farthest : int
        The rings, in cells.
    darkest, brightest : float
        What is shown black and white. Unless given, white is the toolbox's 1.8, or what 5 % of
        the samples are above where that is more.
    """
    del light
    rule = {"nearest": nearest, "farthest": farthest, "observer": observer}
    high = settle(space, {**rule, "brightest": brightest})["brightest"]
    if darkest >= high:
        raise MeshdepictError(
            f"local_dominance: darkest={darkest:g} is not below brightest={high:g}: between them "
            "the grey scale lies"
        )
    shown = (_dominance(space, **rule) - np.float32(darkest)) / np.float32(reach(darkest, high))
    return exposed(np.clip(shown, 0, 1), exposure)
