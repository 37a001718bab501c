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
import time
from typing import Any

import numpy as np
import pyvista as pv

import meshdepict as md
from meshdepict.drawing.canvas import place
from meshdepict.viewer.live import LiveShading, live_methods

# What a method is measured with, where its defaults would leave something out.
OPTIONS: dict[str, list[dict[str, Any]]] = {
    "light_alignment": [{}, {"material": "phong"}],
    "light_warping": [{}, {"material": "phong"}],
}
SEVERAL = ("light_warping",)  # shown with eight lights


def pixels(text: str) -> tuple[int, int]:
    width, height = text.split("x")
    return int(width), int(height)


def moving_light(step: int) -> tuple[float, float]:
    """Return azimuth and elevation: once round in about 40 frames."""
    return 9.0 * step, 40.0


def lit(method: str, step: int, view: md.View) -> Any:
    lamp = md.Light(md.scene.as_light(moving_light(step), view).direction)
    return lamp.spread(60, count=8) if method in SEVERAL else lamp


def median_seconds(
    live: LiveShading, mesh: md.Mesh, view: md.View, given: argparse.Namespace
) -> float:
    """Return the median time from a new light to the finished frame."""
    window = pv.Plotter(off_screen=True, window_size=list(given.size))
    window.render_window.SetMultiSamples(given.samples)
    window.add_actor(live.actor)
    place(window.camera, view, mesh)
    window.reset_camera_clipping_range()
    live.check(window)
    times = []
    for step in range(given.frames):
        start = time.perf_counter()
        live.set_light(lit(live.method, step, view))
        window.render_window.Render()
        window.render_window.WaitForCompletion()
        times.append(time.perf_counter() - start)
    window.close()
    return float(np.median(times))


def renderer() -> str:
    """Return the OpenGL renderer that VTK found."""
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

    mesh = md.read_mesh(given.mesh) if given.mesh else md.samples.golf_ball(given.vertices)
    view = md.View.fitted("front", mesh, aspect=width / height)
    start = time.perf_counter()
    nine = md.scale_space(mesh, scales=9)
    seconds = time.perf_counter() - start
    print(f"{renderer()}, {width} x {height} pixels, {given.samples} samples")
    print(f"{len(mesh.vertices):,} vertices, {len(mesh.faces):,} faces, 9 scales ({seconds:.1f} s)")
    print("\n| method | options | ready, s | a frame, ms | frames/s |")
    print("| --- | --- | --- | --- | --- |")
    for method in live_methods():
        for options in OPTIONS.get(method, [{}]):
            start = time.perf_counter()
            live = LiveShading(nine, method, options=options, light=lit(method, 0, view), view=view)
            ready = time.perf_counter() - start
            frame = median_seconds(live, mesh, view, given)
            words = [f"{name}={value}" for name, value in options.items()]
            words += ["8 lights"] if method in SEVERAL else []
            rate = 1 / max(frame, 1e-9)
            print(
                f"| {method} | {', '.join(words)} | {ready:.2f} | {1000 * frame:.1f} | "
                f"{rate:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
