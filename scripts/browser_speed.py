"""Measure how long the page of ``meshdepict view --browser`` takes from a slider to the picture.

    MESHDEPICT_DATA=… python scripts/browser_speed.py [MESH]

Headless Chromium with software OpenGL, on the machine that also shades: from the slider's event to
pixels read back from the canvas, 1,000 × 800. Prints Markdown.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
from chromium import Chromium  # noqa: E402

SERVE = (
    "import sys; from meshdepict.viewer.session import Session; "
    "from meshdepict.viewer.browser import serve; "
    "serve(Session(sys.argv[1], sys.argv[2]), open_browser=False)"
)
# The browser draws in the frame after the colours came; reading a pixel waits for the drawing.
TURN_SLIDER = """(async () => {{
  const canvas = document.querySelector("canvas"), slider = document.getElementById("{slider}");
  const pixel = () => canvas.getContext("webgl2").readPixels(0, 0, 1, 1, 6408, 5121,
    new Uint8Array(4));
  const times = [];
  for (let i = 0; i < {count}; i++) {{
    const [revision, low, high] = [canvas.dataset.revision, +slider.min, +slider.max];
    const start = performance.now();
    slider.value = low + (high - low) * (0.25 + 0.5 * Math.abs(Math.sin(i + 1)));
    slider.dispatchEvent(new Event("input"));
    while (canvas.dataset.revision === revision) await new Promise(requestAnimationFrame);
    await new Promise(requestAnimationFrame);
    pixel();
    times.push(performance.now() - start);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }}
  return times;
}})()"""
TURN_VIEW = """(async () => {{
  const canvas = document.querySelector("canvas"), times = [];
  for (let i = 0; i < {count}; i++) {{
    const [start, frames] = [performance.now(), canvas.dataset.frames];
    canvas.dispatchEvent(new KeyboardEvent("keydown", {{ key: "ArrowLeft" }}));
    while (canvas.dataset.frames === frames) await new Promise(requestAnimationFrame);
    canvas.getContext("webgl2").readPixels(0, 0, 1, 1, 6408, 5121, new Uint8Array(4));
    times.push(performance.now() - start);
  }}
  return times;
}})()"""


def measure(mesh: str, method: str, slider: str, count: int = 25) -> tuple[list[float], ...]:
    """Return milliseconds: of slider to picture, and of turning the view."""
    server = subprocess.Popen(
        [sys.executable, "-c", SERVE, mesh, method], stdout=subprocess.PIPE, text=True
    )
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        tab = Chromium(Path(folder), size=(1304, 830))
        try:
            tab.open(server.stdout.readline().strip())
            tab.wait("+document.querySelector('canvas')?.dataset.frames > 0", 60)
            tab.js(TURN_SLIDER.format(slider=slider, count=3))
            slid = tab.js(TURN_SLIDER.format(slider=slider, count=count))
            turned = tab.js(TURN_VIEW.format(count=count))
        finally:
            tab.close()
            server.send_signal(signal.SIGINT)
            server.wait(20)
    return slid, turned


def main() -> None:
    if len(sys.argv) > 1:
        mesh = sys.argv[1]
    elif "MESHDEPICT_DATA" in os.environ:
        mesh = os.environ["MESHDEPICT_DATA"] + "/mesh/bunny_69k.ply"
    else:
        sys.exit("give a mesh, or set MESHDEPICT_DATA to the folder of real scans")
    print("| method | slider to picture, median | 90 % within | aim | turning the view, median |")
    print("| --- | --- | --- | --- | --- |")
    for method, slider in (
        ("exaggerated", "option-exaggeration"),
        ("light_alignment", "option-strength"),
        ("radiance_scaling", "option-magnitude"),
    ):
        slid, turned = measure(mesh, method, slider)
        print(
            f"| {method} | {np.median(slid):.0f} ms | {np.quantile(slid, 0.9):.0f} ms | 300 ms | "
            f"{np.median(turned):.0f} ms |",
            flush=True,
        )


if __name__ == "__main__":
    main()
