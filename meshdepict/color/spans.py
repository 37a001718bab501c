"""Spans of values: in words, ``0.7..1``, ``-50..3000``, and how far they reach."""

from __future__ import annotations

import math

from meshdepict.errors import MeshdepictError
from meshdepict.options import real

__all__ = ["SEPARATOR", "parsed_span", "reach", "span_text"]

SEPARATOR = ".."

_LEAST = 1e-30


def parsed_span(text: str) -> tuple[float, float]:
    """Return the two numbers of a span, which may fall.

    Raises
    ------
    MeshdepictError
        For anything else, and numbers that are the same.
    """
    low, found, high = text.partition(SEPARATOR)
    numbers = []
    for word in (low, high):
        try:
            numbers.append(real(float(word)))
        except ValueError:
            numbers.append(None)
    first, last = numbers
    if not found or first is None or last is None or first == last:
        raise MeshdepictError(f"{text!r} is not two numbers that differ, as in 0.7{SEPARATOR}1")
    return first, last


def span_text(span: tuple[float, float]) -> str:
    """Return what `parsed_span` takes back, to the last digit."""
    return SEPARATOR.join(repr(float(end)).removesuffix(".0") for end in span)


def reach(low: float, high: float) -> float:
    """Return high − low, never so little that shares of it overflow: then it is a step."""
    return math.copysign(max(abs(high - low), _LEAST), high - low)
