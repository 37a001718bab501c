"""Mean-curvature shading (Kindlmann, Whitaker, Tasdizen and Möller, IEEE Visualization 2003)."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shading.features import (
    DEFAULT_GAIN,
    CurvatureKind,
    Foreshortening,
    Scale,
    bends,
    convexity,
    sight,
)
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.radiance_scaling import scaling

__all__ = ["mean_curvature"]

_STRONGER = 4.0


def _reads(last: int, *, curvature: str, scale: int, gain: float | None, **_: Any) -> Reads:
    return bends(scale, curvature) if gain != 0 else Reads()


@method(
    scales=1,
    lights="none",
    needs=("curvature",),
    reads=_reads,
    source="Kindlmann et al., IEEE Visualization 2003",
)
def mean_curvature(
    space: ScaleSpace,
    light: object,
    *,
    view: View | str = "front",
    curvature: CurvatureKind = "object",
    scale: Scale = 1,
    gain: Annotated[
        float | None,
        Range(0, 1e30, help="factor on curvature; object 2.8, view 10 if none", soft=(0, 20)),
    ] = None,
    foreshortening: Foreshortening = 1.0,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by ½·2^κ: convexities bright, concavities dark, whatever the light.

    It is Radiance Scaling of ambient light alone, with magnitude ln 2.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale, unless ``scale=0``.
    gain : float, optional
        As in `radiance_scaling`, but four times that by default: this shading has a quarter of
        its range.
    foreshortening : float
        As in `radiance_scaling`.

    Returns
    -------
    (n,) array of float32
        Display values, ½ where flat, within [¼, 1] before exposure.
    """
    if gain is None:
        gain = _STRONGER * DEFAULT_GAIN[curvature]
    if gain == 0:
        return exposed(np.full(space.count, 0.5, np.float32), exposure)
    eye = sight(view, space, fitted=curvature == "view")
    kappa = convexity(
        space, eye, curvature=curvature, scale=scale, gain=gain, foreshortening=foreshortening
    )
    half = np.float32(0.5)
    return exposed(half * scaling(kappa, np.float32(1), magnitude=math.log(2)), exposure)
