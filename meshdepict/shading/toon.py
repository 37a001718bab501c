"""Toon shading: few tones, with soft steps between them."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import Lambert
from meshdepict.scene.names import LightsLike, as_lights
from meshdepict.shading.direct import direct
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.tones import soft_tones

__all__ = ["Bins", "Sharpness", "toon"]

Bins = Annotated[int, Range(1, 256, help="number of tones", soft=(2, 16))]
Sharpness = Annotated[float, Range(1e-3, 1e3, help="φ: how narrow steps are", soft=(3, 14))]


@method(lights="several", source="Winnemöller, Olsen and Gooch, Real-Time Video Abstraction, 2006")
def toon(
    space: ScaleSpace,
    light: LightsLike,
    *,
    bins: Bins = 8,
    sharpness: Sharpness = 6.0,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by n·l in soft steps; coloured light keeps its hue in every tone."""
    no_eye = np.array([[0], [0], [1]], np.float32)  # the material does not look at it
    shaded = direct(space, as_lights(light), no_eye, Lambert())
    return exposed(soft_tones(shaded, bins=bins, sharpness=sharpness), exposure)
