"""Few tones of coloured light: what is in steps is how bright it is, and never its hue."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.material import soft_steps

__all__ = ["soft_tones"]

_DARKEST = 1e-30  # least brightness that is divided by


def soft_tones(light: NDArray[Any], *, bins: int, sharpness: float) -> NDArray[Any]:
    """Quantise how bright light is, in soft steps, and keep its hue and saturation.

    Winnemöller, Olsen and Gooch (2006) quantise the brightness of a colour alone, too. Brightness
    is here the largest channel: grey light is `soft_steps` of itself, no step leads out of what can
    be shown, and a light of one colour has that colour in every tone. Steps of each channel by
    itself, at different places for each, would draw coloured rims around every tone.

    Parameters
    ----------
    light : (n,) or (n, 3) array
        Linear, ≥ 0; brighter than 1 is 1.
    bins : int
        Number of tones.
    sharpness : float
        φ, how narrow the steps between them are.

    Returns
    -------
    array
        Of the same shape, in [0, 1].
    """
    if light.ndim == 1:
        return soft_steps(light, bins=bins, sharpness=sharpness)
    brightness = light.max(axis=1)
    tone = soft_steps(brightness, bins=bins, sharpness=sharpness)
    share = tone / np.maximum(brightness, _DARKEST).astype(light.dtype)
    return np.minimum(light * share[:, None], 1)
