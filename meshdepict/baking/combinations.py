"""Well-known combinations of layers, by name: those of the Relief Visualization Toolbox.

Visualization for archaeological topography (VAT: Kokalj and Somrak, Remote Sensing 11, 2019, Why
Not a Single Image?) in its settings for general and for flat terrain, and the geomorphological one,
whose lowest layer is lit from several sides. Modes, opacities and ranges are the published ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["COMBINATIONS"]

_STRAIGHT_ANGLE = 180.0  # openness of 180° is 1


def _openness(low: float, high: float) -> tuple[float, float]:
    """Return as display values the degrees of openness that become black and white."""
    return low / _STRAIGHT_ANGLE, high / _STRAIGHT_ANGLE


def _over(
    lowest: Mapping[str, Any],
    *,
    sky: tuple[float, float],
    openness: tuple[float, float],
    steepest: float,
) -> Sequence[Mapping[str, Any]]:
    """Return the layers that all of them have over their lowest, and that."""
    return (
        {"method": "sky_view", "mode": "multiply", "opacity": 0.25, "stretch": sky,
         "light": "front"},
        {"method": "positive_openness", "mode": "overlay", "opacity": 0.5,
         "stretch": _openness(*openness)},
        {"method": "slope", "mode": "luminosity", "opacity": 0.5,
         "options": {"steepest": steepest}},
        lowest,
    )  # fmt: skip


COMBINATIONS: Mapping[str, Sequence[Mapping[str, Any]]] = {
    "archaeological": _over(
        {"method": "hillshade", "light": (315, 35)},
        sky=(0.7, 1), openness=(68, 93), steepest=50,
    ),
    "vat_flat": _over(
        {"method": "hillshade", "light": (315, 15)},
        sky=(0.9, 1), openness=(85, 93), steepest=15,
    ),
    "geomorphological": _over(
        {"method": "multidirectional_hillshade"},
        sky=(0.7, 1), openness=(68, 93), steepest=50,
    ),
}  # fmt: skip
"""Words of `Layer`, the first on top."""
