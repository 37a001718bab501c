"""The place of a volume in the world without its values, for those that don't fit into memory."""

from __future__ import annotations

from numpy.typing import ArrayLike

from meshdepict.voxels.grid import Grid, Triple

__all__ = ["Place"]


class Place(Grid):
    """Where a volume's voxels are, and what they mean, without their values.

    Parameters
    ----------
    counts : (nz, ny, nx)
    value_range : (low, high)
    spacing, origin, direction, hounsfield
        As for `Volume`.

    Raises
    ------
    MeshdepictError
        As `Grid`.
    """

    def __init__(
        self,
        counts: Triple,
        value_range: tuple[float, float],
        *,
        spacing: ArrayLike = (1.0, 1.0, 1.0),
        origin: ArrayLike = (0.0, 0.0, 0.0),
        direction: ArrayLike | None = None,
        hounsfield: bool = False,
    ) -> None:
        super().__init__(
            counts, spacing=spacing, origin=origin, direction=direction, hounsfield=hounsfield
        )
        self.range = (float(value_range[0]), float(value_range[1]))

    @property
    def identity(self) -> str:
        """Size and range: the values are never looked at all at once."""
        return f"{super().identity}, {self.range[0]:g} to {self.range[1]:g}"
