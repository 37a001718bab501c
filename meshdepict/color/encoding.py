"""Colour: the sRGB curve, 256 levels, colour maps, and the surface's own colours under shading.

*Linear* values are proportional to light, *display* values are what a file or a screen stores.
Shading functions return one or the other in [0, 1] (`shading` says which); this module is the only
place where the one becomes the other.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest

__all__ = [
    "apply_colormap",
    "colormap",
    "encode",
    "linear_to_srgb",
    "multiply_albedo",
    "quantise",
    "srgb_to_linear",
]

Floats = NDArray[np.floating[Any]]
Bytes = NDArray[np.uint8]

# Where the two branches of the curve meet. IEC 61966-2-1 rounds it to 0.0031308, which leaves a
# step of 3e-8 downwards; with all digits the curve is continuous and its inverse exact.
_KNEE = 0.0031306684425005883
_SLOPE = 12.92

# Colours from dark to light (0 … 255), placed by their lightness so that equal steps look equal.
BUILT_IN = {
    "gray": ((0, 0, 0), (255, 255, 255)),
    "sepia": ((24, 15, 8), (88, 56, 32), (150, 109, 72), (206, 174, 134), (252, 243, 226)),
    "stone": ((22, 23, 28), (84, 83, 86), (142, 136, 130), (199, 190, 178), (252, 249, 243)),
    "gooch": ((10, 16, 84), (48, 70, 138), (118, 128, 140), (196, 182, 108), (255, 243, 140)),
}

# Import name, the prefix under which the package enters its maps in matplotlib, where it has them.
_PACKAGES = (
    ("matplotlib", "mpl.", "colormaps"),
    ("cmcrameri.cm", "cmc.", "cmaps"),
    ("colorcet", "cet_", "palette"),
    ("cmocean.cm", "cmo.", "cmap_d"),
)


def srgb_to_linear(x: ArrayLike) -> Floats:
    """Return the linear value of display values in [0, 1] (IEC 61966-2-1); others are clipped.

    float32 stays float32, everything else becomes float64. NaN becomes 0.
    """
    x = _unit(x)
    return np.where(x <= _SLOPE * _KNEE, x / _SLOPE, ((x + 0.055) / 1.055) ** 2.4).astype(x.dtype)


def linear_to_srgb(x: ArrayLike) -> Floats:
    """Return the display value of linear values in [0, 1] (IEC 61966-2-1); others are clipped.

    float32 stays float32, everything else becomes float64. NaN becomes 0.
    """
    x = _unit(x)
    root = x ** (1 / 2.4)
    steep = root + 0.055 * (root - 1)  # 1.055 root − 0.055, but exactly 1 at 1
    return np.where(x <= _KNEE, x * _SLOPE, steep).astype(x.dtype)


def quantise(x: ArrayLike) -> Bytes:
    """Return the nearest of 256 levels for values in [0, 1]: 0 → 0, 1 → 255, halves upwards.

    Values outside are clipped; NaN becomes 0.
    """
    x = _unit(x)
    return (x * x.dtype.type(255) + x.dtype.type(0.5)).astype(np.uint8)


def colormap(name: str) -> Bytes:
    """Return a colour map as a table of 256 display colours, first for 0, last for 1.

    Parameters
    ----------
    name : str
        "gray" (the values as they are), "sepia", "stone", "gooch" (dark blue to bright yellow, as
        in ES fig. 1); or a map of matplotlib, cmcrameri, colorcet or cmocean where installed,
        with or without the prefix that they use in matplotlib ("cmc.batlow", "batlow"). With
        "_r" behind it, the other way round.

    Returns
    -------
    (256, 3) array of uint8, read-only

    Raises
    ------
    MeshdepictError
        For an unknown name; the sentence has the nearest known one.
    """
    return _table(name)


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
    levels = _srgb_levels(values) if linear else quantise(values)
    if values.ndim == 2:
        return levels
    if colormap is None:
        return np.repeat(levels[:, None], 3, axis=1)
    return np.take(_table(colormap), levels, axis=0)


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
    return _srgb_levels(light * _linear_albedo(albedo))


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
    values = np.asarray(values)
    if values.ndim not in (1, 2) or (values.ndim == 2 and values.shape[1] != 3):
        raise MeshdepictError(f"shading must have shape (n,) or (n, 3), not {values.shape}")
    return values


def _unit(x: ArrayLike) -> Floats:
    """Clip to [0, 1] as floats; NaN becomes 0."""
    x = np.asarray(x)
    x = x if x.dtype == np.float32 else x.astype(np.float64)
    return np.minimum(np.fmax(x, x.dtype.type(0)), x.dtype.type(1))


# --- linear values to levels, by table ------------------------------------------------------

# Two levels are at least 1/(255 · 12.92) apart, so a bin of 1/4096 holds at most one threshold
# between levels: the level at the bin's start is right, or one too low.
_BINS = 4096


@cache
def _thresholds() -> tuple[Bytes, Floats]:
    """Return the level at the start of each bin, and the linear value where each level begins."""
    begins = np.append(srgb_to_linear((np.arange(256) - 0.5) / 255), np.inf)
    begins[0] = -np.inf
    starts = np.searchsorted(begins, np.arange(_BINS + 1) / _BINS, side="right") - 1
    return starts.astype(np.uint8), begins


def _srgb_levels(x: Floats) -> Bytes:
    """``quantise(linear_to_srgb(x))``, several times faster."""
    x = _unit(x)
    starts, begins = _thresholds()
    levels = np.take(starts, (x * _BINS).astype(np.int32))
    next_begins = np.take(begins[1:].astype(x.dtype), levels)
    levels += x >= next_begins
    return levels


# --- tables of colours ----------------------------------------------------------------------


@cache
def _table(name: str) -> Bytes:
    forward = name.removesuffix("_r")
    if forward in BUILT_IN:
        table = _between(np.array(BUILT_IN[forward]) / 255)
    else:
        table = _sampled(_installed_map(forward))
    table = table if forward == name else table[::-1]
    table.setflags(write=False)
    return table


def _between(anchors: Floats) -> Bytes:
    """Interpolate display colours (k, 3) to 256, evenly in CIE lightness."""
    luminance = srgb_to_linear(anchors) @ (0.2126, 0.7152, 0.0722)
    lightness = np.where(
        luminance > 216 / 24389, np.cbrt(luminance) * 1.16 - 0.16, luminance * 9.033
    )
    place = (lightness - lightness[0]) / (lightness[-1] - lightness[0])
    steps = np.linspace(0, 1, 256)
    return quantise(np.stack([np.interp(steps, place, channel) for channel in anchors.T], axis=1))


def _installed_map(name: str) -> Any:
    known = list(BUILT_IN)
    named = [package for package in _PACKAGES if name.startswith(package[1])]
    for prefix, maps in _installed(named or _PACKAGES):
        for key in (name, name.removeprefix(prefix)):
            if key in maps:
                return maps[key]
        known += maps
    raise MeshdepictError(
        f"no colour map {name!r}{nearest(name, known)} (built in: {', '.join(BUILT_IN)}; more "
        "from matplotlib, cmcrameri, colorcet and cmocean where installed)"
    )


def _installed(packages: Iterable[tuple[str, str, str]]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Import the packages of colour maps one by one, as long as the caller keeps asking."""
    for module, prefix, attribute in packages:
        try:
            with warnings.catch_warnings():  # theirs, about one another's versions
                warnings.simplefilter("ignore")
                maps = getattr(importlib.import_module(module), attribute)
        except ImportError:
            continue
        yield prefix, maps


def _sampled(found: Any) -> Bytes:
    """Take 256 colours of a matplotlib colour map or of a list of "#rrggbb"."""
    if callable(found):
        return quantise(found(np.linspace(0, 1, 256))[:, :3])
    colors = np.array([list(bytes.fromhex(color[1:])) for color in found], np.uint8)
    return colors[np.linspace(0, len(colors) - 1, 256).round().astype(np.intp)]
