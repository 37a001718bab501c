"""What methods there are, and what one takes: as text, as a table, and as a sequence of names."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from typing import Any, overload

from meshdepict.baking.choices import Choices
from meshdepict.options import as_text, options_of
from meshdepict.shading.method import NEEDS, declaration
from meshdepict.shading.registry import METHODS, find_method
from meshdepict.shapes.table import columns, html_table

__all__ = ["MethodDescription", "MethodList", "methods"]


class MethodList(Sequence[str]):
    """The names of all methods, in the order of lists; shown with their summaries and papers."""

    def __init__(self) -> None:
        self._names = tuple(METHODS)

    @overload
    def __getitem__(self, place: int) -> str: ...

    @overload
    def __getitem__(self, place: slice) -> tuple[str, ...]: ...

    def __getitem__(self, place: int | slice) -> str | tuple[str, ...]:
        """Return a name, or some."""
        return self._names[place]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._names)

    def __repr__(self) -> str:
        """Return what ``meshdepict methods`` prints."""
        rows = ((name, summary, "", paper) for name, summary, paper in self._rows())
        return columns([row for a, b, c, d in rows for row in ((a, b), (c, d))])

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        return html_table([*self._rows()], "methods", ("method", "what it shows", "source"))

    def _rows(self) -> Iterator[tuple[str, str, str]]:
        for name in self._names:
            yield name, _summary(METHODS[name]), declaration(METHODS[name]).source


class MethodDescription:
    """What there is to know about one method: its paper, its scales, its options.

    Attributes
    ----------
    name, summary : str
    facts : list of (str, str)
    options : list of (str, str, str, str)
        Name, default, range and meaning of each.
    """

    def __init__(self, method: str | Callable[..., Any]) -> None:
        function = find_method(method)
        follows = Choices(function).following
        self.name = method if isinstance(method, str) else function.__name__
        self.summary = _summary(function)
        self.facts = [*_facts(function)]
        if follows:
            self.facts.append(("fitted", f"to the shape unless given: {', '.join(follows)}"))
        self.options = []
        for option in options_of(function).values():
            default = "none" if option.default is None else as_text(option.default)
            if option.name in follows:
                default = "fitted"
            self.options.append((option.name, default, str(option.accepts), option.help))

    def __repr__(self) -> str:
        """Return what ``meshdepict methods NAME`` prints."""
        options = [("--set", "default", "range", ""), *self.options]
        if not self.options:
            options = [("--set", "no options", "", "")]
        return f"{self.name}: {self.summary}\n\n{columns(self.facts)}\n\n{columns(options)}"

    def _repr_html_(self) -> str:
        """Return two tables for notebooks."""
        facts = html_table(self.facts, f"{self.name}: {self.summary}")
        if not self.options:
            return facts
        return facts + html_table(self.options, "options", ("option", "default", "range", ""))


@overload
def methods(name: None = None) -> MethodList: ...


@overload
def methods(name: str | Callable[..., Any]) -> MethodDescription: ...


def methods(name: str | Callable[..., Any] | None = None) -> MethodList | MethodDescription:
    """List the shading methods, or describe one with its options.

    Parameters
    ----------
    name : str or function, optional
        As for `bake`.

    Returns
    -------
    MethodList or MethodDescription
        Each prints what ``meshdepict methods`` prints; the list is a sequence of names.

    Raises
    ------
    MeshdepictError
        For an unknown name, naming the nearest.

    Examples
    --------
    >>> "exaggerated" in methods()
    True
    """
    return MethodList() if name is None else MethodDescription(name)


def _facts(function: Callable[..., Any]) -> Iterator[tuple[str, str]]:
    declared = declaration(function)
    scales = "no scales: the mesh's own normals"
    if declared.scales:
        scales = f"{declared.scales} scales, each {declared.ratio:.4g} times as wide as the last"
    values = "linear light, encoded as sRGB" if declared.linear else "display values, as they are"
    yield "paper", declared.source
    yield "uses", scales
    yield "values", values
    for need in NEEDS:
        if need in declared.needs:
            yield "needs", f"{need}: {NEEDS[need]}"
    if declared.lights != "none":
        yield "light", f"{declared.light} unless told otherwise"


def _summary(function: Callable[..., Any]) -> str:
    paragraph = (inspect.getdoc(function) or "").partition("\n\n")[0]
    return " ".join(paragraph.split())
