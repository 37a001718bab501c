"""Where the eye is: `View`, and the views that have names."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.scene.shape import Shape
from meshdepict.scene.upright import upright
from meshdepict.scene.vectors import Vector, numbers_of, unit

__all__ = ["VIEWS", "View", "named_directions"]

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


def _positive(number: object, below: float) -> bool:
    """Whether this is a number between zero and a bound."""
    value = numbers_of(number)
    return not isinstance(number, (str, bytes)) and value.shape == () and 0 < float(value) < below


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
            value = numbers_of(getattr(self, field))
            if value.shape != (3,):
                raise MeshdepictError(f"a view's {field} must be three finite numbers")
            object.__setattr__(self, field, value)
        object.__setattr__(self, "up", unit(self.up, "a view's up direction"))
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
        return unit(self.position / 2 - self.focus / 2, "a line of sight")  # no overflow

    @property
    def frame(self) -> NDArray[np.float64]:
        """(3, 3) rows right, up, towards the eye: world to view space."""
        z = self.towards_eye
        x = unit(np.cross(self.up, z), "a view's right direction")
        return np.stack([x, np.cross(z, x), z])

    @classmethod
    def fitted(
        cls, name: str, shape: Shape, *, up: str = "y", aspect: float = 1.0, height_px: int = 1000
    ) -> View:
        """Make the named parallel view that shows the whole shape with a margin of 5 %.

        Parameters
        ----------
        name : str
            "front", "back", "left", "right", "top", "bottom" or "isometric".
        shape : Mesh, Volume or GBuffer
        up : {"y", "z", "-y", "-z", "x", "-x"}
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
        if not hasattr(shape, "outline"):
            raise MeshdepictError(f"a view can't be fitted to a {type(shape).__name__}")
        eye = cls(towards, (0, 0, 0), upwards, parallel_scale=1.0)
        seen = (shape.outline - shape.centre) @ eye.frame.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        half = (high - low) / 2
        scale = max(float(half[1]), float(half[0]) / aspect) * _MARGIN
        if scale <= 1e-9 * shape.diagonal:  # a line seen end on, or a point
            scale = shape.diagonal or float(np.abs(shape.centre).max()) or 1.0
        focus = shape.centre + ((low + high) / 2) @ eye.frame
        distance = max(4 * scale, float(half[2]) + 2 * scale)
        return cls(
            focus + distance * eye.towards_eye, focus, upwards,
            height_px=height_px, parallel_scale=scale, name=name,
        )  # fmt: skip


def named_directions(name: str, up: str = "y") -> tuple[Vector, Vector]:
    """Return (towards the eye, up) of a named view, in world space.

    With ``up="z"`` the frame is turned so that z points up and the front is seen from −y. "-y" and
    "-z" are for shapes that stand on their heads: half a turn about the line of sight of the front.
    "x" and "-x" are for those that lie on a side: a quarter turn about that of y's.
    """
    if not isinstance(name, str) or name not in _VIEWS:
        raise MeshdepictError(
            f"no view is called {name!r}{nearest(name, VIEWS)} (there are {', '.join(VIEWS)})"
        )
    turn = upright(up)
    towards, upwards = (turn @ np.array(v, np.float64) for v in _VIEWS[name])
    return towards, upwards
