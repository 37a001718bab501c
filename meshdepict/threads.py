"""Threads: how many, and a parallel map with progress.

Kernels are compiled to release the interpreter's lock and are run by ordinary Python threads.
That needs no threading layer of numba's, so it is safe from several threads at once, after a
fork and on every platform, and Ctrl-C is answered between two pieces of work.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from itertools import pairwise
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.options import real

__all__ = ["each", "limit", "spans", "thread_count"]

_limit: int | None = None


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

    At an error or Ctrl-C pieces not yet begun are dropped, and the error goes on.
    """
    if len(pieces) == 1 or thread_count() == 1:
        for i, piece in enumerate(pieces):
            work(*piece)
            if done:
                done(i)
        return
    with ThreadPoolExecutor(thread_count()) as pool:
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


def spans(count: int, pieces: int) -> list[tuple[int, int]]:
    """Cut ``range(count)`` into about ``pieces`` spans of equal length."""
    pieces = max(1, min(pieces, count))
    cuts = [count * i // pieces for i in range(pieces + 1)]
    return list(pairwise(cuts))
