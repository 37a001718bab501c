"""Tests in several processes: how many, each one's share of the cores, and numba's one cache."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import pytest

WORKERS = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))

# Each process has about a GB of scans, and no file of tests is more than an eighth of the whole.
MOST = 8


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """One process a core; none beside this one for a single file, which is done before they start.

    PYTEST_XDIST_AUTO_NUM_WORKERS goes before, as does -n with a number.
    """
    from meshdepict import threads

    if "PYTEST_XDIST_AUTO_NUM_WORKERS" in os.environ:
        return None
    files = {argument.partition("::")[0] for argument in config.args}
    cores = threads.thread_count()
    if cores == 1 or (len(files) == 1 and files.pop().endswith(".py")):
        return 0
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the others have the other cores
    return min(cores, MOST)


@pytest.fixture(autouse=True)
def share_of_threads() -> None:
    """Two threads at least, so that what runs side by side does so here, too."""
    from meshdepict import threads

    if WORKERS > 1:
        threads.limit(None)
        threads.limit(max(2, threads.thread_count() // WORKERS))


def lock_the_cache_of_kernels() -> None:
    """Let one process at a time use numba's index of a function's compiled kernels.

    Two that add to it at once could give two kernels the same number, and the one's code to the
    other's arguments.
    """
    import fcntl

    from numba.core.caching import IndexDataCacheFile

    def alone(method: Callable[..., Any]) -> Callable[..., Any]:
        def call(file: Any, *given: Any) -> Any:
            folder = os.open(file._cache_path, os.O_RDONLY)
            try:
                fcntl.flock(folder, fcntl.LOCK_EX)
                return method(file, *given)
            finally:
                os.close(folder)  # which lets go of the lock

        return call

    IndexDataCacheFile.save = alone(IndexDataCacheFile.save)
    IndexDataCacheFile.load = alone(IndexDataCacheFile.load)


if WORKERS > 1 and os.name == "posix":
    lock_the_cache_of_kernels()
