"""Short names: what "northwest", (300, 20), "front" and a panorama's file stand for."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import TypeAlias, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light, Lights
from meshdepict.scene.rig import RIGS, Rig
from meshdepict.scene.shape import Shape
from meshdepict.scene.vectors import Vector, numbers_of
from meshdepict.scene.view import View

__all__ = [
    "LIGHTS", "LightLike", "Lighting", "LightsLike", "as_light", "as_lighting", "as_lights",
    "as_view", "has_environment", "is_several", "light_angles", "parted",
]  # fmt: skip

LightLike: TypeAlias = str | ArrayLike | Light
"""A light as people give it: a name, a direction (x, y, z), (azimuth, elevation), or a `Light`."""

LightsLike: TypeAlias = LightLike | Environment | Sequence[LightLike | Environment]
"""Where several will do: also a sequence of lights, or an Environment or its file."""

Lighting: TypeAlias = Light | Lights | Environment
"""What a bake is lit by, once names and angles have become directions."""

# Azimuths clockwise from up. The elevation makes northwest (−1, 1, 1)/√3 in the view's frame.
_COMPASS = {
    "north": 0.0, "northeast": 45.0, "east": 90.0, "southeast": 135.0,
    "south": 180.0, "southwest": 225.0, "west": 270.0, "northwest": 315.0,
}  # fmt: skip
_COMPASS_ELEVATION = math.degrees(math.asin(1 / math.sqrt(3)))
LIGHTS = (*_COMPASS, "front")


def as_light(light: LightsLike, view: View | None = None) -> Light:
    """Return a light: as given, by name, by world direction or by angles in the view's frame.

    Parameters
    ----------
    light : str, (3,) array_like, (azimuth, elevation) or Light
        Azimuth in degrees clockwise from up, elevation in degrees from the image plane. A text that
        ends in a colon and a number, "northwest:20" or "315/45:20", is a disc of such a half-angle
        in degrees.
    view : View, optional
        Whose frame names and angles refer to; the front (x right, y up, z to the eye) if None.

    Raises
    ------
    MeshdepictError
        For an unknown name or anything that is no direction.
    """
    if isinstance(light, Light):
        return light
    frame = np.eye(3) if view is None else view.frame
    if isinstance(light, str):
        middle, colon, spread = light.rpartition(":")
        if colon and _numbers(spread):
            return _disc(middle, _numbers(spread)[0], view)
        if light == "front":
            return Light(frame[2], light)
        if light in RIGS:
            raise MeshdepictError(f"one light is needed here, not several ({light})")
        if light not in _COMPASS:
            raise MeshdepictError(
                f"no light is called {light!r}{nearest(light, (*LIGHTS, *RIGS))} (there are "
                f"{', '.join((*LIGHTS, *RIGS))}; or give azimuth,elevation in degrees or x,y,z)"
            )
        return Light(_from_angles(_COMPASS[light], _COMPASS_ELEVATION) @ frame, light)
    if isinstance(light, (Environment, Lights)):
        raise MeshdepictError(f"one light is needed here, not several ({light!s:.60})")
    numbers = numbers_of(light)
    if numbers.shape == (2,):
        azimuth, elevation = (float(x) for x in numbers)
        name = f"azimuth {azimuth:g} elevation {elevation:g}"  # ASCII: captions go into headers
        return Light(_from_angles(azimuth, elevation) @ frame, name)
    if numbers.shape == (3,):
        return Light(light)
    raise MeshdepictError(
        f"light={light!r} is neither a name, nor a direction (x, y, z), nor (azimuth, elevation)"
    )


def _disc(middle: str, spread: float, view: View | None) -> Light:
    """Return the disc about a light that is given by its name, its angles or its direction."""
    if middle in RIGS:
        raise MeshdepictError(
            f"the lights of {middle} have spreads of their own: leave :{spread:g} out"
        )
    found = as_light(_numbers(middle.replace("/", ",")) or middle, view)
    return replace(found, spread=spread)


def _numbers(text: str) -> tuple[float, ...]:
    """Return the numbers of a text with commas; none where it is something else."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        return ()


def _from_angles(azimuth: float, elevation: float) -> Vector:
    if not -90 <= elevation <= 90:
        raise MeshdepictError(
            f"a light's elevation is from -90 (behind) over 0 (in the image plane) to 90 degrees "
            f"(from the eye), not {elevation:g}: the azimuth comes first"
        )
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)])


def light_angles(light: Light, view: View | None = None) -> tuple[float, float]:
    """Return azimuth (0 … 360) and elevation of a light in degrees, as `as_light` takes them.

    A light on the line of sight has no azimuth: 0.
    """
    x, y, z = light.direction if view is None else view.frame @ light.direction
    across = math.hypot(x, y)
    # Rounded, so that a hair west of north is 0 and not 360.
    azimuth = round(math.degrees(math.atan2(x, y)), 9) % 360 if across > 1e-9 else 0.0
    return azimuth, math.degrees(math.atan2(z, across))


def as_lights(light: LightsLike, view: View | None = None, *, count: int = 54) -> list[Light]:
    """Return several lights: those of a sequence, `count` of an environment, or the one.

    Parameters
    ----------
    light : light, sequence of lights, or Environment
        A light as in `as_light`; a (k, 3) array is a sequence of directions.
    view : View, optional
        As in `as_light`.
    count : int
        Into how many lights an environment is sampled.
    """
    if isinstance(light, Environment):
        return list(light.lights(count))
    if isinstance(light, str) and light in RIGS:
        return list(Rig(light, np.eye(3) if view is None else view.frame))
    if not is_several(light):
        return [as_light(light, view)]
    lights = [one for item in light for one in as_lights(item, view, count=count)]
    if not lights:
        raise MeshdepictError("an empty sequence of lights leaves everything black; give one light")
    return lights


def has_environment(light: object) -> bool:
    """Whether this is an Environment, or several lights with one among them."""
    if isinstance(light, Environment):
        return True
    return is_several(light) and any(has_environment(item) for item in light)


def parted(light: LightsLike, view: View | None = None) -> tuple[list[Light], list[Environment]]:
    """Return the directional lights and the environments of what `as_lights` takes."""
    if isinstance(light, Environment):
        return [], [light]
    if not is_several(light) or not len(light):
        return as_lights(light, view), []
    parts = [parted(item, view) for item in light]
    return [one for lights, _ in parts for one in lights], [e for _, found in parts for e in found]


def as_lighting(
    light: LightsLike, view: View | None = None, *, up: str = "y", sampling: str = "lobes"
) -> Lighting:
    """Return what a bake is lit by: a `Light`, `Lights`, or an Environment as it is.

    "studio" and "key-and-fill" are `Rig`s. A text that ends in ".hdr" is an Environment's file,
    whose up is that of the shape; `sampling` is about it alone.
    """
    if isinstance(light, str) and light.lower().endswith(".hdr"):
        return Environment.from_file(light, up=up, sampling=sampling)
    if isinstance(light, (Environment, Rig)):
        return light
    if isinstance(light, str) and light in RIGS:
        return Rig(light, np.eye(3) if view is None else view.frame)
    return Lights(as_lights(light, view)) if is_several(light) else as_light(light, view)


def is_several(light: object) -> TypeGuard[Sequence[LightLike | Environment]]:
    """Whether this is a sequence of lights, and not the numbers of one."""
    if isinstance(light, (str, bytes, Light)) or not isinstance(light, Collection):
        return False
    if getattr(light, "shape", None) == ():  # an array of no axis has no length, though it says so
        return False
    return not len(light) or any(
        isinstance(item, (str, Light, Environment)) or np.ndim(item) for item in light
    )


def as_view(view: str | View, shape: Shape, *, up: str = "y") -> View:
    """Return a view: given as such or by name, then fitted to the shape.

    An image is seen from where it was made: its own view is the front.
    """
    if isinstance(view, View):
        return view
    own = getattr(shape, "view", None)
    if own is not None and isinstance(view, str) and view in ("front", own.name):
        return own
    return View.fitted(view, shape, up=up)
