"""What a raster says of itself and can't mean: degrees that nobody called so, heights of -9999."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.height_source import INFINITE, Cells, HeightSource

__all__ = ["doubts"]

_LOOK = 128  # rows and columns at the corners and in the middle, which are looked at
_STEEP = 20.0  # metres of height in a metre: no terrain, but degrees that nobody called so
_WEB_MERCATOR = ("Pseudo-Mercator", "Pseudo_Mercator", "Mercator_Auxiliary_Sphere")
_NO_HEIGHTS = (-9999, -32768, -32767, -99999)  # what programs put where there is none


def doubts(source: HeightSource) -> list[str]:
    """Return notes on what was assumed of a raster's place and of its numbers.

    Raises
    ------
    MeshdepictError
        For degrees without a latitude, and for coordinates without a system that can only be
        degrees: a clause whose subject is the file.
    """
    notes = []
    if source.degrees:
        low, high = _latitudes(source)
        if not (low >= -90 and high <= 90):
            raise MeshdepictError(
                f"has latitudes from {low:g} to {high:g} by its reference system, which is in "
                "degrees: state the system that its coordinates are in (gdal_edit -a_srs)"
            )
        notes.append("its degrees are scaled by latitude, row by row")
    if any(name in source.crs for name in _WEB_MERCATOR):
        notes.append(
            "its metres are Web Mercator's, longer than those on the ground the farther it lies "
            "from the equator: slopes come out too gentle unless it is warped (gdalwarp)"
        )
    bare = not source.crs and source.is_placed and not source.degrees
    if not bare and "nodata" in source.attributes:
        return notes
    parts = list(_parts(source))
    if bare:
        _refuse_hidden_degrees(source, parts)
        notes.append("it has no coordinate reference system: its cells count as metres")
    if any(part.infinite for part in parts):
        notes.append(INFINITE)
    if "nodata" not in source.attributes:
        found = [n for n in _NO_HEIGHTS if any((z[valid] == n).any() for z, valid, _ in parts)]
        notes += [
            f"{value} counts as a height: if it means that there is none, say so in the file "
            f"(gdal_edit -a_nodata {value}; NaN in an array)"
            for value in found
        ]
    return notes


def _parts(source: HeightSource) -> Iterator[Cells]:
    """Yield the cells in the corners and in the middle."""
    rows, cols = ((n, min(n, _LOOK)) for n in (source.rows, source.cols))
    places = {(i, j) for i in (0.0, 1.0) for j in (0.0, 1.0)} | {(0.5, 0.5)}
    spans = {
        tuple(
            (start := int(share * (n - side)), start + side)
            for share, (n, side) in zip(place, (rows, cols), strict=True)
        )
        for place in places
    }
    for down, across in sorted(spans):
        yield source.read(slice(*down), slice(*across))


def _refuse_hidden_degrees(source: HeightSource, parts: list[Cells]) -> None:
    """Refuse a grid whose heights make sense in degrees only.

    Within 360 x 180 degrees there is also a tablet under a scanner. But where steps of a
    thousandth are degrees, neighbours differ by metres.
    """
    a, b, c, d, e, f = source.transform
    ends = [(col, row) for col in (0, source.cols) for row in (0, source.rows)]
    x, y = [a * i + b * j + c for i, j in ends], [d * i + e * j + f for i, j in ends]
    fits = min(x) >= -360 and max(x) <= 360 and min(y) >= -91 and max(y) <= 91
    step = abs(a * e - b * d) ** 0.5
    found = np.concatenate([steps for part in parts for steps in _rises(*part[:2])])
    if fits and step <= 1 and len(found) and found.mean() > _STEEP * step:
        raise MeshdepictError(
            "has no coordinate reference system, and its coordinates look like degrees: state "
            "the system first (gdal_edit -a_srs EPSG:4326, or a .prj beside the file)"
        )


def _rises(z: NDArray[np.floating], valid: NDArray[np.bool_]) -> Iterator[NDArray[np.float64]]:
    """Yield how much neighbours differ in height, down and across."""
    heights = z.astype(np.float64)
    yield np.abs(np.diff(heights, axis=0))[valid[1:] & valid[:-1]]
    yield np.abs(np.diff(heights, axis=1))[valid[:, 1:] & valid[:, :-1]]


def _latitudes(source: HeightSource) -> tuple[float, float]:
    """Return the smallest and the largest latitude of a cell's centre."""
    _, _, _, d, e, f = source.transform
    ends = [(i, j) for i in (0, source.cols - 1) for j in (0, source.rows - 1)]
    centres = [d * (i + 0.5) + e * (j + 0.5) + f for i, j in ends]
    return min(centres), max(centres)
