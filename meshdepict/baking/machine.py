"""How fast this machine is, beside the one on which the costs of bakes were measured.

A short measurement, made once and kept in the user's cache with the machine's name: numbers are
sorted, looked up here and there, and put through an exponential, as sums of normals and rays do.
Predictions alone ask for it. How sums are added up never depends on it, so that the same bake has
the same bits everywhere.
"""

from __future__ import annotations

import functools
import json
import os
import platform
import time

import numpy as np

from meshdepict.files.cache import keep, kept

__all__ = ["measured_seconds", "speed"]

_REFERENCE_SECONDS = 1.48e-3
"""Of the measurement where costs.py was measured; scripts/budget_check.py tells how far off."""

_FILE = "speed.json"
_COUNT = 1 << 17
_RUNS = 5


@functools.cache
def speed() -> float:
    """Return how many times as fast as there; measured at most once for a machine."""
    name = f"{platform.node()} {platform.machine()} {os.cpu_count()}"
    try:
        known = json.loads(kept(_FILE) or b"{}")
        seconds = float(known["seconds"]) if known.get("machine") == name else 0.0
    except (ValueError, TypeError, KeyError, AttributeError):  # somebody else's file
        seconds = 0.0
    if not 1e-5 < seconds < 10:
        seconds = measured_seconds()
        keep(_FILE, json.dumps({"machine": name, "seconds": seconds}).encode())
    return _REFERENCE_SECONDS / seconds


def measured_seconds() -> float:
    """Return the processor's seconds of a fixed piece of work: the least of a few runs."""
    numbers = np.random.default_rng(2006).random(_COUNT, np.float32)
    places = np.argsort(numbers)
    return max(min(_once(numbers, places) for _ in range(_RUNS)), 1e-5)


def _once(numbers: np.ndarray, places: np.ndarray) -> float:
    begin = time.thread_time()
    np.sort(numbers)
    np.exp(-numbers.astype(np.float64)[places]).sum()
    np.cumsum(numbers[places])
    return time.thread_time() - begin
