"""Well-known combinations of layers, by name: those of the Relief Visualization Toolbox.

Visualization for archaeological topography (VAT: Kokalj and Somrak, Remote Sensing 11, 2019, Why
Not a Single Image?) in its settings for general and for flat terrain, and the geomorphological one,
whose lowest layer is lit from several sides. Modes, opacities, ranges and radii are the published
ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["COMBINATIONS"]


def _over(
    lowest: Mapping[str, Any],
    *,
    sky: tuple[float, float],
    radius: float,
    openness: tuple[float, float],
    steepest: float,
) -> Sequence[Mapping[str, Any]]:
    """Return the layers that all of them have over their lowest, and that.

    Parameters
    ----------
    lowest : mapping
    sky : (low, high)
        Shares of the sky that are black and white.
    radius : float
        How far the sky is looked for, in cells.
    openness : (low, high)
        Degrees that are black and white.
    steepest : float
        Degrees that are black.
    """
    least, most = openness
    return (
        {"method": "sky_view", "mode": "multiply", "opacity": 0.25, "stretch": sky,
         "options": {"sky": "overhead", "radius": radius}},
        {"method": "positive_openness", "mode": "overlay", "opacity": 0.5,
         "options": {"radius": radius, "least": least, "most": most}},
        {"method": "slope", "mode": "luminosity", "opacity": 0.5,
         "options": {"steepest": steepest}},
        lowest,
    )  # fmt: skip


_GENERAL: dict[str, Any] = {
    "sky": (0.7, 1.0), "radius": 10.0, "openness": (68.0, 93.0), "steepest": 50.0
}  # fmt: skip
_FLAT: dict[str, Any] = {
    "sky": (0.9, 1.0), "radius": 20.0, "openness": (85.0, 93.0), "steepest": 15.0
}  # fmt: skip

COMBINATIONS: Mapping[str, Sequence[Mapping[str, Any]]] = {
    "archaeological": _over({"method": "hillshade", "light": (315, 35)}, **_GENERAL),
    "vat_flat": _over({"method": "hillshade", "light": (315, 15)}, **_FLAT),
    "geomorphological": _over({"method": "multidirectional_hillshade"}, **_GENERAL),
}
"""Words of `Layer`, the first on top."""
