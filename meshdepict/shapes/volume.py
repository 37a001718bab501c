"""Volume: a grid of CT numbers with its place in the world, validated once, never copied.

World space is the patient's: x to the left, y to the back, z to the head (LPS), as in DICOM and
SimpleITK. Files of other conventions (NIfTI's RAS) are turned when they are read.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from meshdepict.color.hounsfield import check_rescale
from meshdepict.errors import MeshdepictError
from meshdepict.scene.vectors import frozen
from meshdepict.shapes.fingerprint import fingerprint
from meshdepict.shapes.summary import volume_rows
from meshdepict.shapes.table import html_table
from meshdepict.voxels.grid import Grid
from meshdepict.voxels.volume_input import (
    as_list,
    checked_values,
    fitting_integer,
)

__all__ = ["Volume"]

_LEAST = 1e-300  # by which values have to differ, so that shares of their range are numbers
_ROUNDING = 1e-14  # of the values: what differs by less differs by rounding
_SLAB = 1 << 22  # voxels looked at in one go, so that a file mapped into memory stays on the disk


class Volume(Grid):
    """A grid of scalar values, for instance CT numbers.

    Parameters
    ----------
    values : (nz, ny, nx) array_like
        Integers or floats, x fastest in memory. An array of the right layout, also a memory-mapped
        one, is used as it is and must not be changed afterwards.
    spacing : (3,) array_like
        Distances between voxels along the grid's x, y and z, in world units.
    origin : (3,) array_like
        World position of the centre of voxel ``values[0, 0, 0]``.
    direction : (3, 3) array_like
        Columns: world directions of the grid's axes x, y, z, orthonormal (SimpleITK's convention).
        They may be left-handed, as in files with a flipped axis: every way from grid to world goes
        through them, so what is left in the patient stays left.
    hounsfield : bool
        Whether the values are Hounsfield units.
    attributes : mapping, optional
        What else is known, such as the series' description.
    length_unit : str
        What a world unit is, "mm" or "µm" for instance; "" where nobody says.

    Attributes
    ----------
    values : (nz, ny, nx) ndarray, read-only, of the given type
    spacing, origin : (3,) ndarray of float64
    direction : (3, 3) ndarray of float64
    hounsfield : bool
    attributes : mapping
    length_unit : str

    Raises
    ------
    MeshdepictError
        For other shapes and types, an empty, one-slice or constant volume, values that are NaN,
        infinite or but for rounding the same, a spacing that is not positive, a place
        farther than 1e15 sizes, and directions that are not orthonormal.
    """

    def __init__(
        self,
        values: ArrayLike,
        *,
        spacing: ArrayLike = (1.0, 1.0, 1.0),
        origin: ArrayLike = (0.0, 0.0, 0.0),
        direction: ArrayLike | None = None,
        hounsfield: bool = False,
        attributes: Mapping[str, Any] | None = None,
        length_unit: str = "",
    ) -> None:
        self.values = frozen(checked_values(values).view())
        if attributes is not None and not isinstance(attributes, Mapping):
            raise MeshdepictError(f"attributes={attributes!r} is no mapping of names to values")
        super().__init__(
            self.values.shape, spacing=spacing, origin=origin, direction=direction,
            hounsfield=hounsfield, length_unit=length_unit,
        )  # fmt: skip
        self.attributes = dict(attributes or {})
        self._check_contents()

    @classmethod
    def from_pyvista(cls, image: object, *, hounsfield: bool | None = None) -> Volume:
        """Take the active or only scalars of a ``pyvista.ImageData``.

        Values of cells stand at the cells' centres. ``hounsfield=None`` believes the field "unit"
        that `to_pyvista` writes.

        Raises
        ------
        MeshdepictError
            For anything but ``ImageData``, for none or several arrays, and as `Volume`.
        """
        from meshdepict.shapes.exchange import image_contents

        values, place, unit = image_contents(image)
        return cls(values, **place, hounsfield=unit == "HU" if hounsfield is None else hounsfield)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.ImageData`` with the point data "values", which share the memory."""
        from meshdepict.shapes.exchange import image_of

        return image_of(self.values, self)

    def __repr__(self) -> str:
        """Return size, type, spacing and unit."""
        nz, ny, nx = self.values.shape
        kind, spacing = self.values.dtype, as_list(self.spacing)
        return f"<Volume: {nx} x {ny} x {nz} {kind}, spacing {spacing}, {self.unit}>"

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        return html_table([*volume_rows(self)], "Volume")

    # --- values -----------------------------------------------------------------------------

    def slabs(self) -> Iterator[tuple[slice, NDArray[Any]]]:
        """Yield ``(slices, values[slices])`` along z, a few million voxels each."""
        step = max(1, _SLAB // math.prod(self.values.shape[1:]))
        for start in range(0, len(self.values), step):
            rows = slice(start, min(start + step, len(self.values)))
            yield rows, self.values[rows]

    @cached_property
    def range(self) -> tuple[float, float]:
        """Smallest and largest value."""
        ends = [(slab.min(), slab.max()) for _, slab in self.slabs()]
        return float(min(low for low, _ in ends)), float(max(high for _, high in ends))

    def rescaled(self, slope: float, intercept: float) -> Volume:
        """Return the volume in Hounsfield units, ``slope · raw + intercept``.

        Integers stay integers where slope and intercept are whole numbers, in the narrowest type
        from 16 bits on; else the values become float32. Slope 1 and intercept 0 say that the
        values are Hounsfield units already, and copy nothing.

        Raises
        ------
        MeshdepictError
            For a slope that is not positive, an intercept that is not finite, and a volume that is
            in Hounsfield units.
        """
        if self.hounsfield:
            raise MeshdepictError("the volume is in Hounsfield units already: don't rescale it")
        check_rescale(slope, intercept)
        values = self.values
        if (slope, intercept) != (1, 0):
            whole = float(slope).is_integer() and float(intercept).is_integer()
            kind: DTypeLike = np.float32
            if whole and values.dtype.kind in "iu":
                kind = fitting_integer(*(slope * end + intercept for end in self.range))
            values = np.empty(self.values.shape, kind)
            for rows, slab in self.slabs():
                values[rows] = slab * np.float64(slope) + intercept
        return Volume(
            values,
            spacing=self.spacing,
            origin=self.origin,
            direction=self.direction,
            hounsfield=True,
            attributes=self.attributes,
            length_unit=self.length_unit,
        )

    def cropped(
        self,
        *,
        x: tuple[float, float] = (0.0, 1.0),
        y: tuple[float, float] = (0.0, 1.0),
        z: tuple[float, float] = (0.0, 1.0),
    ) -> Volume:
        """Return a part of the grid, at the same place in the world; nothing is copied.

        Parameters
        ----------
        x, y, z : (float, float)
            Shares of the grid's own axes, from 0 to 1.

        Raises
        ------
        MeshdepictError
            For other shares, and where less than two slices are left.
        """
        spans = []
        for name, span, count in zip("xyz", (x, y, z), self.values.shape[::-1], strict=True):
            if not 0 <= span[0] < span[1] <= 1:
                raise MeshdepictError(f"{name}={span!r} are not two shares of an axis, 0 … 1")
            ends = (round(share * (count - 1)) for share in span)
            spans.append(slice(next(ends), next(ends) + 1))
        if spans == [slice(0, count) for count in self.values.shape[::-1]]:
            return self
        return Volume(
            self.values[tuple(spans[::-1])],
            spacing=self.spacing,
            origin=self.to_world([span.start for span in spans]),
            direction=self.direction,
            hounsfield=self.hounsfield,
            attributes=self.attributes,
            length_unit=self.length_unit,
        )

    def _check_contents(self) -> None:
        """Refuse NaN and constants, reading no more of the values than it takes."""
        first = self.values[0, 0, 0]
        floats, varied, bad, where = self.values.dtype.kind == "f", False, 0, (0, 0, 0)
        low = high = float(first)
        for rows, slab in self.slabs():
            varied = varied or bool((slab != first).any())
            if varied and not floats:
                return
            ends = float(slab.min()), float(slab.max())  # NaN where any is
            low, high = min(low, ends[0]), max(high, ends[1])
            if floats and not np.isfinite(ends).all():
                wrong = ~np.isfinite(slab)
                if not bad:
                    z, y, x = np.unravel_index(int(wrong.argmax()), wrong.shape)
                    where = (int(x), int(y), int(z) + rows.start)
                bad += int(np.count_nonzero(wrong))
        if bad:
            raise MeshdepictError(
                f"the volume has {bad:,} values that are NaN or infinite, the first at voxel "
                f"(x, y, z) = {where}: replace them by the value of air"
            )
        if not varied:
            raise MeshdepictError(f"the volume is constant: every voxel is {first}")
        half = high / 2 - low / 2
        if floats and half < max(_LEAST, _ROUNDING * max(-low, high)):
            raise MeshdepictError(
                f"the volume is as good as constant: its values differ by {2 * half:g} at most, "
                f"about {low:g}"
            )

    @cached_property
    def identity(self) -> str:
        """Size, and the fingerprint of the values and their place in the world."""
        slabs = (slab for _, slab in self.slabs())
        digest = fingerprint(self.spacing, self.origin, self.direction, *slabs)
        return f"{super().identity} sha256 {digest}"
