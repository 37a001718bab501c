"""The 21 lights under which Local Light Alignment, §7, compares methods."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from meshdepict.scene.light import Light
from meshdepict.scene.names import as_light

if TYPE_CHECKING:
    from meshdepict.scene.view import View

__all__ = ["LIGHTS", "light_directions"]

LIGHTS = (
    *((90, polar) for polar in range(15, 106, 15)),
    *((0, polar) for polar in range(105, 14, -15)),
    *((270, polar) for polar in range(15, 106, 15)),
)
"""Azimuth (clockwise from up) and angle from the view axis, in degrees, of lights #1 to #21.

Outwards to the right, inwards over the top, outwards to the left: #6–9, #20 and #21 graze the
object or stand behind it. (The paper's inset is lost; this is inferred from its text.)
"""


def light_directions(view: View | None = None) -> list[Light]:
    """Return the 21 lights of LLA's comparison, #1 first, in the frame of a view.

    Parameters
    ----------
    view : View, optional
        The front (x right, y up, z to the eye) unless given.
    """
    return [
        replace(as_light((azimuth, 90 - polar), view), name=f"#{i}")
        for i, (azimuth, polar) in enumerate(LIGHTS, start=1)
    ]
