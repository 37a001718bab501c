"""Cool–warm shading (Gooch, Gooch, Shirley and Cohen, SIGGRAPH 1998)."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.scene.vectors import cosines
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["gooch", "tones"]


def tones(
    surface: float, *, blue: float, yellow: float, cool: float, warm: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the cool and the warm tone (3,): blue and yellow, mixed with the surface's grey."""
    return (
        np.array([cool * surface, cool * surface, blue + cool * surface], np.float32),
        np.array([yellow + warm * surface, yellow + warm * surface, warm * surface], np.float32),
    )


@method(source="Gooch, Gooch, Shirley, Cohen, SIGGRAPH 1998")
def gooch(
    space: ScaleSpace,
    light: LightLike,
    *,
    surface: Annotated[float, Range(0, 1, help="the surface's own grey")] = 1.0,
    blue: Annotated[float, Range(0, 1, help="blue in the cool tone")] = 0.4,
    yellow: Annotated[float, Range(0, 1, help="yellow in the warm tone")] = 0.4,
    cool: Annotated[float, Range(0, 1, help="share of the surface's grey in the cool tone")] = 0.2,
    warm: Annotated[float, Range(0, 1, help="share of the surface's grey in the warm tone")] = 0.6,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade from a cool tone away from the light to a warm one towards it, never to black.

    ``t·warm + (1 − t)·cool``, ``t = ½ + ½ n·l``, with the paper's example values.

    Parameters
    ----------
    surface, blue, yellow, cool, warm : float
        See `tones`; cool and warm are the paper's α and β.

    Returns
    -------
    (n, 3) array of float32
        Display colours in [0, 1].
    """
    direction = as_light(light).direction.astype(np.float32)
    share = ((1 + cosines(space.normals_at(0), direction)) / 2)[:, None]
    low, high = tones(surface, blue=blue, yellow=yellow, cool=cool, warm=warm)
    return exposed(share * high + (1 - share) * low, exposure)
