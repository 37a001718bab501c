"""The descriptor of Light Warping (Vergne et al. 2009, §4, fig. 6): curvature seen by the eye."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.options import Range, Samples
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shading.features import Foreshortening, Importance, Scale, bends, sight
from meshdepict.shading.importance import mean_between_scales, wanted_scales
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["view_curvature"]

# Display values: hollows, flats, bumps.
_WARM = np.array([0.80, 0.25, 0.09], np.float32)
_FLAT = np.array([0.93, 0.92, 0.89], np.float32)
_COLD = np.array([0.10, 0.35, 0.75], np.float32)


def _reads(
    last: int, *, scale: int, importance: ArrayLike | Samples | str | None, **_: Any
) -> Reads:
    return Reads(seen=bends(scale, "view", importance, last).seen)


@method(
    scales=1,
    lights="none",
    needs=("curvature",),
    reads=_reads,
    source="Light Warping (Vergne et al., SIGGRAPH 2009), §4 and fig. 6",
)
def view_curvature(
    space: ScaleSpace,
    light: object = None,
    *,
    view: View | str = "front",
    scale: Scale = 1,
    gain: Annotated[
        float, Range(0, 1e30, help="factor on curvature per pixel before tanh", soft=(0, 100))
    ] = 20.0,
    foreshortening: Foreshortening = 1.0,
    importance: Importance = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Colour hollows warm, bumps cold, silhouettes and creases black, as the view sees them.

    What it colours is (κ_u + κ_v)/2, half the trace of the Hessian of depth per pixel.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale, unless ``scale=0``.
    gain : float
        Colours are those of tanh(gain·mean). The default, 20, was chosen by eye on the bunny and
        the armadillo, in pictures 1000 pixels high.
    foreshortening : float
        0.4 in Radiance Scaling's shader.
    importance : str or array_like in [0, 1], optional
        Where fine detail matters (fig. 6, right); see `meshdepict.shading.light_warping`.

    Returns
    -------
    (n, 3) array of float32
        Display values.

    Raises
    ------
    MeshdepictError
        For a scale that the space does not have, and an importance that can't be had.
    """

    def at(scale: int) -> NDArray[np.float64]:
        seen = space.view_curvature(view, scale, foreshortening=foreshortening)
        return np.stack([seen.mean, seen.weight])

    if importance is None:
        mean, weight = at(scale)
    else:
        eye = sight(view, space, fitted=True)
        mean, weight = mean_between_scales(at, wanted_scales(space, eye, importance, scale=scale))
    hollow = np.tanh(np.clip(gain * mean, -20, 20)).astype(np.float32)[:, None]
    colour = _FLAT + np.abs(hollow) * (np.where(hollow > 0, _WARM, _COLD) - _FLAT)
    return exposed(colour * weight.astype(np.float32)[:, None], exposure)
