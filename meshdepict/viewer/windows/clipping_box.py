"""A box across the world's axes that hides what lies outside of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from meshdepict.errors import MeshdepictError
from meshdepict.scene.shape import Shape

__all__ = ["ClippingBox"]

_STEP = 0.05  # of the box's length along an axis


class ClippingBox:
    """A box about a shape, of which slices are cut off.

    Parameters
    ----------
    shape : Volume
        Drawn in its diagonals about the origin.

    Attributes
    ----------
    low, high : (3,) array
        Its sides, as shares of the shape's extent along the world's axes.
    """

    def __init__(self, shape: Shape) -> None:
        self.low, self.high = np.zeros(3), np.ones(3)
        corners = shape.recentred(shape.outline)
        self._corner = corners.min(axis=0)
        self._lengths = corners.max(axis=0) - self._corner

    def cut(self, axis: int, towards_eye: ArrayLike) -> None:
        """Cut a slice off the side across an axis that faces an eye.

        Raises
        ------
        MeshdepictError
            Where that would be all that is left.
        """
        if self.high[axis] - self.low[axis] < 2 * _STEP - 1e-9:
            raise MeshdepictError(f"there is but a slice left across {'xyz'[axis]}: put some back")
        if np.asarray(towards_eye)[axis] >= 0:
            self.high[axis] -= _STEP
        else:
            self.low[axis] += _STEP

    def mend(self, axis: int, towards_eye: ArrayLike) -> None:
        """Put a slice back where `cut` took it from, or on the other side."""
        near = np.asarray(towards_eye)[axis] >= 0
        side = (
            self.high
            if (near and self.high[axis] < 1 - 1e-9) or self.low[axis] < 1e-9
            else self.low
        )
        if side is self.high:
            side[axis] = min(side[axis] + _STEP, 1.0)
        else:
            side[axis] = max(side[axis] - _STEP, 0.0)

    def reset(self) -> None:
        """Hide nothing."""
        self.low[:], self.high[:] = 0, 1

    def planes(self) -> list[Any]:
        """Return a vtkPlane for each side that hides anything."""
        from vtkmodules.vtkCommonDataModel import vtkPlane

        found = []
        for sides, normal in ((self.low, 1.0), (self.high, -1.0)):
            for axis in range(3):
                if 1e-9 < sides[axis] < 1 - 1e-9:
                    place = np.zeros(3)
                    place[axis] = self._corner[axis] + sides[axis] * self._lengths[axis]
                    plane = vtkPlane()
                    plane.SetOrigin(*place)
                    plane.SetNormal(*(normal * np.eye(3)[axis]))
                    found.append(plane)
        return found
