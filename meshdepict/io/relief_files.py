"""Writing relief: a picture, or values, on the grid of a terrain, window by window.

GeoTIFF (cloud-optimised, with the extra ``[dem]``), or PNG and JPEG with a world file beside.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError, printable
from meshdepict.files.mark import MARK, SOFTWARE
from meshdepict.io.height_source import WORDS
from meshdepict.io.relief_layout import KINDS, ReliefLayout
from meshdepict.io.terrain import Terrain

if TYPE_CHECKING:
    from meshdepict.shapes.height_field import HeightField

__all__ = ["RELIEFS", "ReliefWriter", "check_relief", "relief_writer"]

RELIEFS = (".tif", ".tiff", ".png", ".jpg", ".jpeg")
"""Suffixes of what `relief_writer` writes."""


class ReliefWriter:
    """A file of relief under way: windows of it are written, each once, in any order."""

    def __init__(self, path: Path, layout: ReliefLayout, sink: Any) -> None:
        self._path, self._layout, self._sink = path, layout, sink

    def write(
        self, rows: slice, cols: slice, values: ArrayLike, valid: ArrayLike | None = None
    ) -> None:
        """Write a window.

        Parameters
        ----------
        rows, cols : slice
            Without steps; a GeoTIFF takes windows of whole tiles of 512 fastest.
        values : (rows, cols) or (rows, cols, 3) array_like
            sRGB as uint8, or numbers.
        valid : (rows, cols) array_like of bool, optional
            Where there is something; the rest becomes transparent, or NaN.

        Raises
        ------
        MeshdepictError
            For a window beyond the grid, values of another shape or type, and every failure to
            write.
        """
        layout = self._layout
        down, across = rows.indices(layout.rows), cols.indices(layout.cols)
        shape = (down[1] - down[0], across[1] - across[0])
        array = np.asarray(values)
        wanted = shape if layout.bands == 1 else (*shape, layout.bands)
        fits = array.dtype == np.uint8 or (layout.kind == "values" and array.dtype.kind == "f")
        if min(shape) < 1 or array.shape != wanted or not fits or down[2] * across[2] != 1:
            raise MeshdepictError(
                f"{self._path}: a window of rows {rows} and columns {cols} takes {layout.dtype} of "
                f"shape {wanted}, not {array.dtype} of shape {array.shape}"
            )
        there = np.ones(shape, bool) if valid is None else np.asarray(valid, bool)
        if there.shape != shape:
            raise MeshdepictError(
                f"{self._path}: valid must have the window's shape {shape}, not {there.shape}"
            )
        self._sink(down[0], across[0], _planes(array, there, layout))


def _planes(array: NDArray[Any], there: NDArray[np.bool_], layout: ReliefLayout) -> NDArray[Any]:
    """Return bands first: values with NaN, or colours and how opaque they are."""
    if layout.kind == "values":
        return np.where(there, array, np.nan).astype(np.float32)[None]
    colours = array.reshape(*array.shape[:2], layout.bands).transpose(2, 0, 1)
    opaque = np.where(there, np.uint8(255), np.uint8(0))[None]
    return np.concatenate([np.where(there, colours, np.uint8(0)), opaque])


def check_relief(path: str | os.PathLike[str], *, shape: tuple[int, int], kind: str) -> None:
    """Refuse what a file of this name can't hold, before any work is done.

    Parameters
    ----------
    path : path
    shape : (rows, cols)
    kind : "gray", "color" or "values"

    Raises
    ------
    MeshdepictError
        For another suffix, values in a picture, more pixels than the format or memory holds, and
        a GeoTIFF without rasterio.
    """
    suffix = Path(path).suffix.lower()
    if kind not in KINDS:
        raise MeshdepictError(f"kind={kind!r} is not one of {', '.join(KINDS)}")
    if suffix not in RELIEFS:
        raise MeshdepictError(
            f"{path}: relief is written as GeoTIFF, PNG or JPEG; end the name with .tif, .png or "
            ".jpg"
        )
    if suffix in (".tif", ".tiff"):
        from meshdepict.io.relief_tiff import check_tiff

        check_tiff(path)
    else:
        from meshdepict.io.relief_pictures import check_relief_picture

        check_relief_picture(path, shape, kind, KINDS[kind] + 1)


@contextmanager
def relief_writer(
    path: str | os.PathLike[str], *, like: Terrain | HeightField, kind: str = "gray",
    provenance: Mapping[str, str] | None = None,
) -> Iterator[ReliefWriter]:  # fmt: skip
    """Give what writes relief on a terrain's grid, which takes the name ``path`` if all went well.

    The file is written beside and renamed: any exception leaves an earlier one whole, and nothing
    else. A GeoTIFF is written in tiles, then copied into cloud-optimised order with overviews; that
    takes the memory of GDAL's cache (256 MB at most), and twice the disk. Pictures are held in
    memory.

    Parameters
    ----------
    path : str or path-like
        Ends in .tif, .png or .jpg.
    like : Terrain or HeightField
        Whose grid, place and coordinate reference system it has.
    kind : "gray", "color" or "values"
        8-bit gray or RGB with an alpha band that says where there is something (JPEG: white where
        there is nothing), or values as float32 with NaN there, as GeoTIFF only.
    provenance : mapping of str, optional
        Facts, written into the file.

    Yields
    ------
    ReliefWriter

    Raises
    ------
    MeshdepictError
        As `check_relief`, and for every failure to write: one sentence.
    """
    rows, cols = like.shape if isinstance(like, Terrain) else like.z.shape
    check_relief(path, shape=(rows, cols), kind=kind)
    facts = {"version": SOFTWARE.removeprefix(MARK)} | dict(provenance or {})
    layout = ReliefLayout(
        rows, cols, like.transform, like.crs, kind,
        str(like.attributes.get("point_or_area", "Area")),
        tuple(f"{MARK}{key}: {printable(str(text))}" for key, text in facts.items()),
        tuple(
            (key.removeprefix(WORDS), str(text))
            for key, text in like.attributes.items()
            if key.startswith(WORDS)
        ),
    )  # fmt: skip
    if Path(path).suffix.lower() in (".tif", ".tiff"):
        from meshdepict.io.relief_tiff import written_tiff as written
    else:
        from meshdepict.io.relief_pictures import written_picture as written
    with written(Path(path), layout) as sink:
        yield ReliefWriter(Path(path), layout, sink)
