"""Measure the scale space of a volume against scipy's plain Gaussian gradient.

    python scripts/volume_speed.py                  # 160³ voxels, about a minute
    python scripts/volume_speed.py --size 320       # 33 million voxels, some minutes
    python scripts/volume_speed.py --no-scipy       # ours alone

Prints Markdown. The subject is the procedural head under the preset "bone". scipy filters the
whole volume in float64, three derivatives a scale, cut off at its default of 4 widths, on one core
(it has no threads); meshdepict has the threads of the machine, and normals only where they are
shown. Errors are against scipy cut off at 9 widths, where the tolerance binds.
"""

from __future__ import annotations

import argparse
import resource

import numpy as np
from tables import row

from benchmarks.timing import Cost, costs
from benchmarks.volumes import Baking, NewLight, Scipy, scipy_gradients
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.threads import thread_count
from meshdepict.voxels.grid_sums import BINDING


def peak() -> float:
    """Return the most memory that the process has had, in GB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def largest_angle(space: GridSpace, scale: int) -> float:
    """Return the largest angle between our normals and scipy's, where the tolerance binds."""
    width = float(space.widths[scale])
    gradients = scipy_gradients(space.shape, width, truncate=9)
    found = np.stack([g.ravel()[space.voxels] for g in gradients]) / space.shape.spacing[:, None]
    expected = -(space.shape.direction @ found)
    length = np.linalg.norm(expected, axis=0)
    low, high = space.shape.range
    binding = length * width >= BINDING * (high - low)
    normals = space.normals[scale][binding]
    half = np.linalg.norm(normals - (expected / length).T[binding], axis=1) / 2
    return float(2 * np.arcsin(half.max()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", type=int, default=160)
    parser.add_argument("--no-scipy", action="store_true")
    parser.add_argument("--errors", action="store_true", help="compare the normals, too: slow")
    args = parser.parse_args()
    baking, light = Baking(), NewLight()

    def shortest(benchmark: object, name: str, runs: int = 1) -> Cost:
        return min(costs(benchmark, name, args.size, runs=runs), key=lambda cost: cost.clock)

    first, most = shortest(baking, "time_baking"), peak()
    space, volume = baking.baked.space, baking.volume
    low, high = volume.range
    row("", f"{volume.n_samples / 1e6:.1f} Mvoxel, {low:g} to {high:g} HU", "on all cores together")
    row("---", "---", "---")
    row("threads", thread_count(), "")
    row("shaded voxels", f"{len(space.points):,} ({space.shaded_share:.1%})", "")
    for what, cost in {
        "scale space of 9 scales and first shading": first,
        "a new light, intensity": shortest(light, "time_shading", 5),
        "a new light, with RGBA of all voxels": shortest(light, "time_colours", 3),
    }.items():
        row(what, f"{cost.clock:.3f} s", f"{cost.processor:.3f} s")
    row("most memory, with the volume", f"{most:.2f} GB", "")
    if not args.no_scipy:
        plain = shortest(Scipy(), "time_gradients")
        row(
            "scipy's gaussian_filter, 3 a scale", f"{plain.clock:.1f} s", f"{plain.processor:.1f} s"
        )
        ratios = plain.clock / first.clock, plain.processor / first.processor
        row("ratio", *(f"{ratio:.1f}" for ratio in ratios))
    if args.errors:
        worst = [largest_angle(space, scale) for scale in range(1, 10)]
        row("largest angle at each scale", ", ".join(f"{angle:.1e}" for angle in worst), "")


if __name__ == "__main__":
    main()
