"""Measure how long the page of ``meshdepict view --browser`` takes from a slider to the picture.

    MESHDEPICT_DATA=… python scripts/browser_speed.py [MESH]

Headless Chromium with software OpenGL, on the machine that also shades: `benchmarks.browser` says
what is timed. Prints Markdown.
"""

from __future__ import annotations

import sys

import numpy as np
from tables import head, row

from benchmarks.browser import SLIDERS, Page


def main() -> None:
    page = Page(sys.argv[1] if len(sys.argv) > 1 else "bunny")
    head("method", "slider to picture, median", "90 % within", "aim", "turning the view, median")
    for method in SLIDERS:
        try:
            page.setup(method)
        except NotImplementedError as missing:
            sys.exit(f"nothing to measure: {missing} (or give a mesh)")
        try:
            slid, turned = page.slide(method), page.turn()
        finally:
            page.teardown(method)
        row(
            method,
            f"{np.median(slid):.0f} ms",
            f"{np.quantile(slid, 0.9):.0f} ms",
            "300 ms",
            f"{np.median(turned):.0f} ms",
        )


if __name__ == "__main__":
    main()
