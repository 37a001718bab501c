"""Print the tables of docs/scale.md: how time and memory grow, and what very large work takes.

    python scripts/scale.py                  # up to 3 million faces
    python scripts/scale.py --most 14e6      # up to 14 million

Each figure is of a process of its own: processor seconds, and the most memory that it ever had.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

CORES = 16
"""Of a machine in the predictions."""

MACHINES = (1, 10, 100)
TILE = 250_000


class Spent(NamedTuple):
    """What a process took: processor seconds, GB of memory, and what it told."""

    seconds: float
    memory: float
    told: float = 0.0


def alone(work: Callable[..., Any], *arguments: Any) -> Spent:
    """Do something in a process of its own; kernels are compiled, and imports done, before."""
    here, there = get_context("spawn").Pipe()
    process = get_context("spawn").Process(target=_measured, args=(there, work, arguments))
    process.start()
    there.close()
    spent: Spent = here.recv()
    process.join()
    here.close()
    return spent


def _measured(pipe: Any, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    from meshdepict import threads
    from meshdepict.files import limits

    threads.limit(1)
    limits.set_max_memory("64GB")
    warnings.simplefilter("ignore")
    _warm()
    start = time.process_time()
    told = work(*arguments)
    seconds = time.process_time() - start
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    pipe.send(Spent(seconds, most, told or 0.0))


def _warm() -> None:
    from meshdepict import samples
    from meshdepict.baking.look import Look

    Look().bake(samples.golf_ball(6_000, dimples=12))


# --- what is measured ---------------------------------------------------------------------------


def make_ball(path: str, faces: float) -> None:
    from meshdepict import samples
    from meshdepict.io import write_mesh

    write_mesh(path, samples.golf_ball(int(faces / 2)))


def whole(path: str) -> None:
    from meshdepict.baking.look import Look

    Look().bake(path).save(f"{path}.out.ply")


def by_tiles(path: str, tile: int) -> float:
    """Return the GB that tiles left for each other."""
    from meshdepict.baking.look import Look
    from meshdepict.distributed import tile_files
    from meshdepict.distributed.mesh_tiles import bake_by_tiles

    kept = 0

    def keep(self: Any, name: str, array: Any, before: Any = tile_files.Site.keep) -> None:
        nonlocal kept
        kept += array.nbytes
        before(self, name, array)

    tile_files.Site.keep = keep  # type: ignore[method-assign]
    bake_by_tiles(Path(path), Path(f"{path}.out.ply"), Look(), in_here, tile=tile)
    return kept / 1e9


@contextmanager
def in_here(work: Callable[[Any], Any]) -> Any:
    yield InHere(work)


class InHere:
    """Workers that are this process."""

    ahead = 1

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self.work = work

    def give(self, number: int, item: Any) -> None:
        """Do a part."""
        from meshdepict.distributed.attempts import attempt

        self.found = attempt(self.work, number, item)

    def take(self) -> Any:
        """Return what became of it."""
        return self.found


def volume(side: int) -> None:
    from meshdepict.baking.out_of_core import bake_out_of_core
    from meshdepict.samples.phantom import ct_phantom

    head = ct_phantom((side,) * 3)
    with tempfile.TemporaryDirectory() as folder:
        bake_out_of_core(
            head.values, Path(folder) / "a.ome.zarr", spacing=head.spacing, hounsfield=True,
            value_range=head.range, scales=4, transfer="bone", chunks=(64, side, side),
        )  # fmt: skip


def terrain(side: int) -> None:
    from meshdepict.baking.look import Look
    from meshdepict.baking.relief import Relief
    from meshdepict.io.terrain import Terrain

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.npy"
        z = np.random.default_rng(1).normal(size=(side, side)).cumsum(axis=0).cumsum(axis=1)
        np.save(path, z.astype(np.float32))
        with Terrain(path) as ground:
            relief = Relief(ground, Look(), memory=2e8)
            for _ in relief.windows():
                pass


# --- tables -------------------------------------------------------------------------------------


def exponent(sizes: list[float], values: list[float]) -> float:
    """Return the power that values grow with."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def meshes(most: float) -> tuple[float, float, float]:
    """Print what meshes cost; return by tiles a face's seconds and GB left, and a worker's GB."""
    sizes = [faces for faces in (1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1.4e7) if faces <= most]
    print("| faces | at once: core-s | GB | by tiles: core-s | GB of a worker | GB left |")
    print("| ---: | ---: | ---: | ---: | ---: | ---: |")
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for faces in sizes:
            path = os.path.join(folder, f"{faces:.0f}.ply")
            alone(make_ball, path, faces)
            once, tiled = alone(whole, path), alone(by_tiles, path, TILE)
            found.append((once, tiled))
            print(
                f"| {faces:,.0f} | {once.seconds:.3g} | {once.memory:.2g} | {tiled.seconds:.3g} | "
                f"{tiled.memory:.2g} | {tiled.told:.2g} |",
                flush=True,
            )
            os.remove(path)
    large = [n for n, faces in enumerate(sizes) if faces >= 1e5]
    at = [sizes[n] for n in large]
    powers = [exponent(at, [found[n][way].seconds for n in large]) for way in (0, 1)]
    print(f"\nFrom 100,000 faces on: at once faces^{powers[0]:.2f}, by tiles ^{powers[1]:.2f}.\n")
    last = found[-1][1]
    return last.seconds / sizes[-1], last.told / sizes[-1], last.memory


def others() -> tuple[float, float]:
    """Print what voxels and cells cost; return core-seconds of each."""
    print("| work | size | core-s | ns each | GB |\n| --- | ---: | ---: | ---: | ---: |")
    costs = []
    for what, work, sides, power in (
        ("volume, 4 scales", volume, (96, 192, 256), 3),
        ("terrain, 9 scales", terrain, (1000, 2000, 4000), 2),
    ):
        for side in sides:
            spent = alone(work, side)
            each = spent.seconds / side**power
            size = " x ".join([f"{side:,}"] * power)
            print(
                f"| {what} | {size} | {spent.seconds:.3g} | {each * 1e9:.0f} | {spent.memory:.2g} |"
            )
        costs.append(each)
    return costs[0], costs[1]


def hours(seconds: float) -> str:
    """Return core-seconds as people say a time."""
    for amount, unit in ((86_400, "days"), (3_600, "hours"), (60, "min")):
        if seconds >= 1.5 * amount:
            return f"{seconds / amount:.2g} {unit}"
    return f"{seconds:.2g} s"


def main() -> None:
    reader = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    reader.add_argument("--most", type=float, default=3e6, help="faces, at most")
    face, left, memory = meshes(reader.parse_args().most)
    voxel, cell = others()
    heads = " | ".join(f"{count} x {CORES} cores" for count in MACHINES)
    print(f"\n| work | core-hours | {heads} |")
    print("| --- | ---: |" + " ---: |" * len(MACHINES))
    for what, seconds in (
        ("1 G faces by tiles, 9 scales", 1e9 * face),
        ("a teravoxel, 4 scales", 1e12 * voxel),
        ("a country at 1 m (100,000 km²), 9 scales", 1e11 * cell),
    ):
        times = " | ".join(hours(seconds / (count * CORES)) for count in MACHINES)
        print(f"| {what} | {seconds / 3600:,.3g} | {times} |")
    tiles = math.ceil(5e8 / TILE)
    print(
        f"\n1 G faces are {tiles:,} tiles; they leave {1e9 * left:,.0f} GB for each other, and a "
        f"worker takes {memory:.2g} GB."
    )


if __name__ == "__main__":
    main()
