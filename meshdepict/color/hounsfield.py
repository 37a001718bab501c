"""CT numbers: Hounsfield units, and the way to them from raw numbers."""

from __future__ import annotations

from meshdepict.errors import MeshdepictError
from meshdepict.options import real

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
    if not (real(slope) or 0) > 0 or real(intercept) is None:
        raise MeshdepictError(
            f"slope={slope!r}, intercept={intercept!r}: Hounsfield units take a positive slope "
            "and a finite intercept"
        )
