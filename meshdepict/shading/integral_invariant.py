"""Multi-scale integral invariant (Mara 2010): balls about a point, and what of them is below it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["integral_invariant", "settle"]

_RADIUS, _BALLS = 16.0, 3
_LEVEL = 1e-6  # of a ball: what is missing on a plane, by rounding
_CLIPPED = 0.02  # share of the samples that contrast may take to black or white
_USUAL = 5.0  # contrast of what is never whole at hand


def settle(space: ScaleSpace | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the contrast: as given, else as uses the grey scale of the shape."""
    given = options.get("contrast")
    if given is not None or space is None:
        return {"contrast": _USUAL if given is None else given}
    missing = _missing(
        space.typical(), options.get("radius", _RADIUS), options.get("balls", _BALLS)
    )
    high = float(np.quantile(np.abs(missing), 1 - _CLIPPED)) if len(missing) else 0.0
    return {"contrast": float(f"{0.5 / high:.3g}") if high > _LEVEL else _USUAL}


def _missing(space: ScaleSpace, radius: float, balls: int) -> NDArray[np.float64]:
    """Return what is missing to half a ball, on average."""
    largest = radius * space.shape.edge_length / (space.shape.diagonal or 1.0)
    if not largest > 0:
        return np.zeros(space.count)
    shares = space.ball_shares([largest / 2**k for k in range(balls)])
    found: NDArray[np.float64] = 0.5 - shares.mean(axis=0)
    return found


@method(
    local=False, lights="none", needs=("areas",), fits=settle,
    reads=lambda last, *, radius, **_: Reads(frozenset((0,)), around=radius + 1),
    source="Multi-scale integral invariants (Mara, Krömker, Jakob and Breuckmann 2010)",
)  # fmt: skip
def integral_invariant(
    space: ScaleSpace,
    light: Any,
    *,
    radius: Annotated[
        float, Range(1, 1000, help="of the largest ball, in edge lengths", soft=(2, 64))
    ] = _RADIUS,
    balls: Annotated[int, Range(1, 8, help="how many, each half as large as the last")] = _BALLS,
    contrast: Annotated[
        float | None, Range(0, 1e6, help="factor on what is missing to a half", soft=(0, 20))
    ] = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by how much of balls about a point lies below the surface: less than half is bright.

    Wedges and scratches come out dark and strokes' rims bright, whatever the light: what
    epigraphers read tablets by. ``½ + contrast · mean(½ − share)`` over all balls; a share is the
    integral ``½ + (1/4πr³) Σ_{‖d‖<r} A (d·n)(1 − r³/‖d‖³)`` over the surface in the ball.

    Parameters
    ----------
    contrast : float, optional
        Unless given, what takes a fiftieth of the samples to black or white.
    """
    del light
    given = settle(space, {"radius": radius, "balls": balls, "contrast": contrast})["contrast"]
    values = 0.5 + given * _missing(space, radius, balls)
    return exposed(values.astype(np.float32), exposure)
