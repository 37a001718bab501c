"""Turning the light by hand: a drag rolls it round the object, as a trackball under the pointer.

Everything here is about numbers: a window, a page and a test turn the same light the same way.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scene.light import Light, Lights
from meshdepict.scene.names import Lighting
from meshdepict.scene.rig import Rig
from meshdepict.scene.vectors import numbers_of
from meshdepict.scene.view import View

__all__ = ["angles", "carried", "dragged", "lights_of"]

_TURN = math.pi  # radians for a drag over the whole height: from rim to rim of the object


def dragged(lighting: Lighting, view: View, drag: ArrayLike) -> Lighting:
    """Return a light after a drag: it goes where the pointer goes, and behind at the rim.

    Parameters
    ----------
    lighting : Light or Lights
        Several lights turn together.
    view : View
        As whose eye sees the drag.
    drag : (2,) array_like
        To the right and up, in heights of the picture; a whole one turns the light by 180°.

    Returns
    -------
    Light or Lights
        Without a name where it was turned at all, but for a `Rig`.

    Raises
    ------
    MeshdepictError
        For an environment: a panorama stays where it is; and for what is no drag.
    """
    given = numbers_of(drag)
    if given.shape != (2,):
        raise MeshdepictError(f"drag={drag!r} is not two numbers: to the right, and up")
    right, up = given
    length = math.hypot(right, up)
    if length == 0:
        return lighting
    axis = np.array([-up, right, 0.0]) / length @ view.frame
    return _turned(lighting, _rotation(axis, _TURN * length))


def carried(lighting: Lighting, before: View, after: View) -> Lighting:
    """Return the light that stands to the eye after a move as it stood before.

    An environment is returned as it is.
    """
    turn = after.frame.T @ before.frame
    if np.allclose(turn, np.eye(3), rtol=0, atol=1e-12) or not lights_of(lighting):
        return lighting
    return _turned(lighting, turn)


def angles(light: Light, view: View) -> tuple[float, float]:
    """Return azimuth in [0, 360) and elevation of a light in degrees, as a view sees it."""
    right, up, towards = view.frame @ light.direction
    azimuth = round(math.degrees(math.atan2(right, up)), 9) % 360 + 0.0
    return azimuth, math.degrees(math.asin(max(-1.0, min(1.0, towards))))


def lights_of(lighting: Lighting) -> tuple[Light, ...]:
    """Return the lights one by one, of a `Rig` its lamps; none of an environment."""
    if isinstance(lighting, Rig):
        return lighting.lamps
    if isinstance(lighting, Light):
        return (lighting,)
    return tuple(lighting) if isinstance(lighting, Lights) else ()


def _turned(lighting: Lighting, turn: NDArray[np.float64]) -> Light | Lights:
    if isinstance(lighting, Rig):
        return lighting.turned(turn)
    lights = [light.turned(turn) for light in lights_of(lighting)]
    if not lights:
        raise MeshdepictError("a panorama can't be turned by hand: shade by a light instead")
    return lights[0] if isinstance(lighting, Light) else Lights(lights)


def _rotation(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the rotation about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
