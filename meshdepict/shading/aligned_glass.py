"""Local Light Alignment through a body of glass: guides of the transmitted view where it leaves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading.glass import Glass, through_glass
from meshdepict.shading.reached import USUAL_RAYS
from meshdepict.shading.seen_through import transmitted_guides, turned_guides

__all__ = ["aligned_glass"]

Single = NDArray[np.float32]


def aligned_glass(
    space: ScaleSpace,
    normals: Single,
    eye: Single,
    lamps: Sequence[Light],
    environments: Sequence[Environment],
    *,
    transmitted: float,
    background: float,
    refraction: float,
    frosting: float,
    sharpness: float,
    strengths: NDArray[Any],
    rays: int = USUAL_RAYS,
) -> Single:
    """Return light through both interfaces of a body, aligned where it leaves.

    Parameters
    ----------
    space : ScaleSpace
    normals : (S, 3, n) array
        Of the scales between which light is aligned, finest first.
    eye : (3, n) array
        As for `transmitted_guides`.
    lamps : sequence of Light
        What shines through, weighted by ``transmitted``.
    environments : sequence of Environment
        What lies behind, weighted by ``background``: white if there is none.
    strengths : (S − 1,) array
    refraction, frosting, sharpness
        As for `light_alignment.light_alignment`.
    rays : int
        Of each sample.

    Returns
    -------
    (n, 3) array, (n, 1) where nothing has a colour
    """
    from meshdepict.shading.alignment_kernel import align_chain

    def aligned(leaving: Single, begin: int, end: int) -> Any:
        guides = transmitted_guides(normals[:, :, begin:end], eye[:, begin:end], refraction)
        turned = turned_guides(guides, leaving)
        return lambda light: align_chain(turned, light.direction, strengths, sharpness)

    return through_glass(
        space, eye, Glass(refraction, frosting, rays), lights=lamps,
        aligned=aligned if strengths.any() else None, transmitted=transmitted,
        skies=environments or (None,), background=background,
    )  # fmt: skip
