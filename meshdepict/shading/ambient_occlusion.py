"""Ambient occlusion (Zhukov, Iones and Kronin 1998): light from all around, as far as it gets."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.transport.rays import MOST_RAYS

__all__ = ["Rays", "ambient_occlusion"]

Rays = Annotated[int, Range(2, MOST_RAYS, help="rays from each point", soft=(16, 1024))]


_FEW = 0.05  # share of the samples that the range takes to black
_NOISE = 3 / 255  # rms error, as estimated, that the range may make visible
_DARKEST = 0.95


def settle(space: ScaleSpace | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return which openness is shown black: as given, else as uses the grey scale of the shape."""
    darkest, rays = options.get("darkest"), options["rays"]
    if darkest is not None or space is None:
        return {"darkest": darkest or 0.0}
    space = space.typical()
    values = space.occlusion(rays)
    error = space.occlusion_errors.get(rays, 0.0)
    low = float(np.quantile(values, _FEW)) if len(values) else 0.0
    least = max(0.0, min(low, 1 - error / _NOISE, _DARKEST))
    return {"darkest": math.floor(least * 1000) / 1000}


def _reads(last: int, *, rays: int, **_: Any) -> Reads:
    return Reads(normals=frozenset((0,)), rays=rays)


@method(
    local=False,
    lights="none",
    needs=("rays",),
    fits=settle,
    ground="paper",
    reads=_reads,
    source="Ambient occlusion (Zhukov et al. 1998)",
)
def ambient_occlusion(
    space: ScaleSpace,
    light: Any,
    *,
    rays: Rays = 256,
    darkest: Annotated[
        float | None, Range(0, 1 - 1e-6, help="openness that is shown black; 0 shows it as it is")
    ] = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by the share of the light from all around that reaches a point: hollows are dark.

    Parameters
    ----------
    rays : int
        At 256 the typical error on a scan is about one grey level.
    darkest : float, optional
        Unless given, what a twentieth of the samples is below, so that the grey scale is used;
        less where the error of the rays would show by more than three grey levels.
    """
    del light
    darkest = settle(space, {"rays": rays, "darkest": darkest})["darkest"]
    shown = (space.occlusion(rays) - np.float32(darkest)) / np.float32(1 - darkest)
    return exposed(np.maximum(shown, 0), exposure)
