"""The sum of Exaggerated Shading's bands, compiled: a new light in about a millisecond."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["combine_bands", "combine_cosines"]

_BLOCK = 512  # samples whose running sums stay in the fastest cache
_MANY = 2_000_000  # normals: of fewer, threads take as long to begin as one takes for all


def combine_bands(
    space: ScaleSpace,
    light: NDArray[np.float64],
    weights: NDArray[np.float64],
    exaggeration: NDArray[np.float64],
    singular: float,
    remoteness: NDArray[np.float32] | None = None,
) -> NDArray[np.float32]:
    """Return k_b n_b·l + Σ_i k_i clamp(a_i n_i·l̂_{i+1}), not yet clipped.

    Where a `remoteness` (n,) is given, each k_i fades by exp(−remoteness / 2^i).

    Single precision, like the normals. The projected light is formed as a vector, for
    ‖l_{i+1}‖² = 1 − (n_{i+1}·l)² would lose its digits where the light stands along a normal.
    """
    count = space.count
    sums = np.empty(count, np.float32)
    arguments = (
        space.planes, light.astype(np.float32), weights.astype(np.float32),
        exaggeration.astype(np.float32), np.float32(singular**2),
        np.empty(0, np.float32) if remoteness is None else remoteness, sums,
    )  # fmt: skip
    pieces = thread_count() if count * len(space.planes) > _MANY else 1
    each(lambda a, b: _combine(*arguments, a, b), spans(count, pieces))
    return sums


@kernel("contracted")
def _combine(planes, light, weights, exaggeration, singular, remoteness, sums, begin, end):  # type: ignore[no-untyped-def]
    last = len(planes) - 1
    lx, ly, lz = light[0], light[1], light[2]
    one = np.float32(1)
    along, total = np.empty(_BLOCK, np.float32), np.empty(_BLOCK, np.float32)
    share = np.ones(_BLOCK, np.float32)
    for start in range(begin, end, _BLOCK):
        count = min(_BLOCK, end - start)
        total[:] = np.float32(0)
        for scale in range(last):
            k, steep = weights[scale], exaggeration[scale]
            fine, coarse = planes[scale], planes[scale + 1]
            fx, fy, fz = fine[0, start:], fine[1, start:], fine[2, start:]
            nx, ny, nz = coarse[0, start:], coarse[1, start:], coarse[2, start:]
            if len(remoteness) > 0:
                for i in range(count):
                    share[i] = math.exp(-remoteness[start + i] / np.float32(2**scale))
            for i in range(count):
                cosine = nx[i] * lx + ny[i] * ly + nz[i] * lz
                px, py, pz = lx - nx[i] * cosine, ly - ny[i] * cosine, lz - nz[i] * cosine
                length = math.sqrt(px * px + py * py + pz * pz + singular)
                detail = steep * (fx[i] * px + fy[i] * py + fz[i] * pz) / length
                total[i] += k * share[i] * max(-one, min(one, detail))
                along[i] = cosine
        for i in range(count):
            sums[start + i] = total[i] + weights[last] * along[i]


def combine_cosines(
    space: ScaleSpace,
    light: NDArray[np.float64],
    weights: NDArray[np.float64],
    exaggeration: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Return Σ_i k_i clamp(a_i n_i·l) over all scales, 0 to the coarsest, not yet clipped."""
    count = space.count
    sums = np.empty(count, np.float32)
    arguments = (
        space.planes, light.astype(np.float32), weights.astype(np.float32),
        exaggeration.astype(np.float32), sums,
    )  # fmt: skip
    pieces = thread_count() if count * len(space.planes) > _MANY else 1
    each(lambda a, b: _cosines(*arguments, a, b), spans(count, pieces))
    return sums


@kernel("contracted")
def _cosines(planes, light, weights, exaggeration, sums, begin, end):  # type: ignore[no-untyped-def]
    lx, ly, lz = light[0], light[1], light[2]
    one = np.float32(1)
    for start in range(begin, end, _BLOCK):
        count = min(_BLOCK, end - start)
        total = sums[start : start + count]
        total[:] = np.float32(0)
        for scale in range(len(planes)):
            k, steep = weights[scale], exaggeration[scale]
            x, y, z = planes[scale, 0, start:], planes[scale, 1, start:], planes[scale, 2, start:]
            for i in range(count):
                cosine = steep * (x[i] * lx + y[i] * ly + z[i] * lz)
                total[i] += k * max(-one, min(one, cosine))
