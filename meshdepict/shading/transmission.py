"""Light through a rough transparent surface (Walter et al. 2007, *Microfacet Models …*).

All vectors are arrays (3, …) of unit vectors that point away from the surface.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["facet_density", "fresnel", "refracted", "rough_transmission"]


def refracted(normal: NDArray[Any], eye: NDArray[Any], ratio: float) -> NDArray[Any]:
    """Return where the line of sight goes on beyond the surface: Snell's law.

    Parameters
    ----------
    normal, eye : (3, …) array
    ratio : float
        Index of refraction on the eye's side over that behind the surface.

    Returns
    -------
    (3, …) array
        Unit vectors; zero where the eye is behind the surface and at total reflection.
    """
    c = (normal * eye).sum(axis=0)
    squared = 1 + ratio**2 * (c**2 - 1)
    through = (ratio * c - np.sqrt(np.maximum(squared, 0))) * normal - ratio * eye
    return np.where((c > 0) & (squared >= 0), through, through.dtype.type(0))


def fresnel(cosine: NDArray[Any], refraction: float) -> NDArray[Any]:
    """Return the share of unpolarised light that a dielectric reflects (eq. 22).

    Parameters
    ----------
    cosine : array
        Of the angle to the normal, in [0, 1], on the side of the thinner medium.
    refraction : float
        Index of the denser medium over that of the thinner one, ≥ 1.
    """
    g = np.sqrt(refraction**2 - 1 + cosine**2)
    sum_, difference = g + cosine, g - cosine
    safe = np.where(sum_ > 0, sum_, 1)  # 0/0 at refraction 1: nothing is reflected
    second = (cosine * sum_ - 1) / (cosine * difference + 1)
    return 0.5 * (difference / safe) ** 2 * (1 + second**2)


def rough_transmission(
    normal: NDArray[Any],
    eye: NDArray[Any],
    light: NDArray[Any],
    *,
    refraction: float,
    roughness: float,
) -> NDArray[Any]:
    """Return f_t(l, e) |n·l| (eq. 21) for a light behind the surface, microfacets near to GGX.

    **Departs from the paper**: GGX (eq. 33) still has α²/π facets at right angles to the surface,
    and none beyond, which draws a border, torn by every bump, between light that a facet can
    refract into the eye and light that none can. That density is taken off, and the rest made up:
    D = α²/π · c²(2 − kc²)/(1 − kc²)², c = n·h, k = 1 − α², has ∫ D n·h dh = 1, too, is 0 at a right
    angle, and otherwise close to GGX, (1 + α²) times its peak.

    Parameters
    ----------
    normal, eye, light : (3, …) array
    refraction : float
        Index of refraction behind the surface, where the light is, over that at the eye; ≥ 1.
    roughness : float
        α_g of GGX.

    Returns
    -------
    array
        ≥ 0; 0 where the eye is behind the surface or the light before it.
    """
    ne = (normal * eye).sum(axis=0)
    nl = (normal * light).sum(axis=0)
    half = -(eye + refraction * light)  # towards the thinner medium for refraction > 1
    length = np.sqrt((half**2).sum(axis=0))
    half = half / np.where(length > 1e-6, length, 1)
    nh, eh, lh = ((half * v).sum(axis=0) for v in (normal, eye, light))
    seen = (ne > 0) & (nl < 0) & (nh > 0) & (eh > 0) & (lh < 0)
    a2 = roughness**2
    facets = facet_density(nh, a2)
    shadow = _smith(ne, a2) * _smith(nl, a2)
    share = 1 - fresnel(np.clip(eh, 0, 1), refraction)
    # η_e = 1, η_l = refraction; (η_e e·h + η_l l·h)² is the half vector's squared length.
    jacobian = np.abs(lh * eh) / np.maximum(length**2, 1e-12)
    value = jacobian * share * shadow * facets / np.maximum(ne, 1e-6)
    return np.where(seen, value, value.dtype.type(0))


def facet_density(cosine: NDArray[Any], a2: float) -> NDArray[Any]:
    """Return D of microfacets whose normals have a cosine ≥ 0 to the surface's; a2 is α²."""
    squared = cosine**2
    steep = squared * (1 - a2)
    return a2 / np.pi * squared * (2 - steep) / (1 - steep) ** 2


def _smith(cosine: NDArray[Any], a2: float) -> NDArray[Any]:
    """Return the share of GGX microfacets not hidden in one direction (eq. 34)."""
    squared = np.clip(cosine**2, 1e-12, 1)
    return 2 / (1 + np.sqrt(1 + a2 * (1 - squared) / squared))
