"""Show that both equations of Light Warping agree as the number of lights grows.

    python scripts/light_warping_agreement.py       # docs/light_warping.png, half a minute

Eq. 1 looks an environment up in warped directions, eq. 2 warps lights that were sampled from it
beforehand. The reference is eq. 1 over many directions. Needs matplotlib, which PyVista brings.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

import meshdepict as md
from meshdepict.scene.equirectangular import grid

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "light_warping.png"
COUNTS = tuple(16 * 2**k for k in range(9))
REFERENCE = 1 << 14


def studio() -> md.Environment:
    """Return a window, a lamp and a dim room."""
    towards = grid(64, 128)
    window = np.exp(8 * (towards @ (np.array([-1, 1, 1]) / 3**0.5) - 1))
    lamp = np.exp(20 * (towards @ np.array([0.8, 0, 0.6]) - 1))
    light = 0.1 + window[..., None] * [3, 2.5, 2] + lamp[..., None] * [1, 2, 3]
    return md.Environment(light)


def errors(space: md.ScaleSpace, curvature: str) -> NDArray[np.float64]:
    """Return root mean square differences from the reference (2, counts): eq. 1 and eq. 2."""
    environment = studio()

    def shaded(count: int, quadrature: str) -> NDArray[np.float32]:
        return md.shading.light_warping(
            space, environment, quadrature=quadrature, lights=count, curvature=curvature,
            exposure=0.3,
        )  # fmt: skip

    exact = shaded(REFERENCE, "directions")
    return np.array(
        [
            [np.sqrt(np.mean((shaded(count, q) - exact) ** 2)) for count in COUNTS]
            for q in ("directions", "lights")
        ]
    )


def main() -> None:
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    space = md.scale_space(md.samples.golf_ball(3_000, dimples=12, depth=0.08), scales=2)
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for curvature, style in (("object", "-"), ("view", "--")):
        for label, values in zip(
            ("eq. 1, directions", "eq. 2, lights"), errors(space, curvature), strict=True
        ):
            axes.loglog(COUNTS, values, style, label=f"{label}, {curvature} curvature")
            print(f"{label}, {curvature}: " + "  ".join(f"{v:.2g}" for v in values))
    axes.axhline(1 / 255, color="grey", lw=0.8)
    axes.text(COUNTS[-1], 1.1 / 255, "a grey level", color="grey", size=8, ha="right")
    axes.set(xlabel="lights, or directions", ylabel="difference from eq. 1 (rms)")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(OUTPUT, dpi=120)
    print(OUTPUT)


if __name__ == "__main__":
    main()
