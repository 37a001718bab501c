"""How an option says its range, its unit and its meaning, once, for every consumer.

Shading functions annotate their keyword-only options with these::

    def exaggerated(space, light, *,
                    exaggeration: Annotated[float, Range(0, help="steepness")] = 15):

and the command line, ``meshdepict methods``, the viewer's sliders and the docs read them back.
A keyword-only option that is plainly an ``int`` or a ``float`` takes any number.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import math
import numbers
import os
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from meshdepict.errors import MeshdepictError

__all__ = [
    "Choice",
    "Flag",
    "Option",
    "Range",
    "Samples",
    "Values",
    "as_text",
    "check",
    "nearest",
    "options_of",
    "parse",
    "real",
]


@dataclass(frozen=True)
class Range:
    """A number in ``[low, high]``; ``soft`` is the part of it that a slider offers.

    Three of them may be a ``place`` on the shape, which viewers take from the pointer. In place of
    a number there may be one of a few ``words``, for what is found from the shape and its light.
    """

    low: float = -math.inf
    high: float = math.inf
    help: str = ""
    unit: str = ""
    soft: tuple[float, float] | None = None
    place: bool = False
    words: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return the range as ``low … high unit``, and the words after bars."""
        if math.isinf(self.low) and math.isinf(self.high):
            text = "any number"
        elif math.isinf(self.high):
            text = f"≥ {self.low:g}"
        elif math.isinf(self.low):
            text = f"≤ {self.high:g}"
        else:
            text = f"{self.low:g} … {self.high:g}"
        return " | ".join([f"{text} {self.unit}".rstrip(), *self.words])


@dataclass(frozen=True)
class Choice:
    """One of a few words; in Python also an object of one of the types `also`."""

    names: tuple[str, ...]
    help: str = ""
    also: tuple[type, ...] = ()

    def __str__(self) -> str:
        """Return the words, separated by bars."""
        return " | ".join(self.names)


@dataclass(frozen=True)
class Flag(Choice):
    """Yes or no: True or False, in a text "true" or "false"."""

    names: tuple[str, ...] = ("true", "false")
    also: tuple[type, ...] = (bool,)


@dataclass(frozen=True)
class Values:
    """A number at every sample: an array, or a text that says where a method finds them.

    In Python also a sequence of three or four numbers, which is the text that they make: a point.
    """

    help: str = ""

    def __str__(self) -> str:
        """Return what such a text may be."""
        return "a vertex attribute | an image | x,y,z[,radius]"


class Samples:
    """An array that an option was given, kept as it was; equal to nothing but itself."""

    def __init__(self, values: Any) -> None:
        import numpy as np

        given = np.asanyarray(values)
        if given.dtype.kind not in "biufO":  # NumPy would make numbers of texts and dates
            raise TypeError
        with np.errstate(over="ignore"):  # what is too large is infinite, and refused as that
            self._values = np.array(given, np.float64)
        self._values.setflags(write=False)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        """Return the numbers."""
        return self._values if dtype is None else self._values.astype(dtype)

    def __repr__(self) -> str:
        """Return how many there are."""
        return f"{self._values.size:,} numbers"


@dataclass(frozen=True)
class Option:
    """One option of a function: its name, type, default and what it accepts.

    An option annotated ``tuple[float, float, float]`` takes three numbers, ``float | tuple[float,
    ...]`` one or several, as a sequence or as a text such as ``"0.9,0.6"``; ``int | str`` also the
    words of its range; ``| None`` lets it be left out. ``count`` is how many numbers: 1, a fixed
    number, or 0 for any.
    """

    name: str
    kind: type
    default: Any
    accepts: Range | Choice | Values
    count: int = 1

    @property
    def help(self) -> str:
        """The option's meaning in a few words."""
        return self.accepts.help


@functools.cache  # a quarter of a millisecond, and every shading asks
def options_of(function: Callable[..., Any]) -> Mapping[str, Option]:
    """Return the parameters of a function that are annotated with what they accept, in order.

    Raises
    ------
    MeshdepictError
        For an annotation that names what is not there.
    """
    try:
        hints = typing.get_type_hints(function, include_extras=True)
    except NameError as error:
        raise MeshdepictError(
            f"the annotations of {function.__name__} can't be read: {error} (import it, and not "
            "under TYPE_CHECKING alone)"
        ) from None
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        hint = hints.get(name)
        plain = _plain_kind(hint) if parameter.kind is parameter.KEYWORD_ONLY else None
        if plain is not None:
            any_number = Range(help=name.replace("_", " "))
            found[name] = Option(name, plain, parameter.default, any_number)
        for accepts in typing.get_args(hint)[1:]:
            if isinstance(accepts, (Range, Choice, Values)):
                kind, count = _kind_and_count(typing.get_args(hint)[0])
                found[name] = Option(name, kind, parameter.default, accepts, count)
    return types.MappingProxyType(found)


def _plain_kind(hint: Any) -> type | None:
    """Return what an annotation is that is ``int`` or ``float`` and no more, but for None."""
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    kind, *rest = typing.get_args(hint) if union else (hint,)
    return kind if kind in (int, float) and rest in ([], [type(None)]) else None


def _kind_and_count(hint: Any) -> tuple[type, int]:
    """Return the type of an option's numbers and how many it takes (0: any number of them)."""
    parts = typing.get_args(hint) if isinstance(hint, types.UnionType) else (hint,)
    for part in parts:
        if typing.get_origin(part) is tuple:
            kinds = typing.get_args(part)
            return kinds[0], 0 if kinds[-1] is Ellipsis else len(kinds)
    return parts[0], 1


def as_text(value: Any) -> str:
    """Return an option's value as ``--set`` takes it: ``"0.9,0.6"`` for several numbers."""
    if isinstance(value, tuple):
        return ",".join(map(as_text, value))
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.9g}" if isinstance(value, float) else str(value)


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


def real(value: Any) -> float | None:
    """Return a finite real number as a float, None for all else: a text, True, NaN, an array."""
    if getattr(value, "shape", None) == () and not hasattr(value, "mask"):  # of NumPy
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def parse(option: Option, text: str, where: str) -> Any:
    """Return the value that a text such as ``"40"`` or ``"0.1,0.2"`` stands for."""
    return _checked(option, text, where)


def _checked(option: Option, value: Any, where: str) -> Any:
    accepts, name = option.accepts, option.name
    if value is None and option.default is None:
        return None
    if isinstance(accepts, Choice):
        if isinstance(value, accepts.also):
            return value
        if not isinstance(value, str) or value not in accepts.names:
            raise MeshdepictError(
                f"{where}: {name}={value!r} is not one of {accepts}{nearest(value, accepts.names)}"
            )
        return value == "true" if isinstance(accepts, Flag) else value
    if isinstance(accepts, Values):
        return _values(option, value, where)
    if option.count != 1:
        return _several(option, value, where)
    return _number(option, value, where)


def _several(option: Option, value: Any, where: str) -> Any:
    """Return one number as such where any count will do, else a tuple of checked numbers."""
    if isinstance(value, str):
        value = value.split(",") if "," in value else value
    elif hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    single = isinstance(value, (str, bool)) or not isinstance(value, Iterable)
    if single and option.count == 0:
        return _number(option, value, where)
    values = () if single else tuple(value)
    if not values or option.count not in (0, len(values)):
        wanted = f"{option.count} numbers" if option.count else "one number or several"
        raise MeshdepictError(
            f"{where}: {option.name}={value!r} is not {wanted} separated by commas"
        )
    return tuple(_number(option, item, where) for item in values)


def _values(option: Option, value: Any, where: str) -> str | Samples:
    """Return an array as `Samples`, all else as the text that says where values are found."""
    if isinstance(value, Samples):
        return value
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else ""
    if isinstance(text, str) and text.strip():
        return text.strip()
    if isinstance(value, (tuple, list)) and len(value) in (3, 4):
        parts = [real(part) for part in value]
        if None not in parts:
            return ",".join(map(repr, parts))
    try:
        found = Samples(value)
        shape = found.__array__().shape
    except (TypeError, ValueError, OverflowError):
        shape = ()
    if len(shape) not in (1, 2) or 0 in shape:
        raise MeshdepictError(
            f"{where}: {option.name}={value!r:.80} is neither a text ({option.accepts}) nor an "
            "array of numbers"
        )
    return found


def _number(option: Option, value: Any, where: str) -> Any:
    accepts, name = option.accepts, option.name
    assert isinstance(accepts, Range)
    if isinstance(value, str) and value in accepts.words:
        return value
    wanted = f"{where}: {name}={value!r} is not a number in its range ({accepts})"
    try:
        number = real(float(value) if isinstance(value, str) else value)
    except ValueError:
        number = None
    if number is None or not accepts.low <= number <= accepts.high:
        raise MeshdepictError(wanted)
    if option.kind is int:
        if number != int(number):
            raise MeshdepictError(f"{where}: {name}={value!r} is not a whole number")
        return int(number)
    return number
