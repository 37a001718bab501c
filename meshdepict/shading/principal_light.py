"""Light turned towards the direction that bends most (Exaggerated Shading, §4, eqs. 6–9, fig. 8).

Under a light along δ in the tangent plane shading changes by ‖II δ‖ = √(2Hκ_δ − K) per length,
most along d_1, the principal direction whose curvature has the larger magnitude. So every band's
light is nudged that way, by nothing where no direction is the larger:

    l_eff = l + s (κ_1² − κ_2²)(d_1·l) d_1 ,   s = strength · σ²
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.vectors import cosines
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["combine_bent_bands", "principal_light"]

# Where d_1, tangent to the finer normal, stands along the coarser one it has no direction there.
_UPRIGHT = 1e-6
# Keeps s (κ_1² − κ_2²) and its square within single precision; by then the light lies along d_1.
_MOST = 1e15


def principal_light(
    light: ArrayLike, normals: ArrayLike, d1: ArrayLike, bend: ArrayLike
) -> NDArray[np.float64]:
    """Return the light of eq. 9 before normalisation.

    Parameters
    ----------
    light : (…, 3) array_like
        Already projected on the planes of the normals (eq. 4), not normalised.
    normals : (…, 3) array_like
        Unit normals of the coarser scale.
    d1 : (…, 3) array_like
        Principal direction of the finer one; projected on the normals' planes here.
    bend : (…) array_like
        s (κ_1² − κ_2²) ≥ 0.
    """
    light, normals, d1 = (np.asarray(a, np.float64) for a in (light, normals, d1))
    across = d1 - normals * (d1 * normals).sum(axis=-1, keepdims=True)
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    across = np.where(length < _UPRIGHT, 0, across / np.where(length < _UPRIGHT, 1, length))
    along = np.asarray(bend) * (across * light).sum(axis=-1)
    return light + along[..., None] * across


def combine_bent_bands(
    space: ScaleSpace,
    light: NDArray[np.float64],
    weights: NDArray[np.float64],
    exaggeration: NDArray[np.float64],
    singular: float,
    strength: float,
    remoteness: NDArray[np.float32] | None = None,
) -> NDArray[np.float32]:
    """Return what `exaggerated_kernel.combine_bands` does, every band under its own eq. 9.

    Computes the curvature of every scale but the last, once.
    """
    count = space.count
    single = light.astype(np.float32)
    base = cosines(space.normals_at(space.last), single)
    sums = (weights[-1].astype(np.float32) * base).astype(np.float32)
    pieces = spans(count, thread_count() if count > 20_000 else 1)
    for scale in range(len(space.widths) - 1):
        width = float(space.widths[scale]) or space.finest_width
        found = space.curvature(scale)
        # Per width, so that neither tiny nor huge units overflow a square.
        k1, k2 = found.k1 * width, found.k2 * width
        bend = np.minimum(strength * (k1 - k2) * (k1 + k2), _MOST).astype(np.float32)
        share = np.full(count, weights[scale], np.float32)
        if remoteness is not None:
            share *= np.exp(-remoteness / np.float32(2**scale))
        arguments = (
            space.planes_at(scale), space.planes_at(scale + 1), found.d1, bend, share, single,
            np.float32(exaggeration[scale]), np.float32(singular**2), sums,
        )  # fmt: skip
        each(lambda a, b, given=arguments: _add_band(*given, a, b), pieces)
    return sums


@kernel()
def _add_band(fine, coarse, d1, bend, share, light, exaggeration, singular, sums, begin, end):  # type: ignore[no-untyped-def]
    one, upright = np.float32(1), np.float32(_UPRIGHT)
    lx, ly, lz = light[0], light[1], light[2]
    for i in range(begin, end):
        nx, ny, nz = coarse[0, i], coarse[1, i], coarse[2, i]
        cosine = nx * lx + ny * ly + nz * lz
        px, py, pz = lx - nx * cosine, ly - ny * cosine, lz - nz * cosine
        dx, dy, dz = d1[i, 0], d1[i, 1], d1[i, 2]
        cosine = nx * dx + ny * dy + nz * dz
        dx, dy, dz = dx - nx * cosine, dy - ny * cosine, dz - nz * cosine
        squared = dx * dx + dy * dy + dz * dz
        if squared >= upright * upright:
            nudge = bend[i] * (px * dx + py * dy + pz * dz) / squared
            px, py, pz = px + nudge * dx, py + nudge * dy, pz + nudge * dz
        length = math.sqrt(px * px + py * py + pz * pz + singular)
        detail = exaggeration * (fine[0, i] * px + fine[1, i] * py + fine[2, i] * pz) / length
        sums[i] += share[i] * max(-one, min(one, detail))
