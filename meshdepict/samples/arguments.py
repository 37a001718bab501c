"""What the samples accept: counts of vertices, lengths, and the check that all of them make."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from meshdepict.options import Range, check
from meshdepict.shapes.mesh import Mesh

__all__ = ["LENGTH", "MOST", "checked"]

MOST = 100_000_000
"""Vertices; more would outgrow any memory they could be shaded in."""

LENGTH = Range(1e-100, 1e100)


def checked(function: Callable[..., Mesh], **given: Any) -> Iterable[Any]:
    """Return the values of a sample's arguments, in their order, each within its range."""
    return check(function, given, function.__name__).values()
