"""Turntables: how lights circle and eyes go round, as plain geometry."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scene.light import Light, Lights
from meshdepict.scene.names import Lighting
from meshdepict.scene.rig import Rig
from meshdepict.scene.view import View

__all__ = ["circling", "rotation", "turned", "turned_light"]

Floats = NDArray[np.float64]


def rotation(axis: Floats, angle: float) -> Floats:
    """Return the (3, 3) matrix that turns by an angle in degrees, right-handed (Rodrigues)."""
    x, y, z = axis
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)), dtype=np.float64)
    a = math.radians(angle)
    matrix: Floats = np.eye(3) + math.sin(a) * cross + (1 - math.cos(a)) * (cross @ cross)
    return matrix


def turned(view: View, angle: float) -> View:
    """Return a view whose eye went round the axis through its focus along its up, in degrees.

    To the right: an object on a turntable that turns to the left, as from above clockwise.
    """
    position = view.focus + rotation(view.up, angle) @ (view.position - view.focus)
    return View(
        position, view.focus, view.up, height_px=view.height_px,
        field_of_view=view.field_of_view, parallel_scale=view.parallel_scale,
    )  # fmt: skip


def turned_light(light: Lighting, view: View, angle: float) -> Light | Lights:
    """Return a light, or several, that went with the eye of `turned`.

    Raises
    ------
    MeshdepictError
        For an environment.
    """
    if isinstance(light, Rig):
        return light.turned(rotation(view.up, angle))
    if isinstance(light, Lights):
        return Lights(_gone_round(one, view, angle) for one in light)
    if not isinstance(light, Light):
        raise MeshdepictError(
            "an environment stays with the object: it can't go with the eye; give "
            "light_fixed='object'"
        )
    return _gone_round(light, view, angle)


def _gone_round(light: Light, view: View, angle: float) -> Light:
    return replace(light, direction=rotation(view.up, angle) @ light.direction)


def circling(light: Lighting, view: View, angle: float) -> Light | Rig:
    """Return a light that circled round the line of sight: clockwise by an angle in degrees.

    Its elevation from the image plane stays. A `Rig` circles as a whole.

    Raises
    ------
    MeshdepictError
        For several lights, and for one along the line of sight, whose circle is a point.
    """
    if isinstance(light, Rig):
        return light.turned(rotation(view.towards_eye, -angle))
    if not isinstance(light, Light):
        raise MeshdepictError("one light circles, not several: give one, such as northwest")
    axis = view.towards_eye
    if np.linalg.norm(np.cross(axis, light.direction)) < 1e-6:
        raise MeshdepictError(
            "a light along the line of sight stays the same as it circles: give another, such as "
            "northwest"
        )
    direction = rotation(axis, -angle) @ light.direction
    return replace(light, direction=direction, name=f"{light.name} turned by {angle:g}".lstrip())
