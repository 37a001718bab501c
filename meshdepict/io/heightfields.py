"""Reading terrain: GeoTIFF and other rasters, USGS and ESRI models in ASCII, NumPy arrays."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict.io.folders import RASTERS
from meshdepict.io.height_formats import heights_format, is_mesh
from meshdepict.io.terrain import Paths, Terrain

if TYPE_CHECKING:
    from meshdepict.shapes.height_field import HeightField

__all__ = ["is_heightfield_path", "read_heightfield"]


def is_heightfield_path(path: str | os.PathLike[str]) -> bool:
    """Whether `read_heightfield` is to read this: by its content, else a suffix that rasters have.

    A TIFF of many pages without a place on a map is none, nor is an array of three dimensions:
    they are volumes.
    """
    path = Path(path)
    if heights_format(path):
        return True
    return path.is_file() and path.suffix.lower() in RASTERS and not is_mesh(path)


def read_heightfield(path: Paths, *, band: int = 1, unit: str | None = None) -> HeightField:
    """Read a terrain with its place, its coordinate reference system, and what has no height.

    Heights become metres: the file's scale, offset and unit are applied. Cells in degrees are
    scaled by their latitude; cells in feet count as such.

    Parameters
    ----------
    path : str, path-like or sequence of them
        A GeoTIFF, VRT, or any other raster that rasterio opens (the extra ``[dem]``); without it
        USGS ``.dem``, ESRI ASCII grids (``.asc``) and ``.npy``, an array of rows from the north in
        cells of a metre. Several are tiles of one grid; where they overlap, the first that holds a
        height wins.
    band : int
        Which of a raster's bands holds the heights, from 1.
    unit : str, optional
        What the heights are in, "m", "ft" or "us-ft" for instance, whatever the file says.

    Returns
    -------
    HeightField

    Raises
    ------
    MeshdepictError
        For a file that is missing, damaged, a picture, in degrees without a latitude, or that has
        no heights, for tiles that don't fit each other, and where rasterio is needed but not
        installed: one sentence that begins with the file's name.
    """
    with Terrain(path, band=band, unit=unit) as terrain:
        terrain.check_whole()
        return terrain.window()
