"""Attention: detail fades away from a focus, the finest first (Exaggerated Shading, §4, fig. 9)."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictWarning
from meshdepict.scales.space import ScaleSpace

__all__ = ["NEAR", "detail_share", "remoteness"]

_BESIDE = 1.0  # diagonals from the nearest sample: no place on the object, nor beside it
_GONE = 40.0  # (d/ρ_0)² that leaves 10⁻⁹ of the finest detail
NEAR = 0.1  # default radius, in diagonals of the shape: a head on a statue


def remoteness(space: ScaleSpace, focus: ArrayLike, radius: float | None) -> NDArray[np.float32]:
    """Return ½ (d/ρ_0)² of every sample, d being its distance from the focus.

    Parameters
    ----------
    space : ScaleSpace
    focus : (3,) array_like
        In world units.
    radius : float, optional
        ρ_0 in world units; a tenth of the diagonal unless given.
    """
    shape = space.shape
    unit = shape.diagonal or 1.0
    # Relative to the diagonal, so that neither huge nor tiny units lose squares of lengths.
    away = (space.points - np.asarray(focus, float)) / unit
    reach = NEAR if radius is None else max(radius / unit, 1e-150)
    with np.errstate(over="ignore"):  # infinitely far is as good as very far
        squared = ((away / reach) ** 2).sum(axis=1)
        nearest = float(np.hypot.reduce(away, axis=1).min(initial=np.inf))
    if _BESIDE < nearest < np.inf and squared.min() > _GONE:
        at = ",".join(f"{x:g}" for x in np.asarray(focus, float))
        middle = ",".join(f"{x:.4g}" for x in _middle(space))
        warnings.warn(
            f"{at} is {nearest:.3g} of the object's diagonals away from it: fine detail "
            f"is gone everywhere; the object's middle is {middle}",
            MeshdepictWarning,
            stacklevel=4,
        )
    return np.minimum(squared / 2, 1e30).astype(np.float32)


def _middle(space: ScaleSpace) -> NDArray[np.float64]:
    middle: NDArray[np.float64] = (space.points.min(axis=0) + space.points.max(axis=0)) / 2
    return middle


def detail_share(remoteness: ArrayLike, scale: int) -> NDArray[np.float64]:
    """Return the share of a scale's detail that is kept: exp(−½ (d/ρ_i)²), ρ_i = ρ_0 2^{i/2}."""
    return np.exp(-np.asarray(remoteness, float) / 2**scale)
