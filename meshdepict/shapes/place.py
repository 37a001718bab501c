"""The place of a volume in the world without its values, for those that don't fit into memory."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from meshdepict.shapes.volume import Volume
from meshdepict.voxels.grid_samples import Triple

__all__ = ["Place"]


class Place(Volume):
    """Where a volume's voxels are, and what they mean, without their values.

    Parameters
    ----------
    shape : (nz, ny, nx)
    value_range : (low, high)
    spacing, origin, direction, hounsfield
        As for `Volume`.

    Raises
    ------
    MeshdepictError
        As `Volume`.
    """

    def __init__(
        self,
        shape: Triple,
        value_range: tuple[float, float],
        *,
        spacing: ArrayLike = (1.0, 1.0, 1.0),
        origin: ArrayLike = (0.0, 0.0, 0.0),
        direction: ArrayLike | None = None,
        hounsfield: bool = False,
    ) -> None:
        corners = np.zeros((2, 2, 2))
        corners[1] = 1  # two values, for a volume must not be constant
        super().__init__(
            corners, spacing=spacing, origin=origin, direction=direction, hounsfield=hounsfield
        )
        self.__dict__.pop("outline", None)  # looked at in checks, of the corners alone
        self.values = np.broadcast_to(np.zeros(1), shape)
        self.range = (float(value_range[0]), float(value_range[1]))

    def __reduce__(self) -> Any:
        """Travel to workers as the few numbers that it is, not as the values it stands for."""
        place = (self.spacing, self.origin, self.direction, self.hounsfield)
        return _place, (self.values.shape, self.range, *place)

    @property
    def identity(self) -> str:
        """Size and range: the values are never looked at all at once."""
        nz, ny, nx = self.values.shape
        return f"{nx} x {ny} x {nz} voxels, {self.range[0]:g} to {self.range[1]:g}"


def _place(
    shape: Triple, value_range: tuple[float, float], spacing: Any, origin: Any, direction: Any,
    hounsfield: bool,  # noqa: FBT001
) -> Place:  # fmt: skip
    return Place(
        shape, value_range,
        spacing=spacing, origin=origin, direction=direction, hounsfield=hounsfield,
    )  # fmt: skip
