"""Terrain that a ``DataArray`` of xarray holds, with rioxarray's coordinates, and back again.

Nothing here imports xarray: whoever has a DataArray has it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.crs import units_of
from meshdepict.io.height_units import METRES, height_unit
from meshdepict.options import real
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.height_grids import even_transform

__all__ = ["from_data_array", "is_data_array", "like_data_array"]

_EAST = ("x", "lon", "longitude", "long", "easting", "projection_x_coordinate", "rlon")
_NORTH = ("y", "lat", "latitude", "northing", "projection_y_coordinate", "rlat")
_ANGLES = ("lon", "long", "longitude", "lat", "latitude")
_SYSTEM = ("crs_wkt", "spatial_ref", "esri_pe_string")
_DEGREES = ("degrees_north", "degrees_east", "degree_north", "degree_east", "degrees", "degree",
            "degrees_n", "degrees_e", "deg")  # fmt: skip
_MISSING = ("_FillValue", "missing_value", "nodata", "nodatavals")


def is_data_array(shape: object) -> bool:
    """Whether something is a ``DataArray`` of xarray."""
    home = type(shape).__module__.partition(".")[0]
    return type(shape).__name__ == "DataArray" and home == "xarray"


def from_data_array(array: Any) -> HeightField:
    """Return the terrain that a ``DataArray`` holds.

    Heights are its values; those that are NaN or its ``_FillValue`` are missing. Rows may run north
    or south. Coordinates are degrees where its reference system, as rioxarray has it, or their own
    names and units say so.

    Parameters
    ----------
    array : xarray.DataArray
        With two dimensions, and others of length 1.

    Raises
    ------
    MeshdepictError
        For several bands, coordinates that are not evenly spaced, and what `HeightField` refuses.
    """
    flat = _flat(array)
    z = np.asarray(flat.values)
    if z.dtype.kind not in "biuf":
        raise MeshdepictError(f"the DataArray holds {z.dtype}, no heights")
    there = np.isfinite(z)
    for name in _MISSING:
        said = array.attrs.get(name, ())
        for value in said if isinstance(said, (tuple, list, np.ndarray)) else (said,):
            if (number := real(value)) is not None:
                there &= z != z.dtype.type(number)
    crs = _system(array)
    try:
        units = units_of(crs)
    except MeshdepictError as error:  # "has …": the file is its subject
        raise MeshdepictError(f"the DataArray {error}") from None
    degrees = units.degrees or (not crs and _says_degrees(flat))
    heights = z if z.dtype.kind == "f" else z.astype(np.float64)
    up = METRES.get(height_unit(str(array.attrs.get("units", "")))) or units.vertical or 1.0
    scale = (real(array.attrs.get("scale_factor")) or 1.0) * up
    offset = (real(array.attrs.get("add_offset")) or 0.0) * up
    if (scale, offset) != (1.0, 0.0):
        heights = heights.astype(np.float64) * scale + offset
    found = {"name": str(array.name)} if array.name is not None else {}
    return HeightField(
        np.where(there, heights, heights.dtype.type(0)), valid=there, transform=_transform(flat),
        crs=crs, degrees=degrees, unit=1.0 if degrees else units.unit, attributes=found,
    )  # fmt: skip


def like_data_array(
    array: Any, field: HeightField, values: NDArray[Any], attributes: dict[str, Any]
) -> Any:
    """Return values of a field's samples, (n,) or (n, 3), as a DataArray at the same coordinates.

    NaN where no height is known. Colours have a last dimension "band" with 1, 2 and 3, as
    rioxarray counts them.
    """
    flat = _flat(array)
    raster = field.image(np.asarray(values, np.float32), background=np.nan)
    dims, coords = flat.dims, dict(flat.coords)
    if raster.ndim == 3:
        dims, coords = (*dims, "band"), {**coords, "band": [1, 2, 3]}
    found = type(array)(raster, dims=dims, coords=coords, attrs=attributes)
    mapping = array.encoding.get("grid_mapping") or array.attrs.get("grid_mapping")
    if mapping is not None:
        found.encoding["grid_mapping"] = mapping
    return found


def _flat(array: Any) -> Any:
    """Return rows and columns of a DataArray, in this order, without its other dimensions."""
    for name in array.dims:
        if array.sizes[name] == 0:
            raise MeshdepictError(f"the DataArray is empty: {name} has no values")
    east, north = _axis(array, _EAST, "X", "x_dim"), _axis(array, _NORTH, "Y", "y_dim")
    if (east is None or north is None or east == north) and array.ndim >= 2:
        north, east = array.dims[-2:]
    if east is None or north is None or east == north:
        raise MeshdepictError(
            f"the DataArray has the dimensions {', '.join(map(str, array.dims)) or 'none'}, and "
            "terrain has rows and columns, y and x"
        )
    others = [name for name in array.dims if name not in (east, north)]
    for name in others:
        if array.sizes[name] > 1:
            raise MeshdepictError(
                f"the DataArray has {array.sizes[name]} of {name}: take one, "
                f".isel({name}=0) for instance"
            )
    return array.isel(dict.fromkeys(others, 0), drop=True).transpose(north, east)


def _axis(array: Any, names: tuple[str, ...], letter: str, spatial: str) -> Any:
    """Return the dimension that runs east or north, by what rioxarray, CF or its name say."""
    try:
        return getattr(array.rio, spatial)
    except Exception:
        pass
    for name in array.dims:
        said = array.coords[name].attrs if name in array.coords else {}
        if said.get("axis") == letter or said.get("standard_name") in names:
            return name
    return next((name for name in array.dims if str(name).lower() in names), None)


def _transform(flat: Any) -> Any:
    """Return the transform of the cells: by evenly spaced coordinates, else as GDAL has it."""
    sizes = flat.sizes[flat.dims[1]], flat.sizes[flat.dims[0]]
    (x, dx), (y, dy) = (_spaced(flat, name) for name in (flat.dims[1], flat.dims[0]))
    said = _gdal(flat)
    if x is None or y is None:
        return said
    if dx is None:
        dx = said[0] if said is not None else abs(dy or 1.0)
    if dy is None:
        dy = said[4] if said is not None else -abs(dx)
    columns, rows = (start + step * np.arange(max(count, 2))
                     for start, step, count in ((x, dx, sizes[0]), (y, dy, sizes[1])))  # fmt: skip
    return even_transform(*np.meshgrid(columns, rows))


def _spaced(flat: Any, name: Any) -> tuple[float | None, float | None]:
    """Return the first coordinate of a dimension and the step; None where there is none."""
    if name not in flat.coords:
        return None, None
    values = np.asarray(flat.coords[name].values)
    exact = values.dtype.kind != "f"
    if values.dtype.kind not in "iuf" or not np.isfinite(values).all():
        raise MeshdepictError(f"{name} of the DataArray holds no coordinates in numbers")
    rounding = 0.0 if exact else 4 * float(np.finfo(values.dtype).eps)
    values = values.astype(np.float64)
    if len(values) == 1:
        return float(values[0]), None
    step = (values[-1] - values[0]) / (len(values) - 1)
    off = np.abs(values - (values[0] + step * np.arange(len(values)))).max()
    if not step or off > 1e-3 * abs(step) + rounding * np.abs(values).max():
        raise MeshdepictError(
            f"{name} of the DataArray is not evenly spaced, as cells of terrain are: resample it "
            "first, .interp for instance"
        )
    return float(values[0]), float(step)


def _gdal(array: Any) -> tuple[float, ...] | None:
    """Return the transform that the reference system's coordinate holds, as GDAL spells it."""
    for name in array.coords:
        said = str(array.coords[name].attrs.get("GeoTransform", "")).split()
        try:
            c, a, b, f, d, e = (float(word) for word in said)
        except ValueError:
            continue
        return a, b, c, d, e, f
    return None


def _system(array: Any) -> str:
    """Return the reference system as text: rioxarray's coordinate, else what it says itself."""
    for name in array.coords:
        for word in _SYSTEM:
            text = array.coords[name].attrs.get(word)
            if isinstance(text, str) and text:
                return text
    try:
        return str(array.rio.crs.to_wkt())
    except Exception:
        return ""


def _says_degrees(flat: Any) -> bool:
    """Whether names or units of coordinates say that they are longitude and latitude."""
    return any(
        str(flat.coords[name].attrs.get("units", "")).lower() in _DEGREES
        or str(name).lower() in _ANGLES
        for name in flat.dims
        if name in flat.coords
    )
