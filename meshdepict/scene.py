"""Where the light comes from and where the eye is: `Light`, `View` and their short names."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest

if TYPE_CHECKING:
    from meshdepict.mesh import Mesh

__all__ = [
    "LIGHTS",
    "VIEWS",
    "Light",
    "Lights",
    "View",
    "as_light",
    "as_lighting",
    "as_lights",
    "as_view",
    "is_several",
]

Vector = NDArray[np.float64]

# Azimuths clockwise from up. The elevation makes northwest (−1, 1, 1)/√3 in the view's frame.
_COMPASS = {
    "north": 0.0, "northeast": 45.0, "east": 90.0, "southeast": 135.0,
    "south": 180.0, "southwest": 225.0, "west": 270.0, "northwest": 315.0,
}  # fmt: skip
_COMPASS_ELEVATION = math.degrees(math.asin(1 / math.sqrt(3)))
LIGHTS = (*_COMPASS, "front")

# Direction from the object to the eye, and up, for objects whose y axis points up.
_VIEWS = {
    "front": ((0, 0, 1), (0, 1, 0)),
    "back": ((0, 0, -1), (0, 1, 0)),
    "right": ((1, 0, 0), (0, 1, 0)),
    "left": ((-1, 0, 0), (0, 1, 0)),
    "top": ((0, 1, 0), (0, 0, -1)),
    "bottom": ((0, -1, 0), (0, 0, 1)),
    "isometric": ((1, 1, 1), (0, 1, 0)),
}
VIEWS = tuple(_VIEWS)
_MARGIN = 1.05  # a fitted view leaves 5 % round the object


def _numbers(given: Any) -> Vector:
    """Return a new read-only array of finite numbers, an empty one where that is impossible."""
    try:
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.empty(0)
    array = array if np.isfinite(array).all() else np.empty(0)
    array.setflags(write=False)
    return array


def _unit(vector: ArrayLike, what: str) -> Vector:
    array = _numbers(vector)
    if array.shape != (3,) or not array.any():
        raise MeshdepictError(f"{what} must be three finite numbers, not all zero, not {vector!r}")
    array = array / np.abs(array).max()  # so that squares neither overflow nor vanish
    array /= np.linalg.norm(array)
    array.setflags(write=False)
    return array


def _positive(number: Any, below: float) -> bool:
    """Whether this is a number between zero and a bound."""
    value = _numbers(number)
    return not isinstance(number, (str, bytes)) and value.shape == () and 0 < float(value) < below


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
        object.__setattr__(self, "direction", _unit(self.direction, "a light's direction"))
        color = _numbers(self.color)
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
        axis = _unit(np.eye(3)[np.argmin(np.abs(self.direction))], "an axis")
        x = _unit(np.cross(axis, self.direction), "an axis")
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


@dataclass(frozen=True, eq=False)
class View:
    """An eye: where it is, what it looks at, and how the picture is projected.

    Parameters
    ----------
    position, focus, up : (3,) array_like
        In world units; ``up`` need not be perpendicular to the line of sight.
    height_px : int
        Height of the picture in pixels.
    field_of_view : float, optional
        Vertical angle in degrees of a perspective view.
    parallel_scale : float, optional
        Half the picture's height in world units, of a parallel view (VTK's convention).
        One of the two; a field of view of 30° where neither is given.
    name : str
        What a caption calls it.
    """

    position: Any
    focus: Any
    up: Any
    height_px: int = 1000
    field_of_view: float | None = None
    parallel_scale: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check everything once."""
        for field in ("position", "focus"):
            value = _numbers(getattr(self, field))
            if value.shape != (3,):
                raise MeshdepictError(f"a view's {field} must be three finite numbers")
            object.__setattr__(self, field, value)
        object.__setattr__(self, "up", _unit(self.up, "a view's up direction"))
        if np.array_equal(self.position, self.focus):
            raise MeshdepictError("a view's position and focus are the same point")
        if np.linalg.norm(np.cross(self.up, self.towards_eye)) < 1e-9:
            raise MeshdepictError("a view's up direction lies along its line of sight")
        if self.field_of_view is not None and self.parallel_scale is not None:
            raise MeshdepictError("a view has a field of view or a parallel scale, not both")
        if self.field_of_view is None and self.parallel_scale is None:
            object.__setattr__(self, "field_of_view", 30.0)
        if self.field_of_view is not None and not _positive(self.field_of_view, 180):
            raise MeshdepictError(
                f"field_of_view={self.field_of_view!r} is not between 0° and 180°"
            )
        if self.parallel_scale is not None and not _positive(self.parallel_scale, math.inf):
            raise MeshdepictError(
                f"parallel_scale={self.parallel_scale!r} is not a positive length"
            )
        if not _positive(self.height_px, math.inf) or self.height_px != int(self.height_px):
            raise MeshdepictError(f"height_px={self.height_px!r} is not a number of pixels")

    def __str__(self) -> str:
        """Return the name, where the eye is, what it looks at, and what is up."""
        eye, focus, up = (
            " ".join(f"{x:.6g}" for x in vector) for vector in (self.position, self.focus, self.up)
        )
        return f"{self.name} from ({eye}) to ({focus}), up ({up})".lstrip()

    @property
    def towards_eye(self) -> Vector:
        """Unit vector from the focus to the eye: the view axis z."""
        return _unit(self.position / 2 - self.focus / 2, "a line of sight")  # no overflow

    @property
    def frame(self) -> NDArray[np.float64]:
        """(3, 3) rows right, up, towards the eye: world to view space."""
        z = self.towards_eye
        x = _unit(np.cross(self.up, z), "a view's right direction")
        return np.stack([x, np.cross(z, x), z])

    @classmethod
    def fitted(
        cls, name: str, shape: Mesh, *, up: str = "y", aspect: float = 1.0, height_px: int = 1000
    ) -> View:
        """Make the named parallel view that shows the whole shape with a margin of 5 %.

        Parameters
        ----------
        name : str
            "front", "back", "left", "right", "top", "bottom" or "isometric".
        shape : Mesh
        up : {"y", "z"}
            Which axis of the object points up.
        aspect : float
            Width over height of the picture.

        Raises
        ------
        MeshdepictError
            For an unknown name or axis, and a picture without width or height.
        """
        if not _positive(aspect, math.inf):
            raise MeshdepictError(f"aspect={aspect!r} is not a positive ratio")
        towards, upwards = named_directions(name, up)
        eye = cls(towards, (0, 0, 0), upwards, parallel_scale=1.0)
        seen = (shape.vertices - shape._centre) @ eye.frame.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        half = (high - low) / 2
        scale = max(float(half[1]), float(half[0]) / aspect) * _MARGIN
        if scale <= 1e-9 * shape.diagonal:  # a line seen end on, or a point
            scale = shape.diagonal or float(np.abs(shape._centre).max()) or 1.0
        focus = shape._centre + ((low + high) / 2) @ eye.frame
        distance = max(4 * scale, float(half[2]) + 2 * scale)
        return cls(
            focus + distance * eye.towards_eye, focus, upwards,
            height_px=height_px, parallel_scale=scale, name=name,
        )  # fmt: skip


def named_directions(name: str, up: str = "y") -> tuple[Vector, Vector]:
    """Return (towards the eye, up) of a named view, in world space.

    With ``up="z"`` the frame is turned so that z points up and the front is seen from −y.
    """
    if not isinstance(name, str) or name not in _VIEWS:
        raise MeshdepictError(
            f"no view is called {name!r}{nearest(name, VIEWS)} (there are {', '.join(VIEWS)})"
        )
    if up not in ("y", "z"):
        raise MeshdepictError(f"up={up!r} is neither 'y' nor 'z'")
    towards, upwards = (np.array(v, dtype=np.float64) for v in _VIEWS[name])
    if up == "z":
        turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        towards, upwards = turn @ towards, turn @ upwards
    return towards, upwards


def as_view(view: str | View, shape: Mesh, *, up: str = "y") -> View:
    """Return a view: given as such or by name, then fitted to the shape."""
    return view if isinstance(view, View) else View.fitted(view, shape, up=up)


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
    numbers = _numbers(light)
    if numbers.shape == (2,):
        azimuth, elevation = (float(x) for x in numbers)
        name = f"azimuth {azimuth:g}° elevation {elevation:g}°"
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
        from meshdepict.environment import Environment

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
