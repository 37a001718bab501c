"""Threads: how many, a parallel map with progress, and how kernels for them are declared.

Kernels are compiled to release the interpreter's lock and are run by ordinary Python threads.
That needs no threading layer of numba's, so it is safe from several threads at once, after a
fork and on every platform, and Ctrl-C is answered between two pieces of work.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from itertools import pairwise
from typing import Any, Literal

from meshdepict.errors import MeshdepictError
from meshdepict.kernels.kernel import Kernel
from meshdepict.options import real

__all__ = ["Rounding", "each", "kernel", "limit", "spans", "thread_count"]

Rounding = Literal["as written", "contracted", "reordered", "free"]

# What a compiler may do to sums and products: LLVM's flags, as numba takes them.
_FLAGS: dict[Rounding, set[str] | bool] = {
    "as written": False,
    "contracted": {"contract"},  # a·b + c is rounded once where the processor can
    "reordered": {"contract", "reassoc", "arcp", "nsz"},  # sums in any order; NaN and ∞ stay
    "free": True,  # the same, where NaN and ∞ can't occur
}

_limit: int | None = None
_within = threading.local()  # of a thread that `each` has begun: whether the others are busy, too


def limit(count: int | None) -> None:
    """Use at most ``count`` threads from now on, in kernels and in finufft; None: all cores."""
    global _limit
    number = real(count)
    if count is not None and (number is None or number < 1 or not number.is_integer()):
        raise MeshdepictError(f"threads={count} makes no sense: at least one is needed")
    _limit = count


def thread_count() -> int:
    """Return the number of threads in use."""
    if _limit is not None:
        return _limit
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def each(
    work: Callable[..., Any],
    pieces: Sequence[tuple[Any, ...]],
    done: Callable[[int], None] | None = None,
) -> None:
    """Call ``work(*piece)`` for every piece, in parallel; ``done(i)`` after piece i.

    At an error or Ctrl-C pieces not yet begun are dropped, and the error goes on. Within a piece
    of work that keeps all threads busy with others, pieces are done one after the other.
    """
    if len(pieces) == 1 or thread_count() == 1 or getattr(_within, "busy", False):
        for i, piece in enumerate(pieces):
            work(*piece)
            if done:
                done(i)
        return
    busy = len(pieces) >= thread_count()
    with ThreadPoolExecutor(thread_count(), initializer=_mark, initargs=(busy,)) as pool:
        running = {pool.submit(work, *piece): i for i, piece in enumerate(pieces)}
        pending: Iterable[Any] = set(running)
        try:
            while pending:
                finished, pending = wait(pending, return_when=FIRST_COMPLETED)
                for future in finished:
                    future.result()
                    if done:
                        done(running[future])
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _mark(busy: bool) -> None:  # noqa: FBT001
    _within.busy = busy


def kernel(
    rounding: Rounding = "as written", *, inline: bool = False
) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function by numba, to be run by several threads at once, and keep it on disk.

    Machine code that was kept is loaded without numba; see `meshdepict.kernels`. It is compiled
    anew where the function, a constant or a kernel that it refers to has changed.

    Parameters
    ----------
    rounding : {"as written", "contracted", "reordered", "free"}
        What may be done to its sums and products, so that they are quicker.
    inline : bool
        Whether its text becomes part of the kernels that call it.
    """
    options = {
        "nogil": True, "error_model": "numpy", "fastmath": _FLAGS[rounding],
        "inline": "always" if inline else "never",
    }  # fmt: skip
    return lambda function: Kernel(function, options)


def spans(count: int, pieces: int) -> list[tuple[int, int]]:
    """Cut ``range(count)`` into about ``pieces`` spans of equal length."""
    pieces = max(1, min(pieces, count))
    cuts = [count * i // pieces for i in range(pieces + 1)]
    return list(pairwise(cuts))
