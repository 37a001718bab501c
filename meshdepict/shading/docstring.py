"""Docstrings of methods: what signatures and declarations say, said in one place.

A method's own docstring says what is particular to it. `completed` adds an entry for every other
parameter, from the table below or from the option's annotation, and what is returned.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable, Iterator
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Option, Values, options_of

__all__ = ["completed"]

_LIGHT = {
    "one": "light : str, (3,) array_like, (azimuth, elevation) or Light",
    "several": "light : light, or several\n    As in `meshdepict.scene.names.as_lights`.",
    "none": "light : any\n    Not looked at.",
}
_SAID = {
    "space": "space : ScaleSpace",
    "view": "view : View or str\n    Where the eye is.",
    "exposure": "exposure : float\n    Factor on the result before it is clipped.",
}


def completed(function: Callable[..., Any], *, lights: str, linear: bool) -> str | None:
    """Return a shading function's docstring with an entry for every parameter and the result.

    Parameters
    ----------
    function : callable
        Its parameters are documented in the order of its signature.
    lights : {"one", "several", "none"}
    linear : bool
        As in `method.Declaration`.

    Returns
    -------
    str or None
        The docstring as it is where there is none, and where an annotation can't be read yet.
    """
    text = inspect.getdoc(function)
    if text is None:
        return None
    try:
        options = options_of(function)
    except MeshdepictError:  # a name that is defined further down
        return text
    intro, *sections = _sections(text)
    titled = {section.partition("\n")[0]: section for section in sections}
    said = _entries(titled.pop("Parameters", ""))
    entries = []
    for name in inspect.signature(function).parameters:
        given = next((entry for entry in said if name in _names(entry)), None)
        if given is None:
            entries.append(_usual(name, lights, options.get(name)))
        elif given not in entries:
            entries.append(given)
    entries += [entry for entry in said if entry not in entries]
    returns = titled.pop("Returns", None) or _section(
        "Returns", [_returned(lights=lights, linear=linear)]
    )
    return "\n\n".join([intro, _section("Parameters", entries), returns, *titled.values()])


def _usual(name: str, lights: str, option: Option | None) -> str:
    """Return the entry of a parameter that the docstring itself says nothing about."""
    if name == "light":
        return _LIGHT[lights]
    if name in _SAID:
        return _SAID[name]
    if option is None:
        return name
    accepts = option.accepts
    if isinstance(accepts, Choice):
        kind = "{" + ", ".join(f'"{word}"' for word in accepts.names) + "}"
    elif isinstance(accepts, Values):
        kind = "str or array_like"
    else:
        number = option.kind.__name__
        kind = {1: number, 0: f"{number} or several"}.get(option.count, f"{option.count} {number}s")
        if accepts.words:
            kind += " or " + ", ".join(f'"{word}"' for word in accepts.words)
    said = option.help
    if said[:2].isascii() and said[:2].isalpha():  # a word, and no formula
        said = said[0].upper() + said[1:]
    help_ = textwrap.indent(textwrap.fill(f"{said}.", 94), "    ")
    return f"{name} : {kind}{', optional' * (option.default is None)}\n{help_}".rstrip()


def _returned(*, lights: str, linear: bool) -> str:
    array = "(n,) array of float32" + ", (n, 3) where a light is coloured" * (lights == "several")
    return f"{array}\n    {'Linear' if linear else 'Display'} values in [0, 1]."


def _sections(text: str) -> Iterator[str]:
    """Yield what comes before the first heading, then every section with its heading."""
    lines, begin = text.splitlines(), 0
    for i in range(1, len(lines)):
        if lines[i].startswith("---") and not lines[i].strip("- "):
            yield "\n".join(lines[begin : i - 1]).strip()
            begin = i - 1
    yield "\n".join(lines[begin:]).strip()


def _section(title: str, entries: list[str]) -> str:
    return "\n".join([title, "-" * len(title), *entries])


def _entries(section: str) -> list[str]:
    """Return the entries of a section: a line that is not indented, and those after it that are."""
    found: list[str] = []
    for line in section.splitlines()[2:]:
        if line[:1].strip():
            found.append(line)
        elif found:
            found[-1] += f"\n{line}"
    return [entry.rstrip() for entry in found]


def _names(entry: str) -> set[str]:
    """Return the parameters that an entry is about."""
    return {name.strip(" *") for name in entry.partition("\n")[0].partition(":")[0].split(",")}
