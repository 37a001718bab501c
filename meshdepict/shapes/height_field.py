"""HeightField: heights on the cells of a raster, with its place on the map; a shape like others.

Positions are in metres: x to the east, y to the north, z up. What a file has in feet or degrees is
turned into them when it is read.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import real_array
from meshdepict.heights.cells import check_heights
from meshdepict.options import real
from meshdepict.scene.vectors import frozen
from meshdepict.shapes.fingerprint import fingerprint
from meshdepict.shapes.raster_extent import RasterBox
from meshdepict.shapes.raster_place import RasterPlace
from meshdepict.shapes.summary import height_rows
from meshdepict.shapes.table import html_table

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["HeightField", "window_of"]

Floats = NDArray[np.float64]


class HeightField(RasterBox):
    """Samples at the cells of a raster that hold a height.

    Parameters
    ----------
    z : (rows, columns) array_like
        Heights in metres, the first row in the north unless the transform says otherwise. An array
        of float32 or float64 is used as it is and must not be changed afterwards.
    transform : (6,) array_like, optional
        a, b, c, d, e, f as rasterio has them: x = a·column + b·row + c, y = d·column + e·row + f at
        the corners of cells. Cells of one metre unless given.
    crs : str
        The coordinate reference system, best as WKT; "" where nobody says.
    degrees : bool
        Whether the transform is in degrees of longitude and latitude.
    unit : float
        Metres in a unit of the transform; of degrees it is left out.
    valid : (rows, columns) array_like of bool, optional
        Cells that hold a height; those that are finite, and that no mask hides, unless given.
    attributes : mapping, optional
        What else is known: band, unit of heights, source.

    Attributes
    ----------
    z : (rows, columns) ndarray of float32 or float64, read-only
        0 where no height is known.
    valid : (rows, columns) ndarray of bool, read-only
    transform : six numbers
    crs, degrees, unit, attributes
    z_factor : float
        Times what these heights are those of the ground; see `raised`.
    before : HeightField or None
        The ground as it was before, where it was raised.
    steps : (rows or 1, 2, 2) ndarray of float64
        Metres [east, north] per step [to the next column, to the next row]; in degrees row by row.

    Raises
    ------
    MeshdepictError
        For what has not rows and columns of numbers, no valid cell, sheared or empty cells, degrees
        that are none, infinite heights that are said to be valid, and heights beyond 1e32.
    """

    def __init__(
        self,
        z: ArrayLike,
        *,
        transform: ArrayLike | None = None,
        crs: str = "",
        degrees: bool = False,
        unit: float = 1.0,
        valid: ArrayLike | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        heights = _numbers(z)
        known = np.isfinite(heights)
        if valid is not None:
            known = _mask(valid, heights, known)
        if not known.any():
            raise MeshdepictError(f"none of {known.size:,} cells holds a height")
        if not known.all():
            heights = np.where(known, heights, heights.dtype.type(0))
        self.z, self.valid = frozen(heights.view()), frozen(known)
        rows, columns = self.z.shape
        usual = (1.0, 0.0, 0.0, 0.0, -1.0, float(rows))
        super().__init__(
            rows, columns, usual if transform is None else transform,
            crs=crs, degrees=degrees, unit=unit,
        )  # fmt: skip
        if attributes is not None and not isinstance(attributes, Mapping):
            raise MeshdepictError(f"attributes={attributes!r} is no mapping of names to values")
        check_heights(self.z, self.transform, degrees=self.degrees, unit=self.unit)
        self.attributes = dict(attributes or {})
        self.z_factor = 1.0
        self.before: HeightField | None = None

    # --- the raster -------------------------------------------------------------------------

    @cached_property
    def whole(self) -> bool:
        """Whether every cell holds a height."""
        return bool(self.valid.all())

    def image(self, values: ArrayLike, *, background: ArrayLike = 0) -> NDArray[Any]:
        """Return values of the samples, (n,) or (n, k), as a raster (rows, columns[, k]).

        Raises
        ------
        MeshdepictError
            For another number of values.
        """
        values = np.asarray(values)
        if values.ndim not in (1, 2) or len(values) != self.count:
            raise MeshdepictError(
                f"values of shape {values.shape} are not one for each of {self.count:,} cells that "
                "hold a height"
            )
        if self.whole:
            return values.reshape(*self.z.shape, *values.shape[1:])
        raster = np.empty((*self.z.shape, *values.shape[1:]), values.dtype)
        raster[...] = background
        raster[self.valid] = values
        return raster

    def sample(self, raster: ArrayLike) -> NDArray[Any]:
        """Return what a raster (rows, columns, …) has at the samples, (n, …).

        Raises
        ------
        MeshdepictError
            For a raster of another size.
        """
        raster = np.asarray(raster)
        if raster.shape[:2] != self.z.shape:
            raise MeshdepictError(
                f"a raster of shape {raster.shape} is not one of {self.z.shape} cells"
            )
        if self.whole:
            return raster.reshape(-1, *raster.shape[2:])
        return raster[self.valid]

    @cached_property
    def count(self) -> int:
        """Number of samples: of cells that hold a height."""
        return int(np.count_nonzero(self.valid))

    @cached_property
    def index(self) -> NDArray[np.int32]:
        """(rows + 2, columns + 2): the sample at a cell, −1 if none, −2 beyond the raster."""
        rows, columns = self.z.shape
        index = np.full((rows + 2, columns + 2), -2, np.int32)
        index[1:-1, 1:-1] = -1
        index[1:-1, 1:-1][self.valid] = np.arange(self.count, dtype=np.int32)
        return frozen(index)

    def window(self, rows: slice, columns: slice) -> HeightField:
        """Return a part of the raster at the same place on the map.

        Raises
        ------
        MeshdepictError
            Where no cell of it holds a height.
        """
        top, left = rows.indices(self.z.shape[0])[0], columns.indices(self.z.shape[1])[0]
        z, valid = self.z[rows, columns], self.valid[rows, columns]
        part = window_of(self, top, left, z, valid, attributes=self.attributes)
        part.z_factor = self.z_factor
        part.before = None if self.before is None else self.before.window(rows, columns)
        return part

    def raised(self, factor: float) -> HeightField:
        """Return the same ground with its heights multiplied: cartographers' z factor.

        One that was raised `before` can be had from there.

        Raises
        ------
        MeshdepictError
            For a factor that is no positive number, and heights that become too great for cells.
        """
        times = real(factor)
        if times is None or not 0 < times <= 1e6:
            raise MeshdepictError(f"z_factor={factor!r} is not a number above 0 and up to 1e6")
        if times == 1:
            return self
        heights = self.z * self.z.dtype.type(times)
        found = window_of(self, 0, 0, heights, self.valid, attributes=self.attributes)
        found.z_factor, found.before = self.z_factor * times, self.before or self
        return found

    def __repr__(self) -> str:
        """Return size and spacing."""
        columns, rows = self.size
        along, down = self.spacing
        return f"<HeightField: {columns} x {rows} cells of {along:.6g} x {down:.6g} m>"

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        return html_table([*height_rows(self)], "HeightField")

    # --- what every kind of shape has -------------------------------------------------------

    @cached_property
    def points(self) -> Floats:
        """(n, 3) positions of the samples in metres, row by row: east, north, up."""
        rows, columns = np.nonzero(self.valid)
        east, north = self.place(rows.astype(np.float64), columns.astype(np.float64))
        return frozen(np.stack([east, north, self.z[self.valid].astype(np.float64)], axis=1))

    def _filled(self) -> tuple[Floats, Floats, float, float]:
        rows = np.flatnonzero(self.valid.any(axis=1)).astype(np.float64)
        columns = np.flatnonzero(self.valid.any(axis=0)).astype(np.float64)
        z = self.z if self.whole else self.z[self.valid]
        return rows, columns, float(z.min()), float(z.max())

    @cached_property
    def identity(self) -> str:
        """Size, and the fingerprint of heights, valid cells and their place."""
        columns, rows = self.size
        digest = fingerprint(np.array(self.transform), self.z, self.valid)
        return f"{columns} x {rows} cells sha256 {digest}"

    @cached_property
    def mesh(self) -> Mesh:
        """The ground as a mesh: a vertex for each sample, in order, two triangles between four.

        Raises
        ------
        MeshdepictError
            Where nowhere three neighbours hold a height.
        """
        from meshdepict.shapes.ground import ground_mesh

        mirrored = bool(np.linalg.det(self.steps[0]) > 0)
        return ground_mesh(
            self.points, self.index[1:-1, 1:-1], mirrored=mirrored, length_unit=self.length_unit
        )


def window_of(
    place: RasterPlace,
    row: int,
    column: int,
    z: NDArray[Any],
    valid: NDArray[np.bool_],
    *,
    attributes: Mapping[str, Any] | None = None,
) -> HeightField:
    """Return a window of a raster that begins at a cell, in that raster's very steps.

    Raises
    ------
    MeshdepictError
        Where no cell of it holds a height.
    """
    field = HeightField(
        z, transform=place.moved(row, column), crs=place.crs, degrees=place.degrees,
        unit=place.unit, valid=valid, attributes=attributes,
    )  # fmt: skip
    if len(place.steps) > 1:  # computed again they would differ in their last digit
        field.steps = place.steps[row : row + len(z)]
    return field


def _numbers(z: ArrayLike) -> NDArray[Any]:
    """Return heights as an array of floats; refuse what is none."""
    try:
        array = np.asanyarray(z)
        exact = array.dtype.kind in "iub" and array.dtype.itemsize <= 2
        proper = array.dtype.kind == "f" and array.dtype.itemsize in (4, 8)
        if not proper or isinstance(array, np.ma.MaskedArray):
            single = exact or (proper and array.dtype.itemsize == 4)
            found = real_array(array, np.float32 if single else np.float64)
            if found is None:
                raise TypeError
            array = found
        array = array.astype(array.dtype.newbyteorder("="), copy=False)
    except (TypeError, ValueError, OverflowError):
        raise MeshdepictError("heights must be real numbers in rows and columns") from None
    if array.ndim != 2 or not array.size:
        raise MeshdepictError(
            f"heights have rows and columns, not the shape {array.shape}: give one band"
        )
    return array


def _mask(valid: ArrayLike, heights: NDArray[Any], finite: NDArray[np.bool_]) -> NDArray[np.bool_]:
    try:
        mask = np.array(valid, bool)
    except (TypeError, ValueError):
        mask = np.empty(0, bool)
    if mask.shape != heights.shape:
        raise MeshdepictError(f"valid says of {heights.shape} cells whether they hold a height")
    wrong = int(np.count_nonzero(mask & ~finite))
    if wrong:
        row, column = (int(x[0]) for x in np.nonzero(mask & ~finite))
        raise MeshdepictError(
            f"{wrong:,} cells that are said to be valid are NaN or infinite, the first in row "
            f"{row}, column {column}"
        )
    return mask
