"""Light Warping's equations (Vergne, Pacanowski, Barla, Granier and Schlick, SIGGRAPH 2009).

Directions are unit vectors in a point's frame (u, v, z): the principal directions of curvature and
the axis that the warp leaves alone, which is the view's or, with object curvature, the normal.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["jacobian", "unwarp", "warp", "warp_scale"]

Floats = NDArray[Any]


def warp_scale(curvature: ArrayLike, magnitude: float) -> Floats:
    """Return λ = tan(arctan(α κ)/6 + π/4), the stretch of the stereographic plane along u or v.

    Parameters
    ----------
    curvature : array_like
        κ, positive where concave.
    magnitude : float
        α.

    Returns
    -------
    array
        In [1/√3, √3]: 1 where flat, and λ(−κ) = 1/λ(κ).
    """
    curvature = _floats(curvature)
    # Both factors are clipped so that their product neither overflows nor becomes 0·∞.
    most = float(np.sqrt(np.finfo(curvature.dtype).max))
    product = np.clip(curvature, -most, most) * curvature.dtype.type(
        np.clip(magnitude, -most, most)
    )
    tangent = np.tan(np.arctan(product) / 6)
    return (1 + tangent) / (1 - tangent)


def warp(light: ArrayLike, scale_u: ArrayLike, scale_v: ArrayLike) -> Floats:
    """Return W(l): the direction scaled by λ_u and λ_v on the stereographic plane (§5).

    Parameters
    ----------
    light : (…, 3) array_like
        Unit vectors in the frame (u, v, z).
    scale_u, scale_v : (…) array_like
        λ_u, λ_v of `warp_scale`.

    Returns
    -------
    (…, 3) array
        Unit vectors; z and −z stay where they are.
    """
    x, y, q = _stereographic(light, scale_u, scale_v)
    t = _depth(x, y, q)
    return np.stack([t * x, t * y, t * q - 1], axis=-1)


def unwarp(light: ArrayLike, scale_u: ArrayLike, scale_v: ArrayLike) -> Floats:
    """Return W⁻¹(l), the inverse of `warp`: the same with 1/λ_u and 1/λ_v."""
    return warp(light, 1 / _floats(scale_u), 1 / _floats(scale_v))


def jacobian(light: ArrayLike, scale_u: ArrayLike, scale_v: ArrayLike) -> Floats:
    """Return J(l'), how much W⁻¹ enlarges a small solid angle about l' (eq. 2).

    Parameters
    ----------
    light : (…, 3) array_like
        Unit vectors l' in the frame (u, v, z), before unwarping.
    scale_u, scale_v : (…) array_like
        λ_u, λ_v of `warp_scale`.

    Returns
    -------
    (…) array
        In [1/9, 9]; 1/(λ_u λ_v) at z. At −z, where it depends on the azimuth from which one
        comes, the mean over all azimuths.
    """
    u, v = _floats(scale_u), _floats(scale_v)
    # The paper's formula, with t = 2q/D of the inverse warp: J = t² / (λ_u λ_v).
    t = _depth(*_stereographic(light, 1 / u, 1 / v))
    return np.where(t > 0, t * t / (u * v), (u * u + v * v) / 2)


def _stereographic(
    light: ArrayLike, scale_u: ArrayLike, scale_v: ArrayLike
) -> tuple[Floats, Floats, Floats]:
    """Return λ_u l_u, λ_v l_v and q = 1 + l_z, without its cancellation near −z."""
    light = _floats(light)
    u, v, z = light[..., 0], light[..., 1], light[..., 2]
    q = np.where(z < 0, (u * u + v * v) / (1 - np.minimum(z, 0)), 1 + z)
    return u * scale_u, v * scale_v, q


def _depth(x: Floats, y: Floats, q: Floats) -> Floats:
    """Return t = 2q / (q² + x² + y²), where the ray through the plane meets the sphere; 0 at −z."""
    square = q * q + x * x + y * y
    number = np.finfo(square.dtype)
    found = square > number.tiny / number.eps  # below, squares have lost their digits: that is −z
    return np.where(found, 2 * q / np.where(found, square, 1), 0)


def _floats(values: ArrayLike) -> Floats:
    """Return an array of float32 where it was, else of float64."""
    array = np.asarray(values)
    return array if array.dtype == np.float32 else array.astype(np.float64)
