"""CT numbers: Hounsfield units, and the way to them from raw numbers."""

from __future__ import annotations

import math

from meshdepict.errors import MeshdepictError

__all__ = ["AIR", "check_rescale"]

AIR = -1000.0
"""CT number of air in Hounsfield units."""


def check_rescale(slope: float, intercept: float) -> None:
    """Refuse what is no way from raw numbers to Hounsfield units.

    Raises
    ------
    MeshdepictError
        For a slope that is not positive and an intercept that is not finite.
    """
    if not (0 < slope < math.inf and math.isfinite(intercept)):
        raise MeshdepictError(
            f"slope={slope!r}, intercept={intercept!r}: Hounsfield units take a positive slope "
            "and a finite intercept"
        )
