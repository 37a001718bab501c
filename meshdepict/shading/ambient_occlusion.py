"""Ambient occlusion (Zhukov, Iones and Kronin 1998): light from all around, as far as it gets."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.transport.occlusion import MOST_RAYS

__all__ = ["Rays", "ambient_occlusion"]

Rays = Annotated[int, Range(2, MOST_RAYS, help="rays from each point", soft=(16, 1024))]


@method(
    local=False, lights="none", needs=("rays",), source="Ambient occlusion (Zhukov et al. 1998)"
)
def ambient_occlusion(
    space: ScaleSpace, light: object, *, rays: Rays = 256, exposure: Exposure = 1.0
) -> NDArray[np.float32]:
    """Shade by the share of the light from all around that reaches a point: hollows are dark.

    Parameters
    ----------
    rays : int
        At 256 the typical error on a scan is about one grey level.
    """
    del light
    return exposed(space.occlusion(rays), exposure)
