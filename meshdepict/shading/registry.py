"""Every method by its name: this package's own, and those that others bring along."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.shading import catalogue
from meshdepict.shading.entry_points import Methods
from meshdepict.shading.method import is_method

__all__ = ["METHODS", "OWN", "find_method"]

OWN = {name: function for name, function in vars(catalogue).items() if is_method(function)}
"""This package's own methods, in the order of their lines."""

METHODS = Methods(OWN)
"""Every method by name."""


def find_method(method: str | Callable[..., Any]) -> Callable[..., Any]:
    """Return the shading function of a name, or one made by `method` as it is.

    Raises
    ------
    MeshdepictError
        For an unknown name, naming the nearest, and a function that `method` did not make.
    """
    if callable(method):
        if not is_method(method):
            name = getattr(method, "__name__", type(method).__name__)
            raise MeshdepictError(
                f"{name} is no shading method yet: declare it with the decorator "
                "md.method(source=…), and bake takes it as it takes a name"
            )
        return method
    if not isinstance(method, str) or method not in METHODS:
        raise MeshdepictError(
            f"no method is called {method!r}{nearest(method, METHODS)} (there are "
            f"{', '.join(METHODS)})"
        )
    return METHODS[method]
