"""Light that comes from directions: `Light`, and several as `Lights`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scene.vectors import numbers_of, unit

__all__ = ["BRIGHTEST", "Light", "Lights"]

BRIGHTEST = 1e15
"""Largest number of a light's colour: sums of many, and their squares, are single precision's."""


@dataclass(frozen=True, eq=False)
class Light:
    """A directional light, or a disc of the sky.

    Parameters
    ----------
    direction : (3,) array_like
        Towards the light, in world space; normalised.
    name : str
        What a caption calls it.
    color : (3,) array_like
        Linear RGB, 0 … 1e15: what a white Lambertian surface facing the light shows (its
        irradiance / π).
    spread : float
        Half-angle of a disc about the direction in degrees, 0 … 180: its shadows are soft. What
        casts none is lit from its middle; `disc` gives lights that stand for it.
    """

    direction: Any
    name: str = ""
    color: Any = (1.0, 1.0, 1.0)
    spread: float = 0.0

    def __post_init__(self) -> None:
        """Check everything, and normalise the direction."""
        angle = real(self.spread)
        if angle is None or not 0 <= angle <= 180:
            raise MeshdepictError(
                f"a light's spread is half the opening of its disc, from 0 to 180 degrees, not "
                f"{self.spread!r}"
            )
        object.__setattr__(self, "spread", float(angle))
        object.__setattr__(self, "direction", unit(self.direction, "a light's direction"))
        color = numbers_of(self.color)
        if color.shape != (3,) or not ((color >= 0) & (color <= BRIGHTEST)).all():
            raise MeshdepictError(
                f"a light's color must be three numbers from 0 to {BRIGHTEST:g}, not "
                f"{self.color!r:.80}"
            )
        object.__setattr__(self, "color", color)

    def turned(self, turn: NDArray[np.float64]) -> Light:
        """Return the light turned by a rotation (3, 3); its name, which says where, is gone."""
        return Light(turn @ self.direction, "", self.color, self.spread)

    def disc(self, count: int = 16) -> list[Light]:
        """Return so many lights that stand for the disc, and share its colour evenly.

        Raises
        ------
        MeshdepictError
            For what is no number of lights.
        """
        number = real(count)
        if number is None or not 1 <= number <= 1_000_000 or not number.is_integer():
            raise MeshdepictError(f"count={count!r} is not a number of lights")
        # A golden spiral: even by solid angle, in any number.
        i = np.arange(count) + 0.5
        height = 1 - (1 - math.cos(math.radians(self.spread))) * i / count
        turn = math.pi * (3 - math.sqrt(5)) * i
        across = np.sqrt(np.maximum(1 - height**2, 0))
        axis = unit(np.eye(3)[np.argmin(np.abs(self.direction))], "an axis")
        x = unit(np.cross(axis, self.direction), "an axis")
        y = np.cross(self.direction, x)
        samples = across[:, None] * (np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y)
        samples += height[:, None] * self.direction
        return [Light(sample, self.name, self.color / count) for sample in samples]

    def __str__(self) -> str:
        """Return the name and the direction, and what is not as usual."""
        numbers = " ".join(f"{x:.6g}" for x in self.direction)
        tint = (
            "" if (self.color == 1).all() else f" color {' '.join(f'{x:.6g}' for x in self.color)}"
        )
        disc = f" spread {self.spread:g}" if self.spread else ""
        place = f"{self.name}{disc} ({numbers})" if self.name else f"({numbers}){disc}"
        return place + tint


class Lights(tuple[Light, ...]):
    """Several lights, in words."""

    def __str__(self) -> str:
        """Return the lights, separated by semicolons."""
        return "; ".join(map(str, self))
