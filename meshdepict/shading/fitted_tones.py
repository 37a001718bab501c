"""Exaggeration, base coat and contrast of Exaggerated Shading that follow the shape (METHODS §2).

A smooth find needs steeper toons than fur, and where the wide bands disagree with the light, more
base coat. All three follow from the normals alone: neither a light nor a view enters, so that a
turned light or object changes nothing but the light, and a bake, a window and a movie agree.
"""

from __future__ import annotations

import math
import weakref
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.bands import SINGULAR_LIGHT, band_weights

__all__ = [
    "BROAD_CONFORMITY",
    "CONFORMITY",
    "CONFORMITY_OF_PLANES",
    "SAMPLES",
    "SATURATED",
    "STEEPEST",
    "FittedTones",
    "broad_bands",
    "fitted_tones",
    "flatness",
    "relief_tones",
    "tone_moments",
]

SATURATED = 0.3
"""Share of the samples that a band may turn black or white, over all directions of the light."""

RELIEF_SATURATED = 0.08
"""The same of terrain under one light, whose scales all show the slope that they have in common."""

RELIEF_STEEPEST = 1000.0
"""Exaggeration at most on terrain: a plain rises by a thousandth, and its gradient is exact."""

STEEPEST = 40.0
"""Exaggeration at most, within the paper's 25 to 50: normals off by 1e-4 show as a grey level."""

CONFORMITY = 0.89
"""Least correlation with half-Lambert, over all samples and lights that they face or not.

Chosen so that in pictures, where only lights in front of the object count, broad tones correlate by
0.6 and more on nine scans, with four fifths of the local contrast that one exaggeration of 15 had.
"""

CONFORMITY_OF_PLANES = 0.963
"""The same on shapes of planes, each of which has one tone: nothing there outweighs its haloes."""

BROAD_CONFORMITY = 0.975
"""The same of the broad tone alone: bands wider than a twentieth of the diagonal, and base coat.

Meshes of few vertices have many such bands, none of which shows as detail.
"""

_BROAD = 0.05  # widths beyond which a band is part of the broad tone, in diagonals
# A plane is flat at the finest scale; a smooth surface bends with the square of the width, at the
# coarsest of nine scales 256 times as much.
_FLAT = 500
_BENT = 0.1  # sine that is a bend; less is no halo
_SHARES = 0.05, 0.2  # of samples on planes: no shape of planes, and one; scans have 0.003
_BASES = np.geomspace(8.0, 64.0, 61)  # times the paper's base coat; below 8 planes stay mid-grey
_CLIPPED, _CLIPPED_PLANES = 0.01, 0.05  # share of samples that contrast may take to black and white
_MOST_CONTRAST = 2.0
SAMPLES = 8_000
"""How many samples are looked at, spread evenly over all."""
_AZIMUTHS, _HEIGHTS = 8, 2  # lights round every sample; those from below give the negative

Single = NDArray[np.float32]


class FittedTones(NamedTuple):
    """What follows from a shape: a per scale, finest first; the factor of the base coat; Σ k."""

    exaggeration: tuple[float, ...]
    base: float
    contrast: float


_KEPT: weakref.WeakKeyDictionary[ScaleSpace, dict[float, FittedTones]] = weakref.WeakKeyDictionary()


def fitted_tones(space: ScaleSpace, *, emphasis: float) -> FittedTones:
    """Return the numbers that fit a scale space; computed once for each emphasis."""
    kept = _KEPT.setdefault(space, {})
    if emphasis not in kept:
        kept[emphasis] = _fit(space, emphasis)
    return kept[emphasis]


def relief_tones(space: ScaleSpace, *, emphasis: float) -> FittedTones:
    """Return the numbers that fit terrain under one horizontal light; see `exaggerated`.

    Each scale saturates `RELIEF_SATURATED` of the samples over all azimuths of the light; the base
    is the paper's, and contrast is as for `fitted_tones`.
    """
    normals = _some(space.typical())
    up = space.vertical.astype(np.float32)
    level = [each - up * (each @ up)[:, None] for each in normals]
    sines = [np.linalg.norm(each.astype(np.float64), axis=1) for each in level]
    steep = tuple(_rounded(_steepness(each, RELIEF_SATURATED, RELIEF_STEEPEST)) for each in sines)
    if not normals.shape[1]:
        return FittedTones(steep, 1.0, 1.0)
    weights = band_weights(space.widths, space.ratio, emphasis=emphasis, contrast=1.0)
    across = np.linalg.svd(up[None])[2][1:].astype(np.float32)  # two axes on the ground
    turns = np.arange(_AZIMUTHS // 2) * (2 * math.pi / _AZIMUTHS)  # the others give the negative
    lights = np.stack([np.cos(turns), np.sin(turns)], axis=1).astype(np.float32) @ across
    sums = sum(
        k * np.clip(np.float32(a) * (each @ lights.T), -1, 1)
        for k, a, each in zip(weights, steep, level, strict=True)
    )
    high = float(np.quantile(np.abs(sums), 1 - _CLIPPED))
    return FittedTones(steep, 1.0, _rounded(min(max(1 / max(high, 1e-9), 1.0), _MOST_CONTRAST)))


def _fit(space: ScaleSpace, emphasis: float) -> FittedTones:
    normals = _some(space.typical())
    steep = tuple(_rounded(_steepness(_sines(fine, coarse))) for fine, coarse in pairwise(normals))
    weights = band_weights(space.widths, space.ratio, emphasis=emphasis, contrast=1.0)
    if not normals.shape[1]:
        return FittedTones(steep, float(_BASES[0]), 1.0)
    flat = flatness(normals)
    detail, coat, lambert = tone_moments(normals, steep, weights)
    least = _base(detail, coat, lambert, CONFORMITY + flat * (CONFORMITY_OF_PLANES - CONFORMITY))
    broad = broad_bands(space)
    if broad.start < len(steep):
        moments = tone_moments(normals[broad], steep[broad], weights[broad])
        least = max(least, _base(*moments, BROAD_CONFORMITY))
    base = _rounded(least)
    sums = np.abs(detail + np.float32(base) * coat) / (weights[:-1].sum() + base * weights[-1])
    high = float(np.quantile(sums, 1 - _CLIPPED - flat * (_CLIPPED_PLANES - _CLIPPED)))
    return FittedTones(steep, base, _rounded(min(max(1 / max(high, 1e-9), 1.0), _MOST_CONTRAST)))


def _rounded(number: float) -> float:
    """Return a number with the digits that a recipe shows."""
    return float(f"{number:.4g}")


def _some(space: ScaleSpace) -> Single:
    """Return normals (scales + 1, k, 3) of samples that stand for all."""
    step = max(1, math.ceil(space.count / SAMPLES))
    return np.ascontiguousarray(space.normals[:, ::step])


def _sines(fine: Single, coarse: Single) -> NDArray[np.float64]:
    """Return the sines of the angles between normals of two scales: (k,)."""
    across = np.cross(fine.astype(np.float64), coarse.astype(np.float64))
    found: NDArray[np.float64] = np.linalg.norm(across, axis=1)
    return found


def _steepness(
    sines: NDArray[np.float64], saturated: float = SATURATED, steepest: float = STEEPEST
) -> float:
    """Return the exaggeration that saturates a share of the samples.

    The light lies in the plane of the coarser normal at an azimuth φ from the finer one's: a sample
    of the sine s is saturated where a·s·|cos φ| ≥ 1, in (2/π) acos(1/(a s)) of all azimuths.
    """

    def share(steep: float) -> float:
        least = 1 / np.maximum(steep * sines, 1)
        return float(np.mean(np.arccos(least))) * 2 / math.pi if len(sines) else 0.0

    if share(steepest) <= saturated:
        return steepest
    low, high = 0.0, math.log(steepest)  # 1 saturates nothing: sines are at most 1
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if share(math.exp(middle)) < saturated else (low, middle)
    return math.exp(low)


def tone_moments(
    normals: Single, exaggeration: tuple[float, ...], weights: NDArray[np.float64]
) -> tuple[Single, Single, Single]:
    """Return detail, base coat and Lambert's cosine of every sample under lights round it.

    Parameters
    ----------
    normals : (scales + 1, k, 3) array
    exaggeration : sequence of float
        Per scale, finest first.
    weights : (scales + 1,) array
        k_i for a base of 1.

    Returns
    -------
    three (lights, k) arrays
        Σ k_i clamp(a_i n_i·l̂_{i+1}); k_b n_b·l; n_0·l. The lights stand round the coarsest normal,
        azimuths counted from the finest one, so that turning the shape turns them along. Only its
        upper half: the opposite light gives the negative of all three.
    """
    top = normals[-1]
    along = normals[0] - top * _dot(normals[0], top)[:, None]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    axis = np.eye(3, dtype=np.float32)[np.argmin(np.abs(top), axis=1)]
    other = np.cross(top, axis)
    along = np.where(length > 1e-5, along, other)
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
    across = np.cross(top, along)
    lights = _AZIMUTHS * _HEIGHTS
    detail, coat, lambert = np.zeros((3, lights, normals.shape[1]), np.float32)
    k = weights.astype(np.float32)
    for number in range(lights):
        height = (number // _AZIMUTHS + 0.5) / _HEIGHTS  # even steps: even by solid angle
        turn = 2 * math.pi * (number % _AZIMUTHS + 0.5) / _AZIMUTHS
        reach = math.sqrt(1 - height**2)
        light = np.float32(height) * top + np.float32(reach * math.cos(turn)) * along
        light = light + np.float32(reach * math.sin(turn)) * across
        for i, steep in enumerate(exaggeration):
            local = light - normals[i + 1] * _dot(light, normals[i + 1])[:, None]
            length = np.sqrt(_dot(local, local) + np.float32(SINGULAR_LIGHT**2))
            cosine = _dot(normals[i], local) / length
            detail[number] += k[i] * np.clip(np.float32(steep) * cosine, -1, 1)
        coat[number] = k[-1] * _dot(top, light)
        lambert[number] = _dot(normals[0], light)
    return detail, coat, lambert


def broad_bands(space: ScaleSpace) -> slice:
    """Return the scales from the first that is wider than a twentieth of the diagonal."""
    wide = space.widths > _BROAD * space.shape.diagonal
    return slice(int(np.argmax(wide)) if wide.any() else len(wide), None)


def flatness(normals: Single) -> float:
    """Return from 0 to 1 how far a shape, given by the normals of its scales, is one of planes.

    A sample lies on a plane if it doesn't bend at the finest scale, but does at the coarsest, into
    which what is beyond the plane's edge enters.
    """
    bends = _sines(normals[0], normals[-1])
    plane = (bends > _BENT) & (_FLAT * _sines(normals[0], normals[1]) < bends)
    return float(np.interp(np.mean(plane), _SHARES, (0, 1)))


def _base(detail: Single, coat: Single, lambert: Single, conformity: float) -> float:
    """Return the least base coat whose result correlates with Lambert by so much."""

    def mean(a: Single, b: Single) -> float:
        return float(np.mean(a * b, dtype=np.float64))

    variance = mean(detail, detail) + 2 * _BASES * mean(detail, coat) + _BASES**2 * mean(coat, coat)
    shared = mean(detail, lambert) + _BASES * mean(coat, lambert)
    found = shared / np.sqrt(np.maximum(variance * mean(lambert, lambert), 1e-30))
    if found[0] >= conformity:
        return float(_BASES[0])
    if found.max() < conformity:
        return float(_BASES[np.argmax(found)])
    after = int(np.argmax(found >= conformity))  # the first; between it and the one before
    share = (conformity - found[after - 1]) / (found[after] - found[after - 1])
    return float(_BASES[after - 1] + share * (_BASES[after] - _BASES[after - 1]))


def _dot(a: Any, b: Any) -> Single:
    found: Single = np.einsum("ni,ni->n", a, b)
    return found
