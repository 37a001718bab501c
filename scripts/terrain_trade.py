"""Measure relief of large models against GDAL and the Relief Visualization Toolbox.

    python scripts/terrain_trade.py                     # some minutes
    python scripts/terrain_trade.py --large             # and 40,000 × 40,000 cells in 2 GB
    MESHDEPICT_RVT=rvt/bin/python python scripts/terrain_trade.py

Prints Markdown. Peers are left out where they aren't installed: ``gdaldem`` (Debian's gdal-bin),
and rvt-py in an environment of its own. What is timed stands in `benchmarks/`: the best of several
runs, by the clock and of all processors together, since others use a machine, too. Ground is made
up; of the largest model a sixteenth of the blocks is on the disk, and the rest is level.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import shutil

import numpy as np
from tables import head, row

import meshdepict as md
from benchmarks import terrain, terrain_files
from benchmarks.timing import Cost, costs
from meshdepict.heights.horizons import sky_shares
from meshdepict.threads import thread_count


def shortest(benchmark: object, name: str, *params: object, runs: int = 3) -> Cost:
    return min(costs(benchmark, name, *params, runs=runs), key=lambda cost: cost.clock)


def line(what: str, cost: Cost, than: Cost | None = None, aim: str = "") -> None:
    """Print a row: seconds, and how many times another's."""
    times = "" if than is None else (
        f"{cost.clock / than.clock:.2f}, {cost.processor / than.processor:.2f}"
    )  # fmt: skip
    row(what, f"{cost.clock:.2f}", f"{cost.processor:.2f}", times, aim)


def levels_off(size: int) -> str:
    """Return by how much our hillshade and GDAL's differ, but for borders, where rules differ."""
    import rasterio

    pair = terrain_files.Hillshade()
    pair.setup(size)
    try:
        pair.time_relief(size)
        pair.gdaldem()
        found = []
        for path in (pair.shaded, pair.theirs):
            with rasterio.open(path) as file:
                found.append(file.read(1)[1:-1, 1:-1].astype(float))
    finally:
        pair.teardown(size)
    off = np.abs(np.rint(1 + found[0] * 254 / 255) - found[1])  # GDAL maps [0, 1] to 1 … 255
    return f"{off.max():.0f}"


def hillshade(size: int) -> None:
    pair = terrain_files.Hillshade()
    ours = shortest(pair, "time_relief", size)
    if shutil.which("gdaldem") is None:
        line(f"Horn hillshade, {size:,} × {size:,}, file to file", ours)
        return
    theirs = shortest(pair, "time_gdaldem", size)
    plain = shortest(pair, "time_gdaldem_plain", size)
    line(f"gdaldem hillshade, {size:,} × {size:,}, to the same kind of file", theirs)
    line("gdaldem hillshade, uncompressed, no overviews", plain)
    line(f"ours, file to file; off by {levels_off(2_000)} levels", ours, theirs, "≤ 1.5")
    kernel = shortest(terrain.Relief(), "time_one_light", size)
    line("ours, in memory", kernel, plain)


def sky_view(side: int) -> None:
    cells = shortest(terrain.Horizons(), "time_sky", "cells", side)
    lines = shortest(terrain.Horizons(), "time_sky", "lines", side)
    if "MESHDEPICT_RVT" in os.environ:
        toolbox = terrain_files.Toolbox()
        toolbox.setup(side)
        seconds = toolbox.track_sky(side)
        z = terrain.ground(side)
        ours = sky_shares(z, None, terrain.STEPS, directions=16, radius=10, horizon="cells")
        off = float(np.abs(ours - toolbox.shares).max())
        row(f"rvt-py's sky view, 16 directions, radius 10, {side:,} × {side:,}",
            f"{seconds:.2f}", "", "", "")  # fmt: skip
        aim = f"{seconds / cells.clock:.1f} × faster; ≥ 3 ×"
        line(f"ours by its rule (horizon=cells), off by {off:.0e}", cells, aim=aim)
    else:
        line(f"sky view by the toolbox's rule, {side:,} × {side:,}", cells)
    line("ours along lines, the default", lines)


def exaggerated(size: int) -> None:
    cost = shortest(terrain_files.Exaggerated(), "time_relief", size)
    line(f"Exaggerated Shading, 9 scales, {size:,} × {size:,}, file to file", cost, aim="≤ 10 s")


def large() -> None:
    os.environ["MESHDEPICT_HUGE"] = "1"
    huge = terrain_files.Huge()
    cost = shortest(huge, "time_relief", runs=1)
    what = f"the same, {huge.size:,} × {huge.size:,}, --max-memory {huge.allowed}"
    line(f"{what}: {huge.peak / 1e9:.2f} GB at most", cost, aim="2 GB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--large", action="store_true", help="and 40,000 × 40,000 cells")
    parser.add_argument("--scale", type=float, default=1.0, help="of the sides of models")
    given = parser.parse_args()

    def side(whole: int) -> int:
        return max(64, round(whole * given.scale))

    print(f"{thread_count()} cores, {platform.processor() or platform.machine()}, meshdepict "
          f"{md.__version__}; load {os.getloadavg()[0]:.0f}.")  # fmt: skip
    head("", "seconds", "of all processors", "times (clock, processors)", "aim")
    hillshade(side(10_000))
    sky_view(side(4_000))
    exaggerated(side(4_000))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    row(f"most memory of this process: {peak:.2f} GB", "", "", "", "")
    if given.large:
        large()


if __name__ == "__main__":
    main()
