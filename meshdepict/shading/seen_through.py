"""What Local Light Alignment takes from behind a surface: its guides there, and the background."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.environment import Environment
from meshdepict.shading.transmission import fresnel

__all__ = ["background_light", "transmitted_guides", "turned_guides"]

Single = NDArray[np.float32]

_NEAR_SILHOUETTE = 0.2  # n·e, as the view's curvature has it


def transmitted_guides(planes: Single, eye: Single, refraction: float) -> Single:
    """Return the transmitted view t_i of every scale (Local Light Alignment, §6), unit everywhere.

    t_i = (ηc − √(1 + η²(c² − 1))) n_i − ηe, c = n_i·e, η = 1/refraction. A scale whose normal turns
    away from the eye, c ≤ 0, transmits nothing and is skipped: it takes the next finer one's t_i,
    and there is nothing between both. **Departs from the paper**: from c = 0.2 on it fades to that,
    because what is skipped at once leaves a border along every coarse silhouette.

    Parameters
    ----------
    planes : (S, 3, n) array
        Unit normals, fine to coarse.
    eye : (3, n) or (3, 1) array
        Towards the eye, which no normal of the finest scale turns away from.
    refraction : float
        Index behind the surface over that before it, ≥ 1: there is no total reflection.
    """
    ratio = np.float32(1 / refraction)
    guides = np.empty_like(planes)
    for scale, normal in enumerate(planes):
        c = (normal * eye).sum(axis=0)
        held = np.maximum(c, 0)
        through = (ratio * held - np.sqrt(1 + ratio**2 * (held**2 - 1))) * normal - ratio * eye
        if scale:
            within = np.clip(c / np.float32(_NEAR_SILHOUETTE), 0, 1)
            share = within * within * (3 - 2 * within)
            through = guides[scale - 1] + share * (through - guides[scale - 1])
        guides[scale] = through / np.maximum(np.linalg.norm(through, axis=0), np.float32(1e-6))
    return guides


def turned_guides(guides: Single, leaving: Single) -> Single:
    """Return the transmitted views of every scale, turned so that the finest is where rays leave.

    The shortest turn takes t_1 there, and the others with it: each scale differs from the next as
    it did.

    Parameters
    ----------
    guides : (S, 3, n) array
        Of `transmitted_guides`.
    leaving : (3, n) array
        Unit.
    """
    first = guides[0]
    axis = np.cross(first, leaving, axis=0)
    cosine = (first * leaving).sum(axis=0)
    # v cos + a × v + a (a·v) / (1 + cos), a = t_1 × leaving of length sin.
    along = (guides * axis).sum(axis=1, keepdims=True)
    across = np.cross(np.broadcast_to(axis, guides.shape), guides, axis=1)
    found = guides * cosine + across + along * axis / np.maximum(1 + cosine, np.float32(1e-4))
    size = np.linalg.norm(found, axis=1, keepdims=True)
    return np.asarray(found / np.maximum(size, np.float32(1e-6)), np.float32)


def background_light(
    normals: Single,
    eye: Single,
    environment: Environment | None,
    *,
    refraction: float,
    frosting: float,
) -> Single:
    """Return what a surface lets through of what lies behind it, unaligned (fig. 8, right pairs).

    One refraction at the front, as through thin solid glass: (1 − F(n·e)) L(t), L of an Environment
    blurred by what microfacets of slope α bend the view, α (1 − 1/η); without one an even white.

    Parameters
    ----------
    normals : (3, n) array
    eye : (3, n) array
        As for `transmitted_guides`.
    environment : Environment, optional
    refraction, frosting : float
        η and α.

    Returns
    -------
    (n, 3) array of an Environment, else (n, 1)
    """
    cosine = np.clip((normals * eye).sum(axis=0), 0, 1)
    share = (1 - fresnel(cosine, refraction)).astype(np.float32)[:, None]
    if environment is None:
        return share
    through = transmitted_guides(normals[None], eye, refraction)[0]
    return share * environment.lookup(through.T, blur=frosting * (1 - 1 / refraction))
