"""Where the light comes from: `Light`, its names and angles, and several of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest

if TYPE_CHECKING:
    from meshdepict.scene.view import View

__all__ = [
    "LIGHTS",
    "Light",
    "Lights",
    "as_light",
    "as_lighting",
    "as_lights",
    "is_several",
    "numbers_of",
    "unit",
]

Vector = NDArray[np.float64]

# Azimuths clockwise from up. The elevation makes northwest (−1, 1, 1)/√3 in the view's frame.
_COMPASS = {
    "north": 0.0, "northeast": 45.0, "east": 90.0, "southeast": 135.0,
    "south": 180.0, "southwest": 225.0, "west": 270.0, "northwest": 315.0,
}  # fmt: skip
_COMPASS_ELEVATION = math.degrees(math.asin(1 / math.sqrt(3)))
LIGHTS = (*_COMPASS, "front")


def numbers_of(given: Any) -> Vector:
    """Return a new read-only array of finite numbers, an empty one where that is impossible."""
    try:
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.empty(0)
    array = array if np.isfinite(array).all() else np.empty(0)
    array.setflags(write=False)
    return array


def unit(vector: ArrayLike, what: str) -> Vector:
    """Return a read-only unit vector; ``what`` it is goes into the sentence if it can't be one."""
    array = numbers_of(vector)
    if array.shape != (3,) or not array.any():
        raise MeshdepictError(f"{what} must be three finite numbers, not all zero, not {vector!r}")
    array = array / np.abs(array).max()  # so that squares neither overflow nor vanish
    array /= np.linalg.norm(array)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Light:
    """A directional light.

    Parameters
    ----------
    direction : (3,) array_like
        Towards the light, in world space; normalised.
    name : str
        What a caption calls it.
    color : (3,) array_like
        Linear RGB: what a white Lambertian surface facing the light shows (its irradiance / π).
    """

    direction: Any
    name: str = ""
    color: Any = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        """Check everything, and normalise the direction."""
        object.__setattr__(self, "direction", unit(self.direction, "a light's direction"))
        color = numbers_of(self.color)
        if color.shape != (3,) or (color < 0).any():
            raise MeshdepictError(f"a light's color must be three numbers ≥ 0, not {self.color!r}")
        object.__setattr__(self, "color", color)

    def spread(self, radius: float, *, count: int = 16) -> list[Light]:
        """Return an area light as samples: a disc of the sky about the direction.

        Parameters
        ----------
        radius : float
            Angular, in degrees, 0 … 180.
        count : int
            Lights, which share the colour evenly.
        """
        if isinstance(count, bool) or not 1 <= count <= 1_000_000 or count != int(count):
            raise MeshdepictError(f"count={count!r} is not a number of lights")
        if not 0 <= radius <= 180:
            raise MeshdepictError(f"radius={radius!r} is not an angle from 0° to 180°")
        # A golden spiral: even by solid angle, in any number.
        i = np.arange(count) + 0.5
        height = 1 - (1 - math.cos(math.radians(radius))) * i / count
        turn = math.pi * (3 - math.sqrt(5)) * i
        across = np.sqrt(np.maximum(1 - height**2, 0))
        axis = unit(np.eye(3)[np.argmin(np.abs(self.direction))], "an axis")
        x = unit(np.cross(axis, self.direction), "an axis")
        y = np.cross(self.direction, x)
        samples = across[:, None] * (np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y)
        samples += height[:, None] * self.direction
        return [Light(sample, self.name, self.color / count) for sample in samples]

    def __str__(self) -> str:
        """Return the name and the direction."""
        numbers = " ".join(f"{x:.6g}" for x in self.direction)
        tint = (
            "" if (self.color == 1).all() else f" color {' '.join(f'{x:.6g}' for x in self.color)}"
        )
        return (f"{self.name} ({numbers})" if self.name else f"({numbers})") + tint


def as_light(light: Any, view: View | None = None) -> Light:
    """Return a light: as given, by name, by world direction or by angles in the view's frame.

    Parameters
    ----------
    light : str, (3,) array_like, (azimuth, elevation) or Light
        Azimuth in degrees clockwise from up, elevation in degrees from the image plane.
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
        if light == "front":
            return Light(frame[2], light)
        if light not in _COMPASS:
            raise MeshdepictError(
                f"no light is called {light!r}{nearest(light, LIGHTS)} (there are "
                f"{', '.join(LIGHTS)}; or give azimuth,elevation in degrees or x,y,z)"
            )
        return Light(_from_angles(_COMPASS[light], _COMPASS_ELEVATION) @ frame, light)
    if _is_environment(light) or isinstance(light, Lights):
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


def _from_angles(azimuth: float, elevation: float) -> Vector:
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)])


def as_lights(light: Any, view: View | None = None, *, count: int = 54) -> list[Light]:
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
    if _is_environment(light):
        return list(light.lights(count))
    if not is_several(light):
        return [as_light(light, view)]
    lights = [one for item in light for one in as_lights(item, view, count=count)]
    if not lights:
        raise MeshdepictError("an empty sequence of lights leaves everything black; give one light")
    return lights


class Lights(tuple[Light, ...]):
    """Several lights, in words."""

    __slots__ = ()

    def __str__(self) -> str:
        """Return the lights, separated by semicolons."""
        return "; ".join(map(str, self))


def as_lighting(light: Any, view: View | None = None, *, up: str = "y") -> Any:
    """Return what a bake is lit by: a `Light`, `Lights`, or an Environment as it is.

    A text that ends in ".hdr" is an Environment's file, whose up is that of the shape.
    """
    if isinstance(light, str) and light.lower().endswith(".hdr"):
        from meshdepict.scene.environment import Environment

        return Environment.from_file(light, up=up)
    if _is_environment(light):
        return light
    return Lights(as_lights(light, view)) if is_several(light) else as_light(light, view)


def is_several(light: Any) -> bool:
    """Whether this is a sequence of lights, and not the numbers of one."""
    if isinstance(light, (str, Light)) or not hasattr(light, "__len__"):
        return False
    return not len(light) or any(
        isinstance(item, (str, Light)) or _is_environment(item) or np.ndim(item) for item in light
    )


def _is_environment(light: Any) -> bool:
    return hasattr(light, "irradiance")  # `Environment` stands right of this module
