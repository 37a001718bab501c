"""Two promises of what is public, watched in all tests: inputs stay, and nothing is NaN.

Functions are watched, and what makes objects: constructors, class methods such as `from_images`.
"""

from __future__ import annotations

import functools
import threading
import types
import zlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import meshdepict
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import MATERIALS

_watching = True


_now = threading.local()  # whether a watched call is under way


@functools.cache
def watched(function: Callable[..., Any], *, makes: bool = False) -> Callable[..., Any]:
    """Return the function as it is, but that it checks what it was given and what it returns.

    What ``makes`` an object is watched where it is called from outside of what is watched: inside,
    the package may hand over arrays of its own for good.
    """

    @functools.wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        if not _watching or (makes and getattr(_now, "inside", False)):
            return function(*given, **named)
        before, _now.inside = getattr(_now, "inside", False), True
        try:
            return checked(function, given, named, makes=makes)
        finally:
            _now.inside = before

    return call


def checked(
    function: Callable[..., Any], given: tuple[Any, ...], named: dict[str, Any], *, makes: bool
) -> Any:
    """Call a function, and fail where it changed what it was given, or returned NaN."""
    arrays = [*arrays_of((given[makes:], named))]
    before = [state(array) for array in arrays]
    result = function(*given, **named)
    changed = sum(state(a) != old for a, old in zip(arrays, before, strict=True))
    assert not changed, f"{function.__qualname__} changed {changed} arrays that it was given"
    if makes and any(map(has_nan, arrays)):
        return result  # a wish that an object holds as it was said, and refuses where it is used
    # A constructor returns nothing: the object is the first that it is given.
    for array in arrays_of(given[0] if makes and result is None else result):
        assert not has_nan(array), f"{function.__qualname__} returned NaN"
    return result


def has_nan(array: np.ndarray) -> bool:
    return array.dtype.kind in "fc" and bool(np.isnan(array).any())


def state(array: np.ndarray) -> tuple[int, bool]:
    """What a call may change of an array: its values, and whether its owner may."""
    return checksum(array), array.flags.writeable


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


def is_made(thing: Any) -> bool:
    """Whether this is a class whose objects people make; a `ScaleSpace` is made for them."""
    return isinstance(thing, type) and not issubclass(thing, (BaseException, ScaleSpace))


def makers(kind: type) -> Iterator[tuple[str, Any]]:
    """Yield what makes objects of a class, watched, by its name there."""
    yield "__init__", watched(kind.__init__, makes=True)
    for name, thing in vars(kind).items():
        if isinstance(thing, classmethod) and not name.startswith("_"):
            yield name, classmethod(watched(thing.__func__, makes=True))


def watch_parameters(item: pytest.Item) -> None:
    """Watch the functions that a test is parametrised with, too."""
    values = item.callspec.params if hasattr(item, "callspec") else {}
    for name, value in values.items():
        if is_public(value):
            values[name] = watched(value)


@pytest.fixture(scope="module", autouse=True)
def watched_functions(request: pytest.FixtureRequest) -> Iterator[None]:
    """Watch the functions that a test's file imported by name, and what the public doors have."""
    from meshdepict import congruence, curvature, shading

    with pytest.MonkeyPatch.context() as patch:
        for name in meshdepict.__all__:
            if is_public(function := getattr(meshdepict, name)):
                patch.setattr(meshdepict, name, watched(function), raising=False)
        public = {getattr(meshdepict, name) for name in meshdepict.__all__ if name != "samples"}
        for kind in {*filter(is_made, public), *MATERIALS.values()}:
            for name, maker in [*makers(kind)]:
                patch.setattr(kind, name, maker)
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
