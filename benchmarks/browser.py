"""The page of ``meshdepict view --browser``: from a slider to the picture, and turning the view.

Headless Chromium with software OpenGL, on the machine that also shades: from the slider's event to
pixels read back from the canvas, 1,000 × 800.
"""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks import subjects

SLIDERS = {
    "exaggerated": "option-exaggeration",
    "light_alignment": "option-strength",
    "radiance_scaling": "option-magnitude",
}
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


class Page:
    """Milliseconds in the browser, by its own clock.

    Parameters
    ----------
    subject : str
        Of `subjects`, or the path of a mesh.
    """

    params = (tuple(SLIDERS),)
    param_names = ("method",)
    unit = "ms"
    timeout = 300

    def __init__(self, subject: str = "golf ball") -> None:
        self.subject = subject

    def setup(self, method: str) -> None:
        sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
        try:
            from chromium import Chromium, find_chromium
        except ImportError as error:
            raise NotImplementedError(str(error)) from None
        finally:
            del sys.path[0]
        if find_chromium() is None:
            raise NotImplementedError("there is no Chromium")
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
            server = subprocess.Popen(
                [sys.executable, "-c", SERVE, str(subjects.path(self.subject)), method],
                stdout=subprocess.PIPE, text=True,
            )  # fmt: skip
            stack.enter_context(server)
            stack.callback(server.send_signal, signal.SIGINT)
            self.tab = Chromium(Path(folder), size=(1304, 830))
            stack.callback(self.tab.close)
            self.tab.open(server.stdout.readline().strip())
            self.tab.wait("+document.querySelector('canvas')?.dataset.frames > 0")
            self.slide(method, 3)
            self.open = stack.pop_all()

    def teardown(self, method: str) -> None:
        if hasattr(self, "open"):  # no setup that was refused
            self.open.close()

    def slide(self, method: str, count: int = 25) -> list[float]:
        """Move the method's slider and return milliseconds to each picture."""
        return self.tab.js(TURN_SLIDER.format(slider=SLIDERS[method], count=count))

    def turn(self, count: int = 25) -> list[float]:
        """Turn the view and return milliseconds to each picture."""
        return self.tab.js(TURN_VIEW.format(count=count))

    def track_slider_to_picture(self, method: str) -> float:
        return float(np.median(self.slide(method)))

    def track_turning(self, method: str) -> float:
        return float(np.median(self.turn()))
