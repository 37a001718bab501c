"""Radiance Scaling's factors for many lights at one point, compiled.

`meshdepict.shading.radiance_scaling.scaling` is the same formula for arrays.
"""

from __future__ import annotations

import math

import numpy as np

from meshdepict.threads import kernel

__all__ = ["MOST_EXPONENT", "factors"]

_ZERO, _ONE = np.float32(0), np.float32(1)
MOST_EXPONENT = np.float32(60)  # radiance_scaling: e^60 is a float32 that may still be multiplied


@kernel("contracted")
def factors(magnitude, alpha, convexity, mean, slant, local, term, delta, factor):  # type: ignore[no-untyped-def]
    """Write `radiance_scaling.scaling` for κ(l), which is one number where isotropic."""
    beta = _ONE - alpha
    if slant == _ZERO:
        e = _faded(magnitude, convexity)
        for k in range(len(delta)):
            low, high = alpha * (_ONE - delta[k]), beta * delta[k]
            factor[k] = (low * e + high) / (low + high * e)
        return
    for k in range(len(delta)):
        factor[k] = _ZERO
        if term[k] > _ZERO:
            across = local[0, k] * local[0, k] - local[1, k] * local[1, k]
            e = _faded(magnitude, -math.tanh(mean + slant * across))
            low, high = alpha * (_ONE - delta[k]), beta * delta[k]
            factor[k] = (low * e + high) / (low + high * e)


@kernel("contracted")
def _faded(magnitude, convexity):  # type: ignore[no-untyped-def]
    """Return E = e^−γκ."""
    return np.float32(math.exp(max(-MOST_EXPONENT, min(MOST_EXPONENT, -magnitude * convexity))))
