"""What texts on the command line stand for: lights, numbers, a method's options."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.scene.names import LightLike, LightsLike

__all__ = ["as_light", "as_numbers", "method_options", "options_by_method"]


def as_light(text: str) -> LightsLike:
    """Return a light's name, its angles or its direction; several where semicolons part them."""
    if ";" in text:
        return [_one_light(part.strip()) for part in text.split(";") if part.strip()]
    return _one_light(text)


def _one_light(text: str) -> LightLike:
    _, colon, spread = text.rpartition(":")
    if colon and _is_number(spread):  # a disc, which names and angles are resolved with
        return text
    azimuth, slash, elevation = text.partition("/")
    if slash and _is_number(azimuth) and _is_number(elevation):  # as on maps: 315/45
        return float(azimuth), float(elevation)
    if "," not in text:
        return text
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in (2, 3):
        raise MeshdepictError(
            f"--light {text} is neither a name, nor azimuth,elevation in degrees, nor x,y,z"
        )
    return numbers


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def as_numbers(text: str, option: str, count: int) -> tuple[float, ...]:
    """Return so many numbers from a text such as 0.5,0.5,1."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count:
        raise MeshdepictError(f"{option} {text} is not {count} numbers separated by commas")
    return numbers


def method_options(method: str, given: Sequence[str]) -> dict[str, Any]:
    """Return the method's options from ``name=value`` texts, checked."""
    from meshdepict.options import check
    from meshdepict.shading.registry import find_method

    function = find_method(method)
    texts = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not equals:
            raise MeshdepictError(f"--set wants name=value, not {text!r}")
        texts[name.strip()] = value.strip()
    return check(function, texts, method)


def options_by_method(given: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return options by method from texts such as ``exaggerated.exaggeration=30``, checked."""
    texts: dict[str, list[str]] = {}
    for text in given:
        method, dot, rest = text.partition(".")
        if not dot or "=" in method:
            raise MeshdepictError(f"--set wants METHOD.name=value here, not {text!r}")
        texts.setdefault(method, []).append(rest)
    return {name: method_options(name, words) for name, words in texts.items()}
