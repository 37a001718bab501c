"""Colour maps of two shadings: the same shape under two lights in one picture (ES fig. 7).

What only one of the lights reaches gets that light's colour, so that slopes of every direction
differ in hue and not in brightness alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.srgb import linear_to_srgb, quantise
from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.scene.light import Light
from meshdepict.scene.view import View

__all__ = ["NAMES", "both_lights", "colormap2d", "mix", "second_light"]

# Display colours (0 … 255) where neither light, the first, the second, and both of them shine.
_CORNERS = {
    "dusk": ((16, 14, 44), (244, 180, 92), (74, 112, 196), (255, 250, 238)),
    "earth": ((40, 24, 16), (206, 156, 90), (104, 130, 84), (250, 245, 226)),
    "swiss": ((48, 54, 92), (250, 236, 170), (152, 174, 206), (255, 255, 247)),
}
NAMES = tuple(_CORNERS)


def colormap2d(name: str) -> NDArray[np.uint8]:
    """Return a 2D colour map as a table of display colours.

    Parameters
    ----------
    name : {"dusk", "earth", "swiss"}

    Returns
    -------
    (256, 256, 3) array of uint8
        By the levels of the first and of the second shading.

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    level = np.arange(256) / 255
    return quantise(mix(*np.meshgrid(level, level, indexing="ij"), name))


def mix(first: ArrayLike, second: ArrayLike, name: str) -> NDArray[np.float32]:
    """Return the display colours (…, 3) in [0, 1] for two shadings (…) in [0, 1].

    Bilinear between the colours of the four corners.

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    if not isinstance(name, str) or name not in _CORNERS:
        raise MeshdepictError(
            f"no 2D colour map {name!r}{nearest(name, NAMES)} (there are {', '.join(NAMES)})"
        )
    neither, one, other, both = np.array(_CORNERS[name], np.float32) / 255
    a, b = (np.clip(np.asarray(v, np.float32), 0, 1)[..., None] for v in (first, second))
    return (1 - a) * ((1 - b) * neither + b * other) + a * ((1 - b) * one + b * both)


def second_light(light: Light, view: View) -> Light:
    """Return the light turned by 90° clockwise round the line of sight: northwest to northeast."""
    x, y, z = view.frame @ light.direction
    return Light(np.array([y, -x, z]) @ view.frame)


def both_lights(
    shade: Callable[[Light], NDArray[np.float32]],
    light: Light,
    view: View,
    name: str,
    *,
    linear: bool,
) -> NDArray[np.float32]:
    """Shade under a light and the `second_light`, and mix the two.

    Parameters
    ----------
    shade : callable
        From a light to shading (n,) in [0, 1].
    light : Light
    view : View
    name : str
        Of a `colormap2d`.
    linear : bool
        Whether `shade` returns linear or display values.

    Returns
    -------
    (n, 3) array of float32
        Display colours in [0, 1].

    Raises
    ------
    MeshdepictError
        For an unknown name, and for shading that is in colour already.
    """
    shadings = [shade(light), shade(second_light(light, view))]
    if shadings[0].ndim != 1:
        raise MeshdepictError(
            f"the 2D colour map {name!r} needs one value per point, but this shading is in colour "
            "already; leave the colour map out"
        )
    if linear:
        shadings = [linear_to_srgb(shading) for shading in shadings]
    return mix(shadings[0], shadings[1], name)
