"""Measure what a method costs beyond Lambert and a scale space, as whole processes.

    python scripts/method_cost.py scan.ply                          # every method, minutes
    python scripts/method_cost.py scan.ply radiance_scaling phong --runs 9

Compares ``meshdepict bake -m METHOD`` with ``bake -m lambert`` that makes a scale space of the same
size in the same process. Both run in turns, and the median of the differences between neighbours is
told, since other work on a machine comes and goes; processor time is steadier than the clock.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from meshdepict.shading import METHODS, declaration

# Lambert with the scale space that the method declares, which it then doesn't look at.
BASELINE = """
import sys
from dataclasses import replace
from meshdepict.cli import main
scales, ratio, *words = sys.argv[1:]
if int(scales):  # as the command would be: it loads no method before it parses
    from meshdepict.shading import lambert
    lambert.declaration = replace(lambert.declaration, scales=int(scales), ratio=float(ratio))
sys.exit(main(words))
"""


@dataclass
class Costs:
    """Seconds of runs: by the clock, and of the processor."""

    clock: list[float] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)

    def run(self, *words: str, bytecode: Path) -> None:
        """Run Python with these words and add what it took."""
        env = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
        env["PYTHONPYCACHEPREFIX"] = str(bytecode)  # compiled before, as in an installed package
        before, start = os.times(), time.perf_counter()
        subprocess.run([sys.executable, *words], check=True, env=env, stdout=subprocess.DEVNULL)
        self.clock.append(time.perf_counter() - start)
        after = os.times()
        self.processor.append(
            after.children_user + after.children_system
            - before.children_user - before.children_system
        )  # fmt: skip


def median_difference(a: list[float], b: list[float]) -> float:
    return statistics.median(x - y for x, y in zip(a, b, strict=True))


def measure(mesh: Path, method: str, folder: Path, runs: int) -> tuple[Costs, Costs]:
    """Return the costs of the method and of its baseline, run in turns after one of each."""
    declared = declaration(METHODS[method])
    words = ["bake", str(mesh), "-o", str(folder / "out.ply"), "--force", "--quiet", "-m"]
    cases = (
        (Costs(), ["-m", "meshdepict", *words, method]),
        (Costs(), ["-c", BASELINE, str(declared.scales), str(declared.ratio), *words, "lambert"]),
    )
    for _, line in cases:  # fills the caches
        Costs().run(*line, bytecode=folder)
    for turn in range(runs):
        for costs, line in cases if turn % 2 else cases[::-1]:
            costs.run(*line, bytecode=folder)
    return cases[0][0], cases[1][0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("mesh", type=Path)
    parser.add_argument("methods", nargs="*", default=list(METHODS), metavar="METHOD")
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    print("| method | scales | seconds | beyond Lambert and scales | … of the processor |")
    print("| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for method in given.methods:
            own, base = measure(given.mesh, method, Path(folder), given.runs)
            print(
                f"| `{method}` | {declaration(METHODS[method]).scales} "
                f"| {statistics.median(own.clock):.2f} "
                f"| {median_difference(own.clock, base.clock):+.2f} "
                f"| {median_difference(own.processor, base.processor):+.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
