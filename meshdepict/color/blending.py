"""Blending: one picture laid upon another, as image editors and relief maps do.

All values are display values in [0, 1], a the upper layer's, b those of what lies below:

===============  ==============================================================================
normal           a
multiply         a·b
screen           1 − (1 − a)(1 − b)
overlay          2ab where b ≤ ½, else 1 − 2(1 − a)(1 − b)
soft_light       2ab + b²(1 − 2a) where a < ½, else 2b(1 − a) + √b (2a − 1)
luminosity       b with the luma of a (0.30 R + 0.59 G + 0.11 B), its hue kept
multiply_linear  a·b in linear light: what light a leaves of the colour b, as tints are laid on
===============  ==============================================================================

The result is mixed with b by the layer's opacity o: o·f(a, b) + (1 − o)·b; in linear light where
that is what is multiplied. The first six are those of the Relief Visualization Toolbox (Kokalj and
Somrak, Why Not a Single Image? Combining Visualizations to Facilitate Fieldwork and On-Screen
Mapping, Remote Sensing 11, 2019), luminosity as in W3C's Compositing and Blending.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.spans import reach
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest, real

__all__ = [
    "MODES",
    "blended",
    "checked_mode",
    "checked_opacity",
    "checked_stretch",
    "flattened",
    "stretched",
]

Singles = NDArray[np.float32]

_LUMA = np.array([0.30, 0.59, 0.11], np.float32)
_HALF = np.float32(0.5)


def blended(
    upper: ArrayLike, lower: ArrayLike, mode: str = "normal", *, opacity: float = 1.0
) -> Singles:
    """Lay one layer upon another.

    Parameters
    ----------
    upper, lower : (n,) or (n, 3) array_like
        Display values in [0, 1], grey or in colour; clipped. NaN counts as 0.
    mode : {"normal", "multiply", "screen", "overlay", "soft_light", "luminosity", \
"multiply_linear"}
        See the module.
    opacity : float
        Of the upper layer; 0 leaves the lower one as it is.

    Returns
    -------
    (n,) or (n, 3) array of float32
        Display values in [0, 1]; in colour where one of the layers is, by luminosity where the
        lower one is.

    Raises
    ------
    MeshdepictError
        For an unknown mode, an opacity beyond 0 … 1, and layers of other shapes.
    """
    mode, share = checked_mode(mode), np.float32(checked_opacity(opacity))
    a, b = _values(upper), _values(lower)
    if mode == "luminosity" and a.ndim == 2:
        a = a @ _LUMA  # all that counts of it
    a, b = _alike(a, b)
    if mode == "multiply_linear":
        light = 1 + share * (srgb_to_linear(a) - 1)  # what the layer lets through
        return np.asarray(linear_to_srgb(srgb_to_linear(b) * light), np.float32)
    if share == 0:
        return b.copy()
    found = _EQUATIONS[mode](a, b)
    if share < 1:
        found = b + share * (found - b)
    return np.clip(found, 0, 1, dtype=np.float32)


def flattened(layers: Iterable[tuple[ArrayLike, str, float]]) -> Singles:
    """Return the picture that layers make, each (values, mode, opacity), the lowest first.

    The lowest lies on nothing: it is taken as it is, whatever its mode and opacity.

    Raises
    ------
    MeshdepictError
        As `blended`, and without any layer.
    """
    picture: Singles | None = None
    for values, mode, opacity in layers:
        if picture is None:
            checked_mode(mode)
            checked_opacity(opacity)
            picture = _values(values)
        else:
            picture = blended(values, picture, mode, opacity=opacity)
    if picture is None:
        raise MeshdepictError("no layers were given: a picture has at least one")
    return picture


def stretched(values: ArrayLike, low: float, high: float) -> Singles:
    """Return values with ``low`` at 0 and ``high`` at 1, clipped beyond; falling if low > high.

    Raises
    ------
    MeshdepictError
        For ends that are no numbers, or the same.
    """
    low, high = checked_stretch((low, high))
    shares = (np.asarray(values, np.float64) - low) / reach(low, high)
    return _values(shares)


# --- the equations ------------------------------------------------------------------------------


def _normal(a: Singles, b: Singles) -> Singles:
    return a


def _multiply(a: Singles, b: Singles) -> Singles:
    return a * b


def _screen(a: Singles, b: Singles) -> Singles:
    return a + b - a * b


def _overlay(a: Singles, b: Singles) -> Singles:
    return np.where(b > _HALF, 1 - 2 * (1 - a) * (1 - b), 2 * a * b)


def _soft_light(a: Singles, b: Singles) -> Singles:
    darker = b * (2 * a + b * (1 - 2 * a))
    return np.where(a < _HALF, darker, 2 * b * (1 - a) + np.sqrt(b) * (2 * a - 1))


def _luminosity(a: Singles, b: Singles) -> Singles:
    """Give b the luma of a: all channels shifted, then drawn towards the luma until they fit."""
    if b.ndim == 1:
        return a
    luma = a[:, :1]  # the same in all channels
    shift = b - (b @ _LUMA)[:, None]  # what b's colour is beside its luma
    least, most = (end(shift, axis=1, keepdims=True) for end in (np.min, np.max))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        room = np.fmin(
            np.where(least < 0, luma / -least, 1), np.where(most > 0, (1 - luma) / most, 1)
        )
    return luma + shift * np.clip(room, 0, 1)


_EQUATIONS: dict[str, Callable[[Singles, Singles], Singles]] = {
    "normal": _normal,
    "multiply": _multiply,
    "screen": _screen,
    "overlay": _overlay,
    "soft_light": _soft_light,
    "luminosity": _luminosity,
}

MODES = (*_EQUATIONS, "multiply_linear")
"""Names of the blend modes."""


# --- what is refused ----------------------------------------------------------------------------


def checked_mode(mode: object) -> str:
    """Return the name of a blend mode; refuse what is none, naming the nearest."""
    if not isinstance(mode, str) or mode not in MODES:
        raise MeshdepictError(
            f"no blend mode is called {mode!r}{nearest(str(mode), MODES)} (there are "
            f"{', '.join(MODES)})"
        )
    return mode


def checked_opacity(opacity: object) -> float:
    """Return an opacity; refuse what is no number from 0 to 1."""
    number = real(opacity)
    if number is None or not 0 <= number <= 1:
        raise MeshdepictError(f"opacity={opacity!r} is not a number from 0 to 1")
    return number


def checked_stretch(stretch: object) -> tuple[float, float]:
    """Return the two values that become 0 and 1; refuse what is not two numbers that differ."""
    try:
        low, high = (real(end) for end in stretch)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        low = high = None
    if low is None or high is None or low == high:
        raise MeshdepictError(
            f"stretch={stretch!r} is not two numbers that differ: the values that become 0 and 1"
        )
    return low, high


def _values(values: ArrayLike) -> Singles:
    """Return display values as float32 in [0, 1]."""
    try:
        array: NDArray[Any] = np.asarray(values, np.float32)
    except (TypeError, ValueError):
        array = np.empty((0, 0), np.float32)
    if array.ndim not in (1, 2) or (array.ndim == 2 and array.shape[1] != 3):
        raise MeshdepictError("a layer is numbers of shape (n,) or (n, 3), one for each sample")
    return np.fmin(np.fmax(array, np.float32(0)), np.float32(1))


def _alike(a: Singles, b: Singles) -> tuple[Singles, Singles]:
    """Return two layers of the same shape: both in colour where one is."""
    if len(a) != len(b):
        raise MeshdepictError(
            f"layers have a value for each sample, and these have {len(a):,} and {len(b):,}"
        )
    if a.ndim == b.ndim:
        return a, b
    return (_in_colour(a), _in_colour(b))


def _in_colour(values: Singles) -> Singles:
    return np.repeat(values[:, None], 3, axis=1) if values.ndim == 1 else values
