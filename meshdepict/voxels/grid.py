"""Grid: where voxels are in the world and what their values mean, without the values.

World space is the patient's: x to the left, y to the back, z to the head (LPS), as in DICOM and
SimpleITK, in the unit of length that the file says.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scene.vectors import frozen
from meshdepict.voxels.length_unit import MILLIMETRES
from meshdepict.voxels.volume_input import as_list, checked_direction, three_numbers

__all__ = ["Grid", "Triple"]

Floats = NDArray[np.float64]

Triple = tuple[int, int, int]
"""Along z, y and x."""

_LARGEST = 1e150  # beyond it squares of coordinates overflow, within its inverse they vanish
_FARTHEST = 1e15  # sizes: from there on double precision knows a thousand places within the volume


class Grid:
    """A regular grid of voxels in the world.

    Parameters
    ----------
    counts : (nz, ny, nx)
    spacing, origin, direction, hounsfield, length_unit
        As for `Volume`, which is a grid with values.

    Raises
    ------
    MeshdepictError
        For a spacing that is not positive, and directions that are not orthonormal.
    """

    kind = "volume"
    values: Any = None  # (nz, ny, nx), where they are at hand
    range: Any  # (smallest, largest) value

    def __init__(
        self,
        counts: tuple[int, ...],
        *,
        spacing: ArrayLike = (1.0, 1.0, 1.0),
        origin: ArrayLike = (0.0, 0.0, 0.0),
        direction: ArrayLike | None = None,
        hounsfield: bool = False,
        length_unit: str = "",
    ) -> None:
        self.counts: Triple = (counts[0], counts[1], counts[2])
        self.spacing = frozen(three_numbers(spacing, "spacing"))
        self.origin = frozen(three_numbers(origin, "origin"))
        self.direction = frozen(checked_direction(np.eye(3) if direction is None else direction))
        if not (self.spacing > 0).all():
            raise MeshdepictError(
                f"the spacing {as_list(self.spacing)} is not positive along every axis"
            )
        with np.errstate(over="ignore", invalid="ignore"):  # neither is below the largest
            reach = np.abs(self.outline).max()
        if not reach < _LARGEST:
            raise MeshdepictError(f"the volume reaches beyond {_LARGEST:g} in world coordinates")
        if self.diagonal < 1 / _LARGEST:
            raise MeshdepictError(
                f"the volume is smaller than {1 / _LARGEST:g}, which leaves no room for computing: "
                "give its spacing in another unit"
            )
        if reach > _FARTHEST * self.diagonal:
            raise MeshdepictError(
                f"the volume reaches {reach:g} from the origin, so far for its size of "
                f"{self.diagonal:g} that voxels can't be told apart: move it nearer"
            )
        if not isinstance(hounsfield, (bool, np.bool_)):
            raise MeshdepictError(f"hounsfield={hounsfield!r} is neither True nor False")
        self.hounsfield = bool(hounsfield)
        self.length_unit = str(length_unit)

    @property
    def unit(self) -> str:
        """What the values are: "HU" or "raw"."""
        return "HU" if self.hounsfield else "raw"

    @property
    def units_per_mm(self) -> float:
        """How many units of length a millimetre has; 1 where the unit isn't known."""
        return 1 / MILLIMETRES.get(self.length_unit, 1.0)

    @property
    def n_samples(self) -> int:
        """Number of voxels."""
        return math.prod(self.counts)

    # --- place ------------------------------------------------------------------------------

    def to_world(self, indices: ArrayLike) -> Floats:
        """Return world positions of grid positions.

        Parameters
        ----------
        indices : (..., 3) array_like
            Voxel coordinates in the order x, y, z; fractions lie between voxels.

        Returns
        -------
        (..., 3) ndarray
        """
        return self.origin + (np.asarray(indices, np.float64) * self.spacing) @ self.direction.T

    @property
    def identity(self) -> str:
        """Counts along x, y and z."""
        nz, ny, nx = self.counts
        return f"{nx} x {ny} x {nz} voxels"

    @cached_property
    def outline(self) -> Floats:
        """(8, 3) world corners of the box of voxel centres: what a view has to show."""
        nz, ny, nx = self.counts
        corners = np.array(np.meshgrid((0, nx - 1), (0, ny - 1), (0, nz - 1))).reshape(3, 8).T
        return frozen(self.to_world(corners))

    @cached_property
    def centre(self) -> Floats:
        """(3,) middle of the bounding box."""
        low, high = self.outline.min(axis=0), self.outline.max(axis=0)
        return frozen(low / 2 + high / 2)

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the box of voxel centres, in world units."""
        return float(np.linalg.norm((np.array(self.counts[::-1]) - 1) * self.spacing))

    def recentred(self, points: Floats) -> Floats:
        """Return world positions (…, 3) relative to the grid's centre, in its diagonals."""
        moved: Floats = (points - self.centre) / (self.diagonal or 1.0)
        return moved

    @property
    def edge_length(self) -> float:
        """The largest spacing, in world units: what is finer along it are steps between slices."""
        return float(self.spacing.max())
