"""What a kernel's machine code depends on: its text, what it refers to, the kernels that it calls.

Two kernels with the same fingerprint compile to the same code, so that a changed constant or a
changed callee, in whatever file, is compiled anew, and any number of versions share one folder.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

__all__ = ["words_of"]


def words_of(function: Callable[..., Any], known: Callable[[Any], str | None]) -> Iterator[str]:
    """Yield words that say all that a function depends on.

    Parameters
    ----------
    known : callable
        Returns the fingerprint of a kernel, None for anything else.
    """
    code = function.__code__
    yield from _code(code)
    cells = function.__closure__ or ()
    for name, cell in zip(code.co_freevars, cells, strict=True):
        yield from _value(name, cell.cell_contents, known)
    for name in sorted(_names(code)):
        if name in function.__globals__:
            yield from _value(name, function.__globals__[name], known)


def _code(code: types.CodeType) -> Iterator[str]:
    yield code.co_code.hex()
    yield repr((code.co_names, code.co_varnames, code.co_argcount, code.co_freevars))
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _code(constant)
        elif constant is not code.co_consts[0] or not isinstance(constant, str):  # the docstring
            yield repr(constant)


def _names(code: types.CodeType) -> set[str]:
    inner = (_names(part) for part in code.co_consts if isinstance(part, types.CodeType))
    return set(code.co_names).union(*inner)


def _value(name: str, value: Any, known: Callable[[Any], str | None]) -> Iterator[str]:
    yield name
    mark = known(value)
    if mark is not None:
        yield mark
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype.str} {value.shape} {value.tobytes().hex()}"
    elif isinstance(value, types.ModuleType):
        yield value.__name__
    elif isinstance(value, tuple):
        for part in value:
            yield from _value("", part, known)
    elif isinstance(value, (bool, int, float, complex, str, bytes, np.generic, type(None))):
        yield f"{type(value).__name__} {value!r}"
    elif callable(value):  # numpy's and Python's own
        yield f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', name)}"
    else:
        raise TypeError(f"a kernel refers to {name}, a {type(value).__name__}")
