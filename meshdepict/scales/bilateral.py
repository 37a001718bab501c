"""Bilateral smoothing of a picture's normals, with a range kernel on depth.

Local Light Alignment (Mestres et al. 2021, §4) smooths the normals of a G-buffer again and again,
with wider and wider kernels; the range kernel keeps silhouettes. Here a step's two kernels are
one Gaussian of the distance in space, as wide in depth as across, all in pixels: a surface in the
picture's plane, a steep one and two that hide each other get about what the Gaussian sum over a
mesh would give them. So neither the unit of depth nor the distance of the eye matters.

Two shortcuts, with what they turn normals by at the widest of the paper's five scales, on an
armadillo 300 pixels high: kernels end at 3σ (median 0.2°, 90 % below 0.7°), and what has been
smoothed to a width w is looked at every w/2 pixels only (median 0.06°, 90 % below 0.5°). Single
pixels at silhouettes, where a row of taps is on the surface or off it, turn by up to 30°.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.shapes.gbuffer import GBuffer

__all__ = ["bilateral_step", "bilateral_steps", "bilateral_taps", "tap_counts"]

Singles = NDArray[np.float32]

_CUT = 3.0  # a kernel's radius in standard deviations
# Normals that vary over σ are sampled every σ/2 without loss: some 200 taps, 600 at most, serve
# any width.
_SAMPLED = 0.5
_FIRST, _RUNG = 4.0, 2.5  # widest first step, in pixels, and largest ratio of later ones
_NO_RESULTANT = 1e-6  # as on meshes: below it the finer normal is kept


def bilateral_steps(
    gbuffer: GBuffer, widths: NDArray[np.float64], *, depth_range: float = 1.0
) -> Callable[[int, Singles], Singles]:
    """Return what makes a scale's normals (3, n) of those of the one before.

    Parameters
    ----------
    gbuffer : GBuffer
    widths : (scales + 1,) array
        In pixels, the first one 0. A step's kernel is what is missing from the finer width; a wide
        gap is climbed by rungs between, so that every step can do with few taps.
    depth_range : float
        See `bilateral_step`.
    """
    depth = gbuffer.cropped(gbuffer.depth_steps.astype(np.float32))

    def step(scale: int, before: Singles) -> Singles:
        normals, finer = gbuffer.cropped(before), float(widths[scale - 1])
        for rung in _rungs(finer, float(widths[scale])):
            missing = math.sqrt(rung**2 - finer**2)
            normals = bilateral_step(normals, depth, missing, smooth=finer, depth_range=depth_range)
            finer = rung
        return gbuffer.uncropped(normals)

    return step


def tap_counts(widths: NDArray[np.float64], *, within: int) -> list[int]:
    """Return how many taps make each scale of the one before; see `bilateral_steps`."""
    counts = []
    for finer, width in itertools.pairwise(map(float, widths)):
        count = 0
        for rung in _rungs(finer, width):
            missing = math.sqrt(rung**2 - finer**2)
            count += len(bilateral_taps(missing, smooth=finer, within=within)[1])
            finer = rung
        counts.append(count)
    return counts


def _rungs(finer: float, width: float) -> list[float]:
    """Return widths on the way from one to a wider one, the last of them that."""
    begin = max(finer, _FIRST)
    count = max(1, math.ceil(math.log(width / begin) / math.log(_RUNG))) if width > begin else 1
    return [width * (begin / width) ** (1 - (i + 1) / count) for i in range(count)]


def bilateral_taps(
    width: float, *, smooth: float = 0.0, within: int = 10_000
) -> tuple[NDArray[np.intp], Singles]:
    """Return offsets (t, 2), row and column, and weights (t,) of a Gaussian in the picture.

    Parameters
    ----------
    width : float
        Standard deviation in pixels. The taps have this variance, though they end at 3σ.
    smooth : float
        Width at which the picture has been smoothed already: the wider, the fewer taps are needed.
    within : int
        Rows and columns that can matter, less than this apart.
    """
    stride = max(1, math.floor(smooth * _SAMPLED))
    reach = math.ceil(_CUT * width / stride)
    seen = min(reach, (within - 1) // stride)
    steps = stride * np.arange(-seen, seen + 1)
    rows, columns = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
    squared = (rows**2 + columns**2).astype(float)
    inside = squared <= (_CUT * width) ** 2
    rows, columns, squared = rows[inside], columns[inside], squared[inside]
    weights = np.exp(-squared / (2 * width**2))
    if seen == reach:  # nothing is missing but what the cut takes away: make up for that
        sigma = width
        for _ in range(20):
            found = float((weights * squared).sum() / (2 * weights.sum()))
            sigma *= min(1.5, width / math.sqrt(found)) if found > 0 else 1.0
            weights = np.exp(-squared / (2 * sigma**2))
    return np.stack([rows, columns], axis=1), weights.astype(np.float32)


def bilateral_step(
    normals: Singles,
    depth: Singles,
    width: float,
    *,
    smooth: float = 0.0,
    depth_range: float = 1.0,
) -> Singles:
    """Return normals smoothed by a Gaussian across the picture and in depth.

    ``Σ_q exp(−‖p − q‖²/2σ²) R(z_p − z_q) n_q``, normalised, with the range kernel
    R(r) = (1 − r²/16ρ²)⁸, ρ = depth_range·σ: within 0.04 of the Gaussian exp(−r²/2ρ²), and zero
    from 4ρ on.

    Parameters
    ----------
    normals : (3, h, w) array of float32
        Zero where there is no surface, and there the result is.
    depth : (h, w) array of float32
        In pixels.
    width : float
        σ in pixels.
    smooth : float
        Width in pixels at which these normals have been smoothed already.
    depth_range : float
        How much wider than across the kernel is in depth; infinite: depth doesn't matter.
    """
    offsets, weights = bilateral_taps(width, smooth=smooth, within=max(depth.shape))
    found = np.zeros_like(normals)
    reach = min(max(depth_range * width, 1e-15), 1e15)  # as good as none, and as any
    steep = np.float32(1 / (16 * reach**2))
    height = normals.shape[1]
    each(
        lambda a, b: _rows(normals, depth, offsets, weights, steep, a, b, found),
        spans(height, 4 * thread_count()),
    )
    length = np.sqrt(np.einsum("ayx,ayx->yx", found, found))
    firm = (length > _NO_RESULTANT) & normals.any(axis=0)
    return np.where(firm, found / np.where(firm, length, 1), normals)


@kernel("contracted")
def _rows(normals, depth, offsets, weights, steep, first, last, found):  # type: ignore[no-untyped-def]
    one = np.float32(1)
    height, width = depth.shape
    for row in range(first, last):
        for t in range(len(offsets)):
            there = row + offsets[t, 0]
            if there < 0 or there >= height:
                continue
            shift = offsets[t, 1]
            begin, end = max(0, -shift), min(width, width - shift)
            if end <= begin:
                continue
            zp, zq = depth[row, begin:end], depth[there, begin + shift : end + shift]
            xq = normals[0, there, begin + shift : end + shift]
            yq = normals[1, there, begin + shift : end + shift]
            nq = normals[2, there, begin + shift : end + shift]
            x, y, z = found[0, row, begin:end], found[1, row, begin:end], found[2, row, begin:end]
            weight = weights[t]
            # The innermost loop runs over pixels: contiguous, so that it is vectorised.
            for i in range(end - begin):
                r = zp[i] - zq[i]
                share = max(one - steep * r * r, np.float32(0))
                share *= share
                share *= share
                share *= weight * share
                x[i] += share * xq[i]
                y[i] += share * yq[i]
                z[i] += share * nq[i]
