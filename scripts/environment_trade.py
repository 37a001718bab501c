"""Measure how far sampled environments are off, by panorama, method and number of samples.

    python scripts/environment_trade.py FOLDER MESH > table.md      # about an hour

FOLDER holds panoramas (.hdr), each scaled to a mean of one half. Prints Markdown, which
docs/environments.md shows: root mean square errors in grey levels over a thousand vertices, against
lights for every pixel of the panorama at 512 × 256, and the time of shading the whole mesh by one
thread over that of as many lights without any lobe.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from tables import head, row

import meshdepict as md
from meshdepict import threads
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scene.environment import LUMINANCE, Environment
from meshdepict.scene.light import Light

COUNTS = (16, 54, 216)
ROWS = 256
CASES: dict[str, tuple[Any, dict[str, Any]]] = {
    "phong": (md.shading.phong, {}),
    "cook_torrance": (md.shading.cook_torrance, {}),
    "radiance_scaling, Phong": (md.shading.radiance_scaling, {}),
    "radiance_scaling, Cook–Torrance": (
        md.shading.radiance_scaling, {"material": "cook_torrance"},
    ),
    "light_warping, Lambert": (md.shading.light_warping, {}),
    "light_warping, Cook–Torrance": (md.shading.light_warping, {"material": "cook_torrance"}),
    "light_alignment, Lambert": (md.shading.light_alignment, {}),
    "light_alignment, Phong": (md.shading.light_alignment, {"material": "phong"}),
    "light_alignment, Cook–Torrance": (md.shading.light_alignment, {"material": "cook_torrance"}),
}  # fmt: skip


def panorama(path: Path) -> Environment:
    found = Environment.from_file(path)
    return Environment(
        found.pixels * (0.5 * 4 * np.pi / float(found.flux @ LUMINANCE)), name=path.stem
    )


def every_pixel(environment: Environment) -> list[Light]:
    """Lights for the pixels of 512 × 256: halves of coarser ones, blocks of finer ones."""
    times = max(1, ROWS // environment.pixels.shape[0])
    fine = Environment(np.kron(environment.pixels, np.ones((times, times, 1), np.float32)))
    flux, towards = fine.reduced(ROWS)
    return [
        Light(d, "", c / np.pi)
        for d, c in zip(towards.reshape(-1, 3), flux[..., :3].reshape(-1, 3), strict=True)
        if c.any()
    ]


def levels(values: Any) -> Any:
    return 255 * linear_to_srgb(np.clip(np.asarray(values, np.float64), 0, 1))


def seconds(call: Any) -> float:
    """Shortest processor time of three calls, by one thread."""
    call()
    found = []
    for _ in range(3):
        begin = time.process_time()
        call()
        found.append(time.process_time() - begin)
    return min(found)


def main() -> None:
    folder, path = Path(sys.argv[1]), Path(sys.argv[2])
    mesh = md.read(path)
    whole = md.scale_space(mesh, scales=5, ratio=1.7)
    some = np.linspace(0, len(mesh.vertices) - 1, 1000).astype(int)
    weights = np.eye(3)[np.zeros(len(some), int)]
    space = InterpolatedSpace(whole, np.repeat(some[:, None], 3, axis=1), weights)
    threads.limit(1)
    counts = [f"{count} (as many lights alone)" for count in COUNTS]
    head("panorama", "method", *counts, "time, 54")
    for file in sorted(folder.glob("*.hdr")):
        light = panorama(file)
        all_lights = every_pixel(light)
        for name, (function, options) in CASES.items():
            exact = levels(function(space, all_lights, **options))

            def error(found: Any, exact: Any = exact) -> float:
                return float(np.sqrt(np.mean((levels(found) - exact) ** 2)))

            cells = [
                f"{error(function(space, light, lights=count, **options)):.1f} "
                f"({error(function(space, light.lights(count), **options)):.1f})"
                for count in COUNTS
            ]
            ours = seconds(lambda f=function, o=options, e=light: f(whole, e, **o))
            lights = seconds(lambda f=function, o=options, e=light: f(whole, e.lights(54), **o))
            row(file.stem, name, *cells, f"× {ours / lights:.1f}")


if __name__ == "__main__":
    main()
