"""Open sheets: whether the eye looks at the back of one."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictWarning
from meshdepict.scales.seen_side import towards_eye
from meshdepict.scene.view import View

__all__ = ["warn_of_backs"]

_FACING = 0.02  # share of the samples: a rim may be bent


def warn_of_backs(points: NDArray[np.float64], normals: NDArray[np.float32], view: View) -> None:
    """Warn where every normal looks away from the eye: nothing but backs is seen."""
    cosine = (normals * towards_eye(points, view)).sum(axis=1)
    if np.mean(cosine > 0) < _FACING:
        warnings.warn(
            "every face looks away from the eye and is dark for most methods: two_sided=True "
            "(--two-sided) shades the side that is seen; or look from the other side",
            MeshdepictWarning,
            stacklevel=4,
        )
