"""How an option says its range, its unit and its meaning, once, for every consumer.

Shading functions annotate their keyword-only options with these::

    def exaggerated(space, light, *,
                    exaggeration: Annotated[float, Range(0, help="steepness of the soft toon")] = 20):

and the command line, ``meshdepict methods``, the viewer's sliders and the docs read them back.
"""

from __future__ import annotations

import difflib
import inspect
import math
import typing
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from meshdepict.errors import MeshdepictError

__all__ = ["Choice", "Option", "Range", "check", "nearest", "options_of", "parse"]


@dataclass(frozen=True)
class Range:
    """A number in ``[low, high]``; ``soft`` is the part of it that a slider offers."""

    low: float = -math.inf
    high: float = math.inf
    help: str = ""
    unit: str = ""
    soft: tuple[float, float] | None = None

    def __str__(self) -> str:
        """Return the range as ``low … high unit``."""
        if math.isinf(self.low) and math.isinf(self.high):
            text = "any number"
        elif math.isinf(self.high):
            text = f"≥ {self.low:g}"
        elif math.isinf(self.low):
            text = f"≤ {self.high:g}"
        else:
            text = f"{self.low:g} … {self.high:g}"
        return f"{text} {self.unit}".rstrip()


@dataclass(frozen=True)
class Choice:
    """One of a few words."""

    names: tuple[str, ...]
    help: str = ""

    def __str__(self) -> str:
        """Return the words, separated by bars."""
        return " | ".join(self.names)


@dataclass(frozen=True)
class Option:
    """One option of a function: its name, type, default and what it accepts."""

    name: str
    kind: type
    default: Any
    accepts: Range | Choice

    @property
    def help(self) -> str:
        """The option's meaning in a few words."""
        return self.accepts.help


def options_of(function: Callable[..., Any]) -> dict[str, Option]:
    """Return the annotated keyword-only options of a function, in order."""
    hints = typing.get_type_hints(function, include_extras=True)
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        hint = hints.get(name)
        for accepts in typing.get_args(hint)[1:]:
            if isinstance(accepts, (Range, Choice)):
                kind = typing.get_args(hint)[0]
                found[name] = Option(name, kind, parameter.default, accepts)
    return found


def nearest(word: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean …?"`` for the closest known word, or an empty string."""
    close = difflib.get_close_matches(str(word), list(known), n=1, cutoff=0.5)
    return f"; did you mean {close[0]!r}?" if close else ""


def check(function: Callable[..., Any], given: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return ``given`` with every value checked against the function's annotations.

    Raises
    ------
    MeshdepictError
        For an unknown name (naming the nearest) or a value out of its range.
    """
    known = options_of(function)
    checked = {}
    for name, value in given.items():
        if name not in known:
            names = ", ".join(known) or "none"
            raise MeshdepictError(
                f"{where} has no option {name!r}{nearest(name, known)} (its options: {names})"
            )
        checked[name] = _checked(known[name], value, where)
    return checked


def parse(option: Option, text: str, where: str) -> Any:
    """Return the value that a text such as ``"40"`` or ``"0.1,0.2"`` stands for."""
    return _checked(option, text, where)


def _checked(option: Option, value: Any, where: str) -> Any:
    accepts, name = option.accepts, option.name
    if isinstance(accepts, Choice):
        if value not in accepts.names:
            raise MeshdepictError(
                f"{where}: {name}={value!r} is not one of {accepts}{nearest(value, accepts.names)}"
            )
        return value
    wanted = f"{where}: {name}={value!r} is not a number in its range ({accepts})"
    if isinstance(value, bool):
        raise MeshdepictError(wanted)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise MeshdepictError(wanted) from None
    if not accepts.low <= number <= accepts.high:  # also refuses NaN
        raise MeshdepictError(wanted)
    if option.kind is int:
        if number != int(number):
            raise MeshdepictError(f"{where}: {name}={value!r} is not a whole number")
        return int(number)
    return number
