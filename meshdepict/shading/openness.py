"""Openness (Yokoyama, Shirasawa and Pike 2002): how far from the zenith the sky is seen."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.spans import reach
from meshdepict.errors import MeshdepictError
from meshdepict.heights.map_rules import HORIZONS
from meshdepict.options import Choice, Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.ambient_occlusion import Rays
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["RADIUS", "Horizon", "Radius", "negative_openness", "positive_openness"]

RADIUS = 10.0
"""How far horizons are looked for unless told otherwise: as the Relief Visualization Toolbox."""

Radius = Annotated[
    float, Range(1, 1e6, help="how far is looked, in cells or edge lengths", soft=(1, 100))
]
Horizon = Annotated[
    str, Choice(HORIZONS, help="of terrain: along straight lines, or the toolbox's rule")
]
Least = Annotated[
    float, Range(0, 180, unit="°", help="openness that is one end of the grey scale", soft=(30, 90))
]
Most = Annotated[
    float, Range(0, 180, unit="°", help="openness that is its other end", soft=(90, 150))
]

# What the Relief Visualization Toolbox stretches openness between; and, chosen by eye on a lidar
# tile and a volcano, what tells channels from planes where the grey scale is turned.
_LEAST, _MOST = 60.0, 95.0
_LEAST_BELOW, _MOST_BELOW = 80.0, 100.0


def _reads(last: int, *, rays: int, radius: float, **_: Any) -> Reads:
    return Reads(normals=frozenset((0,)), rays=rays, around=radius + 1)


def _share(angles: NDArray[np.float32], least: float, most: float, name: str) -> NDArray[Any]:
    if least >= most:
        raise MeshdepictError(
            f"{name}: least={least:g} is not below most={most:g}: between them the grey scale lies"
        )
    return np.clip((angles - np.float32(least)) / np.float32(reach(least, most)), 0, 1)


@method(
    local=False, lights="none", needs=("rays", "surface"), ground="paper", reads=_reads,
    source="Openness (Yokoyama, Shirasawa and Pike 2002)",
)  # fmt: skip
def positive_openness(
    space: ScaleSpace,
    light: Any,
    *,
    rays: Rays = 256,
    radius: Radius = RADIUS,
    horizon: Horizon = "lines",
    least: Least = _LEAST,
    most: Most = _MOST,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by mean(90° − γ), γ the elevation of the horizon with its sign: crests are bright.

    Unlike the sky view it doesn't tell a slope from a plane, and it tells crests from both. Of
    terrain the horizons are looked for in √rays directions; else rays tell how much of the sky is
    seen about the zenith, which is up of a sheet and the normal of any other sample.

    Parameters
    ----------
    least, most : float
        In degrees, shown black and white; a plane has 90.
    """
    del light
    angles = space.open_angles(rays=rays, radius=radius, horizon=horizon, negative=False)
    return exposed(_share(angles, least, most, "positive_openness"), exposure)


@method(
    local=False, lights="none", needs=("rays", "surface"), ground="paper", reads=_reads,
    source="Openness (Yokoyama, Shirasawa and Pike 2002)",
)  # fmt: skip
def negative_openness(
    space: ScaleSpace,
    light: Any,
    *,
    rays: Rays = 256,
    radius: Radius = RADIUS,
    horizon: Horizon = "lines",
    least: Least = _LEAST_BELOW,
    most: Most = _MOST_BELOW,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by the openness of the ground seen from below: channels and pits are dark.

    The openness of the surface turned over, see `positive_openness`, its grey scale turned too, so
    that hollows stay dark.

    Parameters
    ----------
    least, most : float
        In degrees, shown white and black; a plane has 90, grey.
    """
    del light
    angles = space.open_angles(rays=rays, radius=radius, horizon=horizon, negative=True)
    return exposed(1 - _share(angles, least, most, "negative_openness"), exposure)
