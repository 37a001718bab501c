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
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from meshdepict.baking.look import bake_volume
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.shapes.phantom import ct_phantom
from meshdepict.shapes.volume import Volume
from meshdepict.threads import thread_count
from meshdepict.voxels.grid_sums import BINDING, GRADIENT


def row(*cells: object) -> None:
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def seconds(work: Callable[[], Any]) -> tuple[float, float, Any]:
    """Return the time on the wall and on all cores together, and the result."""
    start, cpu = time.perf_counter(), time.process_time()
    result = work()
    return time.perf_counter() - start, time.process_time() - cpu, result


def peak() -> float:
    """Return the most memory that the process has had, in GB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def scipy_gradients(volume: Volume, width: float, truncate: float) -> list[np.ndarray]:
    from scipy.ndimage import gaussian_filter

    values = volume.values.astype(np.float64)
    widths = width / volume.spacing[::-1]
    return [gaussian_filter(values, widths, order=o, truncate=truncate) for o in GRADIENT]


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
    volume = ct_phantom((args.size,) * 3)
    low, high = volume.range
    bake_volume(ct_phantom((24, 24, 24)))  # compiles, or loads what was compiled
    before = peak()
    first, cpu, baked = seconds(lambda: bake_volume(volume))
    space = baked.space
    light = min(seconds(lambda: bake_volume(space, light=(1, 0, 1)))[:2] for _ in range(5))
    filled = min(seconds(lambda: bake_volume(space, light=(1, 0, 1)).rgba)[:2] for _ in range(3))
    row("", f"{volume.n_samples / 1e6:.1f} Mvoxel, {low:g} to {high:g} HU", "on all cores together")
    row("---", "---", "---")
    row("threads", thread_count(), "")
    row("shaded voxels", f"{len(space.points):,} ({space.shaded_share:.1%})", "")
    row("scale space of 9 scales and first shading", f"{first:.2f} s", f"{cpu:.2f} s")
    row("a new light, intensity", f"{light[0]:.3f} s", f"{light[1]:.3f} s")
    row("a new light, with RGBA of all voxels", f"{filled[0]:.3f} s", f"{filled[1]:.3f} s")
    row("most memory, and before with the volume", f"{peak():.2f} GB, {before:.2f} GB", "")
    if not args.no_scipy:
        total = [0.0, 0.0]
        for width in space.widths[1:]:
            wall, own, _ = seconds(lambda width=width: scipy_gradients(volume, width, 4))
            total = [total[0] + wall, total[1] + own]
        row("scipy's gaussian_filter, 3 a scale", f"{total[0]:.1f} s", f"{total[1]:.1f} s")
        row("ratio", f"{total[0] / first:.1f}", f"{total[1] / cpu:.1f}")
    if args.errors:
        worst = [largest_angle(space, scale) for scale in range(1, 10)]
        row("largest angle at each scale", ", ".join(f"{angle:.1e}" for angle in worst), "")


if __name__ == "__main__":
    main()
