"""What steps of a bake cost: core-seconds and bytes of a sample, and what a process needs at all.

Measured on scans of 36 to 500 thousand vertices, terrain and CT, on the machine that
`machine.speed` compares others with; scripts/budget_check.py says how right predictions are.
"""

from __future__ import annotations

import math
import sys

__all__ = [
    "CELL_SECONDS", "COLOR_SECONDS", "CURVATURE_SECONDS", "FILE_SECONDS", "GRID_SECONDS",
    "LIGHT_SECONDS", "OWN_SECONDS", "PICTURE_SECONDS", "PROGRAM_SECONDS", "RAY_SECONDS",
    "SEEN_SECONDS", "SHADING_SECONDS", "TAP_SECONDS", "TEXEL_SECONDS", "TONES_SECONDS",
    "TYPICAL_SECONDS", "VOXEL_SECONDS", "crowded", "loading_seconds", "sums_share",
]  # fmt: skip

# --- of a sample ---------------------------------------------------------------------------------

# A shape's own normals, areas and edges, where they are not there yet.
OWN_SECONDS = {"mesh": 1.7e-6, "volume": 0.35e-6, "image": 0.0, "height field": 0.01e-6}
GRID_SECONDS = 0.02e-6
"""Of every voxel, shown or not."""

CURVATURE_SECONDS = {"mesh": 0.3e-6, "volume": 0.8e-6, "image": 0.2e-6, "height field": 0.05e-6}
SEEN_SECONDS = 0.4e-6
SHADING_SECONDS = 0.17e-6
COLOR_SECONDS = {"mesh": 0.4e-6, "volume": 0.15e-6, "image": 0.4e-6, "height field": 0.04e-6}
RAY_SECONDS = 0.2e-6
"""Of one ray."""
LIGHT_SECONDS = 6e-9
"""Of one light of an environment."""

# A set of normals: of a volume or a raster, whatever its width, and of an image for each tap of its
# kernels.
VOXEL_SECONDS = 0.38e-6
CELL_SECONDS = 0.032e-6
TAP_SECONDS = 0.9e-9

# Tones that follow the shape: some samples are looked at; of terrain all of them are made first.
TONES_SECONDS = 0.14
TYPICAL_SECONDS = 0.35e-6

TEXEL_SECONDS = 0.3e-6

FILE_SECONDS = {"mesh": 1.0e-6, "volume": 0.02e-6, "image": 0.0, "height field": 0.1e-6}
"""Writing, and what is remarked about colours between vertices."""
PICTURE_SECONDS = 1.2

# --- of a process --------------------------------------------------------------------------------

PROGRAM_SECONDS = 0.55
"""The program itself, with what every bake loads."""

# Kernels are loaded when first called: those of sums and of shading with any method that smooths,
# which has loaded one of these modules; those of curvature and of rays with the first that asks.
SMOOTHING_SECONDS = {"mesh": 0.4, "volume": 0.75, "height field": 0.3}
_SMOOTHED = tuple(
    f"meshdepict.shading.{name}_kernel" for name in ("exaggerated", "material", "alignment")
)
BENDING_SECONDS, CASTING_SECONDS = 0.1, 0.05
_BENT = "meshdepict.curvature.tensor"

# --- how they grow -------------------------------------------------------------------------------

_MEASURED = 36_000  # vertices that a processor's caches hold
_NARROW = 0.75  # direct sums of predicted ones


def crowded(count: int, share: float) -> float:
    """Return times how much a sample costs where so many don't stay in the processor's caches.

    Parameters
    ----------
    count : int
        Samples.
    share : float
        By which it grows when their number doubles.
    """
    return 1 + share * max(0.0, math.log2(max(count, 1) / _MEASURED))


def sums_share(count: int, edges: float) -> float:
    """Return how much of its prediction a sum of normals takes, widths being so many edges."""
    return _NARROW if edges <= 2 else 0.62 * crowded(count, 0.18)


def loading_seconds(kind: str, *, smooths: bool, bends: bool, rays: bool) -> float:
    """Return the seconds that kernels take to load which no bake of this process has loaded."""
    seconds = 0.0
    if smooths and not any(name in sys.modules for name in _SMOOTHED):
        seconds += SMOOTHING_SECONDS.get(kind, 0.0)
    if bends and _BENT not in sys.modules:
        seconds += BENDING_SECONDS
    return seconds + CASTING_SECONDS * rays
