"""Lights that stand together, by name: a soft studio, and a key light with its fill."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.scene.light import Light, Lights
from meshdepict.scene.vectors import numbers_of, unit

__all__ = ["RIGS", "Rig"]

# For each rig its lamps: towards which direction (right, up, to the eye), half the opening of its
# disc in degrees, how many lights stand for it, and how bright it is.
# No sum is above 1 on a sphere.
_LAMPS: Mapping[str, tuple[tuple[tuple[float, float, float], float, int, float], ...]] = {
    # A large soft box, a weaker one across from it, and one behind for the side turned away: many
    # lights, as where one of them sets, Light Warping drops it at once.
    "studio": (
        ((-1, 1, 1), 25, 28, 0.82),
        ((1, 0.1, 0.4), 50, 13, 0.06),
        ((0.3, 0.6, -1), 50, 13, 0.18),
    ),
    # The northwest light of every other method, and a weak one from where that leaves all black.
    "key-and-fill": (((-1, 1, 1), 0, 1, 0.92), ((1, -1, -1), 0, 1, 0.06)),
}
RIGS = tuple(_LAMPS)
"""Names of rigs."""


class Rig(Lights):
    """Several lights that are placed together, in a frame of their own.

    Parameters
    ----------
    name : {"studio", "key-and-fill"}
    frame : (3, 3) array_like
        Rows right, up and towards the eye, as of `View.frame`.

    Attributes
    ----------
    name, frame

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """

    name: str
    frame: NDArray[np.float64]

    def __new__(cls, name: str, frame: ArrayLike) -> Self:
        """Place the lights."""
        if name not in _LAMPS:
            raise MeshdepictError(
                f"no lights are called {name!r}{nearest(name, RIGS)} (there are {', '.join(RIGS)})"
            )
        axes = np.array(frame, np.float64)
        lights = (
            light
            for direction, radius, count, bright in _LAMPS[name]
            for light in Light(direction, color=np.full(3, bright), spread=radius).disc(count)
        )
        rig = super().__new__(
            cls, (Light(light.direction @ axes, name, light.color) for light in lights)
        )
        axes.setflags(write=False)
        rig.name, rig.frame = name, axes
        return rig

    @classmethod
    def of(cls, words: Mapping[str, Any]) -> Self:
        """Return the rig of `words`.

        Raises
        ------
        MeshdepictError
            Where they are no rig's.
        """
        if set(words) != {"name", "up", "eye"}:
            raise MeshdepictError("lights by name have a name, an up and an eye, and nothing else")
        name = words["name"]
        if not isinstance(name, str):
            raise MeshdepictError(f"no lights are called {name!r} (there are {', '.join(RIGS)})")
        up, eye = (numbers_of(words[key]) for key in ("up", "eye"))
        if up.shape != (3,) or eye.shape != (3,):
            raise MeshdepictError("up and eye of lights by name are three numbers each")
        eye = unit(eye, "the eye of lights")
        right = unit(np.cross(up, eye), "up across the eye of lights")
        return cls(name, [right, np.cross(eye, right), eye])

    def words(self) -> dict[str, Any]:
        """Return what `of` makes it from again."""
        return {"name": self.name, "up": self.frame[1].tolist(), "eye": self.frame[2].tolist()}

    @property
    def lamps(self) -> tuple[Light, ...]:
        """A light in the middle of each disc, as bright as it; the first is the key."""
        return tuple(
            Light(np.array(direction) @ self.frame, color=np.full(3, bright))
            for direction, _, _, bright in _LAMPS[self.name]
        )

    def turned(self, turn: NDArray[np.float64]) -> Self:
        """Return the same lights turned together by a rotation (3, 3)."""
        return type(self)(self.name, self.frame @ turn.T)

    def aimed(self, light: Light) -> Self:
        """Return the same lights turned together so that the key stands where a light does."""
        key, wanted = self.lamps[0].direction, light.direction
        axis, cosine = np.cross(key, wanted), float(key @ wanted)
        if cosine < -1 + 1e-12:  # half a turn, about any axis across
            across = unit(np.cross(key, np.eye(3)[np.argmin(np.abs(key))]), "an axis")
            return self.turned(2 * np.outer(across, across) - np.eye(3))
        x, y, z = axis
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return self.turned(np.eye(3) + cross + cross @ cross / (1 + cosine))

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes it again in another process."""
        return type(self), (self.name, self.frame)

    def __str__(self) -> str:
        """Return the name, and how it stands."""
        up, eye = (" ".join(f"{x:.6g}" for x in axis) for axis in self.frame[1:])
        return f"{self.name} (up {up}, eye {eye})"
