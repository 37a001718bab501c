"""Measure the constants of the cost model, and print them in the form in which the code has them.

    python scripts/cost_constants.py           # a minute
    python scripts/cost_constants.py --bakes   # and those of predicted bakes, two minutes more

By `_PAIR_SECONDS` and others `meshdepict.sums` chooses between adding up neighbours and frequency
space; by the last four `meshdepict info` predicts a bake. They only have to be right within a
factor of two: where both ways cost the same, either will do. So change them when libraries or
processors have, not after every run; the same constants give the same bits everywhere.
"""

from __future__ import annotations

import argparse
import functools
import itertools
from collections.abc import Iterator

import numpy as np
from tables import ROOT

from benchmarks import subjects
from benchmarks.processes import Command
from benchmarks.sums import CELLS, ERROR, Blocks, Direct, Grid, Points
from benchmarks.timing import Cost, cost, costs
from meshdepict.sums import spectral_sums as spectral

GAUSSIAN, GRID, SPECTRAL, REPORT = (
    f"meshdepict.{name}"
    for name in ("sums.gaussian", "sums.grid_sums", "sums.spectral_sums", "commands.report")
)
BAKES = (40_000, 160_000)  # vertices

Constant = tuple[str, str, float]  # module, name, value


def quickest(taken: list[Cost]) -> float:
    """Return the shortest processor time: the clock also counts what other programs do."""
    return min(each.processor for each in taken)


def least(benchmark: object, *params: object, runs: int) -> float:
    """Return the core-seconds of a sum."""
    return quickest(costs(benchmark, "time_summing", *params, runs=runs))


def neighbours(runs: int) -> Iterator[Constant]:
    """Yield a pair and ten channels; its share without any, and that of each."""
    seconds = {}
    for channels in (5, 10):
        benchmark = Direct()
        taken = least(benchmark, channels, runs=runs)
        seconds[channels] = taken / pairs(benchmark.points / benchmark.width, benchmark.radius)
    each = (seconds[10] - seconds[5]) / 5
    yield GAUSSIAN, "_PAIR_SECONDS", seconds[10]
    yield GAUSSIAN, "_PAIR_BASE", (seconds[10] - 10 * each) / seconds[10]
    yield GAUSSIAN, "_PAIR_CHANNEL", each / seconds[10]


def pairs(points: np.ndarray, radius: float) -> float:
    """Return how many pairs the model takes to be added up: of a sample, scaled up."""
    few = points[:: max(1, len(points) // 64)]
    squared = ((few[:, None] - points) ** 2).sum(axis=2)
    return float(np.mean(squared <= (1.2 * radius) ** 2)) * len(points) ** 2


def sparse_grids(runs: int) -> Iterator[Constant]:
    """Yield a point; a channel of a node, spread and gathered; a tap and channel of a blur."""
    rows, seconds = [], []
    for channels, edges, way in itertools.product(*Blocks.params):
        benchmark = Blocks()
        seconds.append(least(benchmark, channels, edges, way, runs=runs))
        parts = benchmark.grid.parts(benchmark.width, benchmark.rule)
        anew = float(way == "anew")
        rows.append([anew * parts[0], anew * parts[1], *parts[1:]])
    scale = 1 / np.array(seconds)
    found, *_ = np.linalg.lstsq(np.array(rows) * scale[:, None], np.ones(len(rows)), rcond=None)
    for name, value in zip(("_POINT", "_SPREAD", "_GATHER", "_TAP"), found, strict=True):
        yield GRID, f"{name}_SECONDS", value


def transforms(runs: int) -> Iterator[Constant]:
    """Yield a point and node of the grid; a cell of a grid in the cache, and beyond it."""
    points = Points()
    single = least(points, "float32", runs=runs)
    double = least(points, "float64", runs=runs)
    nodes = spectral._point_seconds(ERROR, 2.0) / spectral._SPREAD_SECONDS
    yield SPECTRAL, "_SPREAD_SECONDS", single / (2 * points.count * nodes)
    cells, seconds = np.transpose([per_cell(asked, runs) for asked in CELLS])
    near, far = np.median(seconds[:3]), np.median(seconds[-2:])
    cached = seconds <= np.sqrt(near * far)
    yield SPECTRAL, "_FFT_SECONDS", near
    yield SPECTRAL, "_CACHED_CELLS", cells[cached].max(initial=cells[0])
    yield SPECTRAL, "_UNCACHED", far / near
    yield SPECTRAL, "_DOUBLE", double / single


def per_cell(asked: int, runs: int) -> tuple[float, float]:
    """Return how many cells a grid of about so many has, and the seconds of each and transform."""
    grid = Grid()
    seconds = least(grid, "float32", asked, runs=runs)
    _, _, modes = spectral._torus(grid.xyz, grid.xyz, ERROR)
    refinement, _ = spectral._refinement(modes, 2 * grid.xyz.shape[1], ERROR)
    cells = float(np.prod(refinement * modes))
    return cells, seconds / (2 * cells)


def bakes(runs: int) -> Iterator[Constant]:
    """Yield core-seconds and bytes of a default bake: of the program itself, and of a vertex."""
    seconds, sizes = [], []
    for count in BAKES:
        subjects.BALLS[str(count)] = count
        command = Command()
        command.setup(str(count))
        try:
            work = functools.partial(command.time_baking, str(count))
            seconds.append(quickest([cost(work) for _ in range(runs)]))
            sizes.append(command.track_memory(str(count)))
        finally:
            command.teardown(str(count))
    span = BAKES[1] - BAKES[0]
    for name, (small, large) in (("SECONDS", seconds), ("BYTES", sizes)):
        slope = (large - small) / span
        yield REPORT, f"_START_{name}", small - slope * BAKES[0]
        yield REPORT, f"_VERTEX_{name}", slope


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--bakes", action="store_true", help="predict bakes, too")
    parser.add_argument("--runs", type=int, default=5)
    given = parser.parse_args()
    before = ""
    for part in (neighbours, sparse_grids, transforms, *[bakes] * given.bakes):
        for module, name, value in part(given.runs):
            if module != before:
                print(f"# {module.replace('.', '/')}.py, by {__file__.removeprefix(f'{ROOT}/')}")
            print(f"{name} = {value:.2g}", flush=True)
            before = module


if __name__ == "__main__":
    main()
