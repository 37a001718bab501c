"""A kernel: a function that is compiled at its first call, or loaded as it was compiled once."""

from __future__ import annotations

import functools
import hashlib
import inspect
import json
import os
import threading
from collections.abc import Callable, Mapping
from typing import Any

from meshdepict.files import cache
from meshdepict.kernels.arguments import NUMBA, Key, Unsupported, key_of
from meshdepict.kernels.fingerprint import words_of
from meshdepict.kernels.intrinsics import Intrinsic
from meshdepict.kernels.notice import compiling

__all__ = ["FOLDER", "Kernel"]

FOLDER = "kernels"
"""Where kernels lie in the folder of `meshdepict.files.cache`."""

_FORM = 2  # of the files, to be counted up with what is in them
_making = threading.RLock()


class Kernel:
    """A function of arrays and numbers, compiled for each combination of their types.

    Parameters
    ----------
    function : callable
        Of the kind that numba compiles, without keyword arguments.
    options : mapping
        What `numba.njit` is told.
    """

    def __init__(self, function: Callable[..., Any], options: Mapping[str, Any]) -> None:
        functools.update_wrapper(self, function)
        self.__name__ = function.__name__
        self.py_func = function
        self.targetoptions = dict(options)  # where numba looks for "inline"
        self._ready: dict[Key, Callable[..., Any]] = {}

    def __call__(self, *values: Any, **named: Any) -> Any:
        """Run it, other threads beside."""
        if named:
            values = inspect.signature(self.py_func).bind(*values, **named).args
        try:
            keys = tuple(map(key_of, values))
        except Unsupported:
            return self.dispatcher(*values)
        run = self._ready.get(keys)
        if run is None:
            with _making:
                run = self._ready.get(keys)
                if run is None:
                    run = self._ready[keys] = self._made(keys, values)
        return run(*values)

    def _made(self, keys: Key, values: tuple[Any, ...]) -> Callable[..., Any]:
        """Return what runs it for arguments of these types."""
        if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
            return self.py_func
        from meshdepict.kernels.machine_code import callable_of, machine

        words = (str(_FORM), machine(), self.fingerprint, repr(keys))
        mark = hashlib.sha256("\0".join(words).encode()).hexdigest()
        name = f"{FOLDER}/{self.__module__.removeprefix('meshdepict.')}.{self.__name__}.{mark[:32]}"
        symbol = f"kernel_{mark}"
        found = _read(cache.kept(name))
        if found is None:
            from meshdepict.kernels.compiling import compiled  # which loads numba

            compiling(self.__name__)
            found = compiled(self.bare, values, keys, symbol)
            if cache.keep(name, _written(*found)):
                cache.throw_away_unused(FOLDER)
            if found[0] == NUMBA:
                self.dispatcher.recompile()  # its own cache may know an earlier version
        returns, data = found
        if returns == NUMBA:
            return self.dispatcher
        return callable_of(data, symbol, keys, returns)

    @functools.cached_property
    def fingerprint(self) -> str:
        """Of its text and options, and of all that it refers to."""
        # Set options have no order of their own.
        said = {k: sorted(v) if isinstance(v, set) else v for k, v in self.targetoptions.items()}
        whole = hashlib.sha256(repr(sorted(said.items())).encode())
        for word in words_of(self.py_func, _known):
            whole.update(word.encode() + b"\0")
        return whole.hexdigest()

    @functools.cached_property
    def bare(self) -> Any:
        """What numba has for machine code alone: nothing that Python could call."""
        from numba import njit

        return njit(**self.targetoptions, no_cpython_wrapper=True, no_cfunc_wrapper=True)(
            self.py_func
        )

    @functools.cached_property
    def dispatcher(self) -> Any:
        """What numba has for Python: it runs it where kept machine code can't."""
        from numba import njit
        from numba.core import config

        folder, before = cache.cache_folder(), config.CACHE_DIR
        with _making:
            if folder is not None:
                config.CACHE_DIR = str(folder / FOLDER / "numba")
            try:
                return njit(**self.targetoptions, cache=True)(self.py_func)
            finally:
                config.CACHE_DIR = before

    @property
    def _numba_type_(self) -> Any:
        """As what numba sees it within another kernel."""
        from numba import types

        return types.Dispatcher(self.bare)


def _known(value: Any) -> str | None:
    return value.fingerprint if isinstance(value, (Kernel, Intrinsic)) else None


def _written(returns: str, data: bytes) -> bytes:
    """Return a file: a line that says what is in it, and the object."""
    head = {"returns": returns, "sha256": hashlib.sha256(data).hexdigest()}
    return json.dumps(head).encode() + b"\n" + data


def _read(whole: bytes | None) -> tuple[str, bytes] | None:
    """Return what the file says, None where it isn't whole: what is spoiled is never run."""
    line, _, data = (whole or b"").partition(b"\n")
    try:
        head = json.loads(line)
        if head["sha256"] != hashlib.sha256(data).hexdigest():
            return None
        return str(head["returns"]), data
    except (ValueError, KeyError, TypeError):
        return None
