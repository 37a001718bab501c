"""How scripts time what asv times: the same benchmarks, set up the same way."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Cost:
    """Seconds by the clock, and of all processors together, child processes' included."""

    clock: float
    processor: float


def cost(work: Callable[[], object]) -> Cost:
    """Return what one run takes."""
    before, start = _processor_seconds(), time.perf_counter()
    work()
    clock = time.perf_counter() - start
    return Cost(clock, _processor_seconds() - before)


def _processor_seconds() -> float:
    """Return what this process and its finished children have had of all processors."""
    children = os.times()
    return time.process_time() + children.children_user + children.children_system


def shortest(work: Callable[[], object], runs: int = 3) -> float:
    """Return the shortest time: whatever else a machine does only ever adds some."""
    return min(cost(work).clock for _ in range(runs))


def costs(benchmark: Any, name: str, *params: object, runs: int = 3) -> list[Cost]:
    """Return what runs of one benchmark take, after it was set up once.

    Parameters
    ----------
    benchmark : object
        An instance of a class of this package.
    name : str
        Its method, ``"time_new_light"`` for instance.
    *params
        Values of the benchmark's parameters.
    """
    benchmark.setup(*params)
    try:
        work = getattr(benchmark, name)
        return [cost(lambda: work(*params)) for _ in range(runs)]
    finally:
        getattr(benchmark, "teardown", lambda *_: None)(*params)


def best(benchmark: Any, name: str, *params: object, runs: int = 3) -> float:
    """Return the shortest time of one benchmark's runs."""
    return min(each.clock for each in costs(benchmark, name, *params, runs=runs))


def statement_seconds(code: str, runs: int = 9) -> float:
    """Return the shortest time of a statement that fresh processes run, without Python's own."""
    timed = f"import time\nstart = time.perf_counter()\n{code}\nprint(time.perf_counter() - start)"
    return min(
        float(subprocess.run([sys.executable, "-c", timed], check=True, capture_output=True).stdout)
        for _ in range(runs)
    )
