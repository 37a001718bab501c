"""How long something may take: seconds as numbers, or in words such as 2s, 500ms and 1min."""

from __future__ import annotations

import math
import re

from meshdepict.errors import MeshdepictError
from meshdepict.options import real

__all__ = ["as_seconds"]

_UNITS = {"ms": 1e-3, "s": 1.0, "": 1.0, "min": 60.0, "h": 3600.0}
_WORDS = re.compile(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*([a-z]*)\s*", re.ASCII)


def as_seconds(given: object) -> float:
    """Return a time in seconds.

    Raises
    ------
    MeshdepictError
        For what is no time above 0.
    """
    seconds = None if isinstance(given, str) else real(given)
    found = _WORDS.fullmatch(given) if isinstance(given, str) else None
    if found and found[2] in _UNITS:
        try:
            seconds = float(found[1]) * _UNITS[found[2]]
        except ValueError:  # of 1.2.3
            seconds = None
    if seconds is None or not 0 < seconds < math.inf:
        raise MeshdepictError(
            f"budget={given!r} is no time: give seconds, or such as 2s, 500ms or 1min"
        )
    return seconds
