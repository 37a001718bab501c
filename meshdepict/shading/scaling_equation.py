"""Radiance Scaling's equation (Vergne, Pacanowski, Barla, Granier and Schlick, TVCG 2011)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["LEAST_INVARIANT", "scaling"]

LEAST_INVARIANT = 1e-6  # how near the invariant point comes to 0 and 1: at them scaling is 0/0
_MOST_EXPONENT = 60.0  # e^60 is a float32 that may still be multiplied


def scaling(
    curvature: ArrayLike,
    reflectance: ArrayLike,
    *,
    invariant: float = 0.5,
    magnitude: float = 4.0,
) -> NDArray[Any]:
    """Return the factor on reflected light (eq. 2): above 1 where bright convexities are.

    Parameters
    ----------
    curvature : array_like
        κ in [−1, 1], positive where *convex*.
    reflectance : array_like
        δ in [0, 1], 1 where the term of the material reflects most; clamped.
    invariant : float
        α in (0, 1), the reflectance that curvature leaves alone.
    magnitude : float
        γ ≥ 0.

    Returns
    -------
    array
        Positive. 1 at δ = α and at κ = 0, e^γκ at δ = 1, e^−γκ at δ = 0, increasing in δ where
        convex.
    """
    curvature, delta = np.asarray(curvature), np.clip(np.asarray(reflectance), 0, 1)
    dtype = np.result_type(curvature, delta, np.float32)
    alpha = dtype.type(np.clip(invariant, LEAST_INVARIANT, 1 - LEAST_INVARIANT))
    exponent = np.clip(curvature.astype(dtype) * dtype.type(min(magnitude, 1e30)),
                       -_MOST_EXPONENT, _MOST_EXPONENT)  # fmt: skip
    e = np.exp(-exponent)
    low, high = alpha * (1 - delta), (1 - alpha) * delta
    return (low * e + high) / (low + high * e)
