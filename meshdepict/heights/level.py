"""A height that all others are counted from, so that single precision is enough for them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["middle_height"]


def middle_height(z: NDArray[Any], valid: NDArray[np.bool_] | None) -> float:
    """Return the middle of the known heights, 0 where there are none."""
    known = z if valid is None else z[valid]
    return (float(known.min()) + float(known.max())) / 2 if known.size else 0.0
