"""Texture of heights: their fractional Laplacian (Brown 2010), which shows ridges of every size."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import thread_count

__all__ = ["filled", "texture"]

Singles = NDArray[np.float32]


def texture(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    spacing: tuple[float, float],
    *,
    detail: float = 0.8,
) -> Singles:
    """Return |ω|^α of heights by a cosine transform, whose edges mirror.

    It is linear, keeps the mean at zero, and a wave of any direction at its place: a wave of the
    angular frequency ω becomes |ω|^α as high. α = 0 leaves the heights, without their mean; α = 2
    is the Laplacian with its sign turned.

    Parameters
    ----------
    z : (rows, cols) array of float32 or float64
        Heights.
    valid : (rows, cols) array of bool, optional
        Which cells hold one; what lies between is filled smoothly for the transform alone.
    spacing : (float, float)
        Along columns and rows, in the units of heights.
    detail : float
        α.

    Returns
    -------
    (rows, cols) array of float32
        In units^(1−α); ridges positive; 0 where not valid.
    """
    from scipy.fft import dctn, idctn

    ground = filled(z, valid)
    waves = dctn(ground, type=2, norm="ortho", workers=thread_count(), overwrite_x=True)
    across, down = (
        (np.pi * np.arange(count) / (count * step)) ** 2
        for count, step in zip(z.shape[::-1], spacing, strict=True)
    )
    for begin in range(0, len(waves), 256):  # else frequencies take as much memory as heights
        part = slice(begin, begin + 256)
        waves[part] *= (down[part, None] + across) ** (detail / 2)
    waves[0, 0] = 0
    found = idctn(waves, type=2, norm="ortho", workers=thread_count(), overwrite_x=True)
    if valid is not None:
        found[~valid] = 0
    return np.asarray(found, np.float32)


def filled(z: NDArray[Any], valid: NDArray[np.bool_] | None) -> Singles:
    """Return heights from their middle, and between them what the land around suggests.

    Holes are filled from averages over squares twice, four times … as wide, each interpolated: no
    step arises where they begin, and heights themselves stay as they are.
    """
    known = z if valid is None else z[valid]
    middle = (float(known.min()) + float(known.max())) / 2 if known.size else 0.0
    ground = (z - z.dtype.type(middle)).astype(np.float32)
    if valid is None or valid.all():
        return ground
    return _pulled(np.where(valid, ground, np.float32(0)), valid.astype(np.float32))


def _pulled(sums: NDArray[Any], mass: NDArray[Any]) -> Singles:
    """Return sums/mass, and where there is no mass what a raster half as fine has."""
    mean = np.asarray(sums / np.where(mass > 0, mass, 1), np.float32)
    if (mass > 0).all() or mass.size == 1:
        return mean
    coarse = _pulled(_halved(sums), _halved(mass))
    rows, cols = mass.shape
    smooth = _doubled(_doubled(coarse, rows).T, cols).T
    # A cell of which a part is known is that much as it is.
    share = np.minimum(mass, 1)
    return np.asarray(share * mean + (1 - share) * smooth, np.float32)


def _halved(image: NDArray[Any]) -> NDArray[Any]:
    """Return sums over squares of two by two cells, or what is there of them."""
    for _ in range(2):
        if len(image) % 2:
            image = np.concatenate([image, np.zeros_like(image[:1])])
        image = (image[::2] + image[1::2]).T
    return image


def _doubled(image: Singles, count: int) -> Singles:
    """Return rows interpolated at twice as many places, the first `count` of them."""
    before, after = (image[np.clip(np.arange(len(image)) + k, 0, len(image) - 1)] for k in (-1, 1))
    out = np.empty((2 * len(image), image.shape[1]), np.float32)
    out[::2], out[1::2] = 0.75 * image + 0.25 * before, 0.75 * image + 0.25 * after
    return out[:count]
