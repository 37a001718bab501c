"""Tangent frames: two unit vectors for every normal, whatever else is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["halved_angle", "tangents"]

Floats = NDArray[np.float64]


def tangents(normals: Floats) -> Floats:
    """Return a unit tangent (n, 3) for each unit normal (n, 3), the same in every run.

    It is the x axis, turned as the nearer one of z and −z is turned onto the normal the short way.
    """
    x, y, z = normals.T
    share = x / (1 + np.abs(z))
    return np.stack([1 - x * share, -y * share, -np.copysign(1.0, z) * x], axis=1)


def halved_angle(cosine: Floats, sine: Floats) -> tuple[Floats, Floats]:
    """Return cosine and sine of half the angle of the vectors (cosine, sine) of any length.

    The direction of a symmetric 2×2 matrix's larger eigenvalue is that of ((H11 − H22)/2, H12)
    with its angle halved. (1, 0) for the vector zero.
    """
    length = np.hypot(cosine, sine)
    right = cosine >= 0
    c = np.where(right, length + cosine, np.abs(sine))
    s = np.where(right, sine, np.copysign(length - cosine, sine))
    norm = np.hypot(c, s)
    some = norm > 0
    norm = np.where(some, norm, 1.0)
    return np.where(some, c / norm, 1.0), s / norm
