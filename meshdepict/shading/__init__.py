"""Shading: one file per method, each a pure function of samples, a light and options."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from meshdepict.shading.exaggerated import exaggerated
from meshdepict.shading.lambert import half_lambert, lambert
from meshdepict.shading.method import Declaration, declaration

__all__ = ["METHODS", "Declaration", "declaration", "exaggerated", "half_lambert", "lambert"]

METHODS: dict[str, Callable[..., Any]] = {
    function.__name__: function for function in (exaggerated, lambert, half_lambert)
}
"""Every method by name."""
