"""Normal enhancement (Cignoni, Scopigno and Tarini, Computers & Graphics 2005)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.scene.vectors import cosines
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing

__all__ = ["enhanced_normals", "normal_enhancement"]


def enhanced_normals(normals: ArrayLike, smoothed: ArrayLike, amount: float) -> NDArray[Any]:
    """Return normalise(n + k (n − n_σ)) for unit normals (…, 3), n itself where that vanishes."""
    n, smooth = np.asarray(normals), np.asarray(smoothed)
    away = n + n.dtype.type(amount) * (n - smooth)
    length = np.linalg.norm(away, axis=-1, keepdims=True)
    return np.where(length > 0, away / np.where(length > 0, length, 1), n)


def _reads(last: int, *, amount: float, **_: Any) -> Reads:
    """Return the shape's own normals and the coarsest, unless these have no weight."""
    return Reads(normals=frozenset((0, last) if amount else (0,)))


@method(
    scales=5,
    linear=True,
    compared={},
    reads=_reads,
    source="Normal enhancement (Cignoni et al. 2005)",
)
def normal_enhancement(
    space: ScaleSpace,
    light: LightLike,
    *,
    amount: Annotated[
        float, Range(0, 1e3, help="k: how far normals are turned", soft=(0, 5))
    ] = 1.5,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by Lambert's cosine with normals that are turned away from the smoothed ones.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale; the coarsest normals are the smoothed ones.
    amount : float
        k of normalise(n + k (n − n_σ)).

    Raises
    ------
    MeshdepictError
        If the scale space has no smoothed scale.
    """
    require_smoothing(space, "normal enhancement", scales=5)
    smoothed = space.normals_at(space.last if amount else 0)
    normals = enhanced_normals(space.normals_at(0), smoothed, amount)
    cosine = cosines(normals, as_light(light).direction)
    return exposed(np.maximum(cosine, 0), exposure)
