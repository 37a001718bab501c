"""Measure what a method costs beyond Lambert and a scale space, as whole processes.

    python scripts/method_cost.py scan.ply                          # every method, minutes
    python scripts/method_cost.py scan.ply radiance_scaling phong --runs 9

Compares ``meshdepict bake -m METHOD`` with ``bake -m lambert`` that makes a scale space of the same
size in the same process. Both run in turns, and the median of the differences between neighbours is
told, since other work on a machine comes and goes; processor time is steadier than the clock.
"""

from __future__ import annotations

import argparse
import statistics

from tables import head, row

from benchmarks.processes import Method
from benchmarks.timing import Cost, cost
from meshdepict.shading import METHODS, declaration


def measure(mesh: str, method: str, runs: int) -> tuple[list[Cost], list[Cost]]:
    """Return the costs of the method and of its baseline, run in turns after one of each."""
    both = Method(mesh)
    both.setup(method)
    found: tuple[list[Cost], list[Cost]] = [], []
    works = both.time_baking, both.time_lambert_with_its_scales
    try:
        for turn in range(runs):
            for i in (0, 1) if turn % 2 else (1, 0):
                found[i].append(cost(lambda work=works[i]: work(method)))
    finally:
        both.teardown()
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("mesh")
    usual = [name for name in METHODS if "heights" not in declaration(METHODS[name]).needs]
    parser.add_argument("methods", nargs="*", default=usual, metavar="METHOD")
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    head("method", "scales", "seconds", "beyond Lambert and scales", "… of the processor")
    for method in given.methods:
        own, base = measure(given.mesh, method, given.runs)
        pairs = list(zip(own, base, strict=True))
        row(
            f"`{method}`",
            declaration(METHODS[method]).scales,
            f"{statistics.median(a.clock for a in own):.2f}",
            f"{statistics.median(a.clock - b.clock for a, b in pairs):+.2f}",
            f"{statistics.median(a.processor - b.processor for a, b in pairs):+.2f}",
        )


if __name__ == "__main__":
    main()
