"""Measure live shading: frames per second under a moving light, for every live method.

    python scripts/live_speed.py                       # a golf ball of 144,000 faces
    python scripts/live_speed.py bunny.ply             # a mesh of one's own
    python scripts/live_speed.py --vertices 1750000    # a golf ball of 3.5 million faces
    … --size 1920x1080 --frames 50 --samples 8

Prints Markdown, with the OpenGL renderer: a graphics card, or llvmpipe where there is none. A
frame is a new light, drawn and finished; the figure is the median of all frames after the first.
Several samples per pixel cost software OpenGL more than the shading does, hence none by default.
"""

from __future__ import annotations

import argparse
import statistics
from typing import Any

from tables import head, row

from benchmarks import scale_spaces, subjects
from benchmarks.live import SEVERAL, NewLight
from benchmarks.timing import best, costs
from meshdepict.viewer.live import live_methods

# What a method is measured with, where its defaults would leave something out.
OPTIONS: dict[str, list[dict[str, Any]]] = {
    "light_alignment": [{}, {"material": "phong"}],
    "light_warping": [{}, {"material": "phong"}],
}


def pixels(text: str) -> tuple[int, int]:
    width, height = text.split("x")
    return int(width), int(height)


def renderer() -> str:
    """Return the OpenGL renderer that VTK found."""
    import pyvista as pv

    window = pv.Plotter(off_screen=True, window_size=[16, 16])
    window.show(auto_close=False)
    lines = window.render_window.ReportCapabilities().splitlines()
    window.close()
    return next((line for line in lines if line.startswith("OpenGL renderer")), "no OpenGL").strip()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("mesh", nargs="?", help="a mesh file, instead of a golf ball")
    parser.add_argument("--vertices", type=int, default=72_000, help="of the golf ball")
    parser.add_argument("--size", type=pixels, default="800x600", help="of the picture, in pixels")
    parser.add_argument("--samples", type=int, default=0, help="per pixel, against jagged edges")
    parser.add_argument("--frames", type=int, default=21)
    given = parser.parse_args()
    width, height = given.size

    subjects.BALLS["ball"] = given.vertices
    subject = given.mesh or "ball"
    mesh = subjects.mesh(subject)
    seconds = best(scale_spaces.Making(), "time_making", subject, runs=1)
    print(f"{renderer()}, {width} x {height} pixels, {given.samples} samples")
    print(f"{len(mesh.vertices):,} vertices, {len(mesh.faces):,} faces, 9 scales ({seconds:.1f} s)")
    head("method", "options", "ready, s", "a frame, ms", "frames/s")
    for method in live_methods():
        for options in OPTIONS.get(method, [{}]):
            light = NewLight(subject, size=given.size, samples=given.samples, options=options)
            ready = best(light, "time_getting_ready", method, runs=1)
            runs = costs(light, "time_frame", method, runs=given.frames)
            frame = statistics.median(run.clock for run in runs)
            words = [f"{name}={value}" for name, value in options.items()]
            words += ["8 lights"] if method in SEVERAL else []
            rate = 1 / max(frame, 1e-9)
            row(method, ", ".join(words), f"{ready:.2f}", f"{1000 * frame:.1f}", f"{rate:.0f}")


if __name__ == "__main__":
    main()
