"""Colour: the sRGB curve, 256 levels, colour maps, and the surface's own colours under shading.

*Linear* values are proportional to light, *display* values are what a file or a screen stores.
Shading functions return one or the other in [0, 1] (`shading` says which); this module is the only
place where the one becomes the other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.colormaps import table_of
from meshdepict.color.srgb import quantise, srgb_levels, srgb_to_linear
from meshdepict.errors import MeshdepictError

__all__ = [
    "apply_colormap",
    "encode",
    "multiply_albedo",
]

Floats = NDArray[np.floating[Any]]
Bytes = NDArray[np.uint8]


def apply_colormap(intensity: ArrayLike, name: str) -> Bytes:
    """Return the colours (n, 3) that a `colormap` has for display values (n,) in [0, 1].

    Raises
    ------
    MeshdepictError
        For an unknown name, or an intensity of another shape.
    """
    return encode(intensity, linear=False, colormap=name)


def encode(values: ArrayLike, *, linear: bool, colormap: str | None = None) -> Bytes:
    """Return shading as the colours that a file stores.

    Parameters
    ----------
    values : (n,) or (n, 3) array_like of float
        Shading in [0, 1], gray or RGB; clipped.
    linear : bool
        Whether the values are linear, to be sRGB-encoded first, or display values as they are.
    colormap : str, optional
        Name of a `colormap` for gray values.

    Returns
    -------
    (n, 3) array of uint8

    Raises
    ------
    MeshdepictError
        For another shape, an unknown colour map, or a colour map for RGB values.
    """
    values = _shading(values)
    if colormap is not None and values.ndim == 2:
        raise MeshdepictError(
            f"the colour map {colormap!r} needs one value per point, but this shading is in colour "
            "already; leave the colour map out"
        )
    levels = srgb_levels(values) if linear else quantise(values)
    if values.ndim == 2:
        return levels
    if colormap is None:
        return np.repeat(levels[:, None], 3, axis=1)
    return np.take(table_of(colormap), levels, axis=0)


def multiply_albedo(values: ArrayLike, albedo: ArrayLike, *, linear: bool) -> Bytes:
    """Return the surface's own colours under the shading, multiplied in linear light.

    Parameters
    ----------
    values : (n,) or (n, 3) array_like of float
        Shading in [0, 1]; 1 leaves a colour as it is, 0 gives black.
    albedo : (n, 3) array_like
        sRGB colours: unsigned integers over their full range, or floats in [0, 1].
    linear : bool
        Whether `values` are linear or display values, as in `encode`.

    Returns
    -------
    (n, 3) array of uint8

    Raises
    ------
    MeshdepictError
        For another shape, or colours of another type or range.
    """
    values = _shading(values)
    albedo = np.asarray(albedo)
    if albedo.shape != (len(values), 3):
        raise MeshdepictError(
            f"expected one RGB colour for each of {len(values):,} points, got colours of shape "
            f"{albedo.shape}"
        )
    light = values if linear else srgb_to_linear(values)
    light = np.asarray(light if light.ndim == 2 else light[:, None], np.float32)
    return srgb_levels(light * _linear_albedo(albedo))


def _linear_albedo(albedo: NDArray[Any]) -> Floats:
    if albedo.dtype == np.uint8:
        return np.take(srgb_to_linear(np.arange(256, dtype=np.float32) / 255), albedo)
    if np.issubdtype(albedo.dtype, np.unsignedinteger):
        return srgb_to_linear(albedo / np.float32(np.iinfo(albedo.dtype).max))
    within = np.issubdtype(albedo.dtype, np.floating) and ((albedo >= 0) & (albedo <= 1)).all()
    if not within:  # NaN is not within either
        raise MeshdepictError(
            "colours must be unsigned integers over their full range or floats in 0 … 1, "
            f"not {albedo.dtype} beyond that"
        )
    return srgb_to_linear(albedo.astype(np.float32))


def _shading(values: ArrayLike) -> Floats:
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):
        array = np.empty(0, object)
    if array.dtype.kind not in "biuf":
        raise MeshdepictError("shading must be numbers of shape (n,) or (n, 3)")
    if array.ndim not in (1, 2) or (array.ndim == 2 and array.shape[1] != 3):
        raise MeshdepictError(f"shading must have shape (n,) or (n, 3), not {array.shape}")
    return array
