"""Lights that are discs: what is not seen of them where nothing casts shadows."""

from __future__ import annotations

import warnings

from meshdepict.baking.choices import Choices
from meshdepict.errors import MeshdepictWarning
from meshdepict.options import options_of
from meshdepict.scene.light import Light, Lights
from meshdepict.scene.names import Lighting
from meshdepict.scene.rig import Rig

__all__ = ["warn_of_disc"]


def warn_of_disc(look: Choices, light: Lighting) -> None:
    """Warn where a light is a disc and casts no shadows: it shines from its middle alone.

    The lamps of a rig, which stand for their windows, are none.
    """
    if look.options.get("shadows") or not look.lit or isinstance(light, Rig):
        return
    lights = [light] if isinstance(light, Light) else light if isinstance(light, Lights) else []
    spread = max((each.spread for each in lights), default=0.0)
    if not spread:
        return
    from meshdepict.shading.registry import METHODS

    having = ", ".join(name for name, each in METHODS.items() if "shadows" in options_of(each))
    warnings.warn(
        f"a disc of light, here of {spread:g} degrees, shines from its middle unless it casts "
        f"shadows: shadows=True (--set shadows=true) of {having}",
        MeshdepictWarning,
        stacklevel=4,
    )
