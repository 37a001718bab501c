"""Controls of a method: a slider, a list or a line of text for each option, from its annotation.

The window and the page build the same controls from this one place.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from meshdepict.baking.choice_list import choice_fields
from meshdepict.options import Choice, Option, Values, as_text, options_of

__all__ = ["HEIGHTS", "Control", "controls", "place_option", "slid"]


@dataclass(frozen=True)
class Control:
    """How a person sets one option.

    Attributes
    ----------
    name : str
        Of the option.
    kind : {"slider", "list", "text"}
        A number in [low, high]; one of `choices`; several numbers, as `options.as_text` writes
        them.
    label : str
        The name in words.
    help, unit : str
    default
        Value without the person's doing; None where the method finds one itself.
    low, high, step : float
        Of a slider; a step of 1 for whole numbers, 0 for any.
    choices : tuple of str
        Of a list.
    words : tuple of str
        That may stand in place of a slider's number.
    """

    name: str
    kind: str
    label: str
    help: str
    default: Any
    unit: str = ""
    low: float = 0.0
    high: float = 1.0
    step: float = 0.0
    choices: tuple[str, ...] = ()
    words: tuple[str, ...] = ()

    @property
    def start(self) -> Any:
        """What the control shows at first: the default, or the middle of a slider without one."""
        if self.default is None:
            return {"slider": (self.low + self.high) / 2, "list": self.choices[:1]}.get(
                self.kind, ""
            )
        return as_text(self.default) if self.kind == "text" else self.default


HEIGHTS = Control(
    "z_factor", "slider", "z factor", choice_fields()["z_factor"].metadata["help"], 1.0,
    low=0.5, high=10.0,
)  # fmt: skip
"""How high terrain stands: cartographers' vertical exaggeration, mostly 1 to 5."""


def slid(control: Control, value: Any) -> float:
    """Return where a slider stands: at the number, in the middle of several, where it began."""
    if value is None or isinstance(value, str):
        value = control.start
    return sum(value) / len(value) if isinstance(value, tuple) else value


def controls(method: str | Callable[..., Any]) -> list[Control]:
    """Return the controls of a method, by its name or as it is, in the order of its options.

    Raises
    ------
    MeshdepictError
        For an unknown method.
    """
    from meshdepict.shading.registry import find_method

    return [_control(option) for option in options_of(find_method(method)).values()]


def place_option(method: str | Callable[..., Any]) -> str | None:
    """Return the option of a method that is a place on the shape, None where there is none."""
    from meshdepict.shading.registry import find_method

    return next(
        (
            option.name
            for option in options_of(find_method(method)).values()
            if isinstance(option.accepts, Values) or getattr(option.accepts, "place", False)
        ),
        None,
    )


def _control(option: Option) -> Control:
    accepts = option.accepts
    said = option.name, option.name.replace("_", " "), option.help, option.default
    name, label, help_, default = said
    if isinstance(accepts, Choice):
        return Control(name, "list", label, help_, default, choices=accepts.names)
    if isinstance(accepts, Values):
        return Control(name, "text", label, help_, default)
    several = option.count > 1 or isinstance(default, tuple)
    low, high = accepts.soft or (accepts.low, accepts.high)
    if several or not (math.isfinite(low) and math.isfinite(high)):
        return Control(name, "text", label, help_, default, unit=accepts.unit)
    step = 1.0 if option.kind is int else 0.0
    return Control(
        name, "slider", label, help_, default, unit=accepts.unit, low=low, high=high, step=step,
        words=accepts.words,
    )  # fmt: skip
