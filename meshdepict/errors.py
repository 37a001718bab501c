"""The one exception that wrong input raises, and the one warning for odd input."""

from __future__ import annotations

__all__ = ["MeshdepictError", "MeshdepictWarning"]


class MeshdepictError(ValueError):
    """Wrong input: one readable sentence saying what is wrong, where, and what to do."""


class MeshdepictWarning(UserWarning):
    """Odd but usable input: one readable sentence saying what was assumed."""
