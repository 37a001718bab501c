"""Local Light Alignment's equations (Mestres, Vergne, Noûs and Thollot, Eurographics 2021)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["align", "confidence", "transition"]

# The light has no direction in the base plane where it stands along the base's normal: there the
# confidence fades to zero continuously, as ‖l̄‖/√(‖l̄‖² + ε²).
_SINGULAR = 1e-3
_NO_TURN = 1e-12  # ‖t‖ below which light and guide are one


def transition(confidence: ArrayLike, sharpness: float) -> NDArray[np.float64]:
    """Return W_γ(λ) = λ / (e^−γ (1 − λ) + λ): 0 at 0, 1 at 1, λ itself for γ = 0."""
    share = np.asarray(confidence, float)
    return share / np.maximum(np.exp(-sharpness) * (1 - share) + share, np.finfo(float).tiny)


def confidence(light: ArrayLike, normal: ArrayLike, base: ArrayLike) -> NDArray[np.float64]:
    """Return λ = λ1 λ2 in [0, 1]: how far the light is from where its guide switches (§4).

    λ1 is 0 where the light changes sides and on a dark side that turns away from the base; λ2,
    the sine between normal and base, is 0 where there is no feature.
    """
    l, n, z = (np.asarray(v, float) for v in (light, normal, base))  # noqa: E741
    c, along_x, along_y, length = _frame(l, n, z)
    level = np.linalg.norm(np.cross(l, z), axis=-1)
    first = 2 / np.pi * np.arctan2(np.abs(along_x), np.abs(along_y))
    first = first * level / np.sqrt(level**2 + _SINGULAR**2)
    first = np.where((along_x >= 0) | (c > 0), first, 0.0)
    return np.clip(first * length, 0, 1)


def align(
    light: ArrayLike,
    normal: ArrayLike,
    base: ArrayLike,
    *,
    strength: float,
    sharpness: float = 3.0,
) -> NDArray[np.float64]:
    """Turn a light towards the normal on a feature's bright side, off it on the dark one (eq. 1).

    Parameters
    ----------
    light, normal, base : (…, 3) array_like
        Unit vectors, broadcast against each other: the light of the next coarser scale, the
        normal at this scale and at the next coarser one. In place of normals, reflected or
        transmitted view vectors align highlights or refractions (§6).
    strength : float
        σ in [0, 1]: 0 leaves the light as it is, 1 turns it all the way where the confidence is 1.
    sharpness : float
        γ ≥ 0: larger values narrow the transition from bright to dark.

    Returns
    -------
    (…, 3) array of float64
        Unit vectors.
    """
    l, n, z = np.broadcast_arrays(*(np.asarray(v, float) for v in (light, normal, base)))  # noqa: E741
    c, along_x, _, length = _frame(l, n, z)
    # In the frame x = (n − c z)/n_x the paper's R(y, −π/2) n = −n_z x + n_x z is (z − n_z n)/n_x.
    dark = (z - c[..., None] * n) / np.where(length > 0, length, 1.0)[..., None]
    guide = np.where((along_x >= 0)[..., None], n, dark)
    cosine = np.einsum("...i,...i->...", guide, l)
    sine = np.linalg.norm(np.cross(l, guide), axis=-1)
    angle = strength * transition(confidence(l, n, z), sharpness) * np.arctan2(sine, cosine)
    towards = guide - cosine[..., None] * l
    size = np.linalg.norm(towards, axis=-1)
    towards = towards / np.where(size < _NO_TURN, 1.0, size)[..., None]
    turned = np.cos(angle)[..., None] * l + np.sin(angle)[..., None] * towards
    return np.where((size < _NO_TURN)[..., None], l, turned)


def _frame(
    light: NDArray[Any], normal: NDArray[Any], base: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return n_z, n_x l·x, n_x l·y and n_x in the local frame of §4."""
    across = np.cross(base, normal)
    c = np.einsum("...i,...i->...", normal, base)
    along_z = np.einsum("...i,...i->...", light, base)
    along_x = np.einsum("...i,...i->...", light, normal) - along_z * c
    along_y = np.einsum("...i,...i->...", light, across)
    return c, along_x, along_y, np.linalg.norm(across, axis=-1)
