"""The bands of Exaggerated Shading: how much each counts, and the light that has no direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["SINGULAR_LIGHT", "band_weights"]

SINGULAR_LIGHT = 1e-3
"""ε: where the light stands along the smoothed normal it has no direction in the tangent plane.

There the projected light is l / √(‖l‖² + ε²) instead of l / ‖l‖, which fades to zero continuously.
"""


def band_weights(
    widths: NDArray[np.float64],
    ratio: float,
    *,
    emphasis: float,
    contrast: float,
    base: float = 1.0,
) -> NDArray[np.float64]:
    """Return k_i ∝ σ_i^emphasis for i = 0 … b, their sum the contrast (§3).

    Parameters
    ----------
    widths : (b + 1,) array
        σ_0 … σ_b; σ_0 is taken as σ_1 / ratio.
    base : float
        Multiplies k_b before the sum is made the contrast; 1 is the paper.
    """
    if len(widths) == 1:
        return np.array([contrast])
    # Relative to the finest, so that neither tiny nor huge units overflow a power.
    relative = np.concatenate(([1 / ratio], widths[1:] / widths[1]))
    weights = relative**emphasis
    weights[-1] *= base
    return contrast * weights / (weights.sum() or 1.0)
