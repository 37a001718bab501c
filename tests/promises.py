"""Two promises of every public function, watched in all tests: inputs stay, and nothing is NaN."""

from __future__ import annotations

import functools
import types
import zlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import meshdepict

_watching = True


@functools.cache
def watched(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function as it is, but that it checks what it was given and what it returns."""

    @functools.wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        if not _watching:
            return function(*given, **named)
        arrays = [*arrays_of((given, named))]
        before = [checksum(array) for array in arrays]
        result = function(*given, **named)
        changed = sum(checksum(a) != old for a, old in zip(arrays, before, strict=True))
        assert not changed, f"{function.__qualname__} changed {changed} arrays that it was given"
        for array in arrays_of(result):
            if array.dtype.kind in "fc":
                assert not np.isnan(array).any(), f"{function.__qualname__} returned NaN"
        return result

    return call


def checksum(array: np.ndarray) -> int:
    return zlib.crc32(np.ascontiguousarray(array).reshape(-1).view(np.uint8))


def arrays_of(thing: Any, depth: int = 0) -> Iterator[np.ndarray]:
    """Yield the arrays in nested tuples, lists and dictionaries, and those of our own objects."""
    if isinstance(thing, np.ndarray):
        if thing.dtype.kind in "biufcSU":
            yield thing
    elif isinstance(thing, np.floating | float):
        yield np.asarray(thing)
    elif isinstance(thing, dict):
        for value in thing.values():
            yield from arrays_of(value, depth)
    elif isinstance(thing, tuple | list):
        if len(thing) < 1000:  # longer ones are numbers
            for value in thing:
                yield from arrays_of(value, depth)
    elif depth < 2 and is_ours(thing) and hasattr(thing, "__dict__"):
        # A scale space's, and its shape's; what a file says beside them is the file's, NaN and all.
        own = {name: value for name, value in vars(thing).items() if name != "attributes"}
        yield from arrays_of(own, depth + 1)


def is_ours(thing: Any) -> bool:
    home = thing.__module__ if isinstance(thing, types.FunctionType) else type(thing).__module__
    return home.startswith("meshdepict.")


def is_public(thing: Any) -> bool:
    return (
        isinstance(thing, types.FunctionType)
        and is_ours(thing)
        and not thing.__name__.startswith("_")
    )


def watch_parameters(item: pytest.Item) -> None:
    """Watch the functions that a test is parametrised with, too."""
    values = item.callspec.params if hasattr(item, "callspec") else {}
    for name, value in values.items():
        if is_public(value):
            values[name] = watched(value)


@pytest.fixture(scope="module", autouse=True)
def watched_functions(request: pytest.FixtureRequest) -> Iterator[None]:
    """Watch the functions that a test's file imported by name, and those of the public doors."""
    from meshdepict import congruence, curvature, shading

    with pytest.MonkeyPatch.context() as patch:
        for name in meshdepict.__all__:
            if is_public(function := getattr(meshdepict, name)):
                patch.setattr(meshdepict, name, watched(function), raising=False)
        for place in (shading, curvature, congruence, request.module):
            for name, thing in vars(place).copy().items():
                if is_public(thing):
                    patch.setattr(place, name, watched(thing))
        for name, function in shading.METHODS.items():
            patch.setitem(shading.METHODS, name, watched(function))
        yield


@pytest.fixture(autouse=True)
def promises(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.node.get_closest_marker("unwatched"):
        monkeypatch.setattr("promises._watching", False)
