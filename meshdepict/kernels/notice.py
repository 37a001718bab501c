"""Word of kernels being compiled, for whoever sits at a terminal and waits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["compiling", "told"]

_listeners: list[Callable[[str], None]] = []


@contextmanager
def told(listener: Callable[[str], None]) -> Iterator[None]:
    """Call a function with the name of each kernel that is compiled meanwhile, before it is."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def compiling(name: str) -> None:
    """Say that a kernel is about to be compiled."""
    for listener in _listeners:
        listener(name)
