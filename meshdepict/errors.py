"""The one exception that wrong input raises, and the one warning for odd input."""

from __future__ import annotations

import re

__all__ = ["MeshdepictError", "MeshdepictWarning"]


class MeshdepictError(ValueError):
    """Wrong input: one readable sentence saying what is wrong, where, and what to do.

    Whatever is quoted in it, an array for instance, it stays one line.
    """

    def __init__(self, sentence: object = "") -> None:
        super().__init__(re.sub(r"\s*[\r\n]\s*", " ", str(sentence)))


class MeshdepictWarning(UserWarning):
    """Odd but usable input: one readable sentence saying what was assumed."""
