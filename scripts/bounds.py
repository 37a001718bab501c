"""Set the seconds of every hot kernel beside what the machine's memory and multipliers allow.

    python scripts/bounds.py        # a minute; one core

Prints Markdown: docs/bounds.md is this output with a sentence round it. The bound is the longer of
two times: of the bytes that a kernel has to read or write once, at the rate of McCalpin's triad,
and of its multiply-adds, at the rate of a loop in registers, both measured in the same run. What is
timed stands in `benchmarks/kernels.py`.
"""

from __future__ import annotations

import argparse
import platform

from tables import head, row

from benchmarks.kernels import KERNELS, MultiplyAdds, Triad
from benchmarks.timing import costs

WHY = {
    "spreading": "Each vector is loaded, added to and stored, and most lie across two cache lines, "
    "for runs of 54 numbers begin anywhere. A surface fills a tenth of its blocks' nodes, all of "
    "which are made zero first, and what several pieces have spread on is added up once more.",
    "blurring": "A factor is loaded for each vector. Blocks are 18 kB: those above and below come "
    "from beyond the second cache, three or four for each; within it the kernel is two to three "
    "times as fast.",
    "gathering": "As spreading, without the stores; and of each block its neighbours' edges are "
    "copied.",
    "neighbours": "Sixteen targets share their sources, about twice as many as each alone has. At "
    "narrow widths finding them takes as long as adding them up.",
    "frequencies": "finufft: in double precision half as many numbers are in a vector, its grid is "
    "larger than the nearer caches, and transforms don't only multiply.",
    "rays": "Embree: a ray goes down several branches of the tree, and knows the next node only "
    "after the one before. The bound has one way down, without a branch that meets nothing.",
    "a bounce": "A face, its three corners, their values: single numbers from all over the arrays.",
    "voxels": "Sums along x are of one output each, whose order is kept, so that a grid in slabs "
    "gives the numbers of a whole one: they go through no vectors, and take more than half.",
}


def shortest(benchmark: object, runs: int) -> float:
    return min(cost.processor for cost in costs(benchmark, "time_running", runs=runs))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    triad, multiply = Triad(), MultiplyAdds()
    bandwidth = triad.needed().bytes / shortest(triad, runs) / 1e9
    head("one core", "")
    row("processor", platform.processor() or platform.machine())
    seconds = shortest(multiply, runs)
    rate = multiply.needed().multiply_adds / seconds / 1e9
    row("memory, triad, GB/s", f"{bandwidth:.1f}")
    row("multiply-adds, single precision, 10⁹/s", f"{rate:.0f}")
    head(
        "kernel", "ms", "MB", "10⁶ multiply-adds", "bound, ms", "by", "times the bound",
    )  # fmt: skip
    far = []
    for name, kind in KERNELS.items():
        benchmark = kind()
        seconds = shortest(benchmark, runs)
        needed = benchmark.needed()
        memory, multiplying = needed.bytes / bandwidth / 1e9, needed.multiply_adds / rate / 1e9
        bound = max(memory, multiplying)
        times = seconds / bound
        row(
            name, f"{1e3 * seconds:.2f}", f"{needed.bytes / 1e6:.1f}",
            f"{needed.multiply_adds / 1e6:.0f}", f"{1e3 * bound:.2f}",
            "memory" if memory > multiplying else "multiply-adds", f"{times:.1f}",
        )  # fmt: skip
        if times > 3:
            far.append(name)
    print("\nWhy some take more than three times their bound:\n")
    for name in far:
        print(f"* **{name}**: {WHY[name]}")


if __name__ == "__main__":
    main()
