"""Which format of heights a file is in: by its content, and by its suffix where that says more."""

from __future__ import annotations

import math
import os
from pathlib import Path

from meshdepict.errors import MeshdepictError
from meshdepict.io.esri_grid import is_esri_grid, open_esri_grid
from meshdepict.io.folders import MAPS, held
from meshdepict.io.height_source import HeightSource
from meshdepict.io.source import MESHES, format_of, opened, unmarked
from meshdepict.io.tiff_pages import TIFF_MARKS, Page, scale_of, tiff_pages
from meshdepict.io.usgs_dem import is_usgs_dem, open_usgs_dem

__all__ = [
    "heights_format",
    "is_map_tiff",
    "is_mesh",
    "is_single_page",
    "is_tiff_path",
    "open_source",
]

_BEGINNING = 4096


def _is_tiff(start: bytes) -> bool:
    """Whether a file begins as TIFF does."""
    return start[:4] in TIFF_MARKS


def is_tiff_path(path: str | os.PathLike[str]) -> bool:
    """Whether a path is a TIFF's, by its name or its content."""
    path = Path(path)
    return path.suffix.lower() in (".tif", ".tiff") or (path.is_file() and _is_tiff(_start(path)))


def is_map_tiff(path: Path) -> bool:
    """Whether a TIFF says where on a map it lies, itself or by a world file beside it."""
    try:
        return _on_map(path, tiff_pages(path))
    except MeshdepictError:  # whoever reads it says what is wrong with it
        return False


def is_single_page(path: Path) -> bool:
    """Whether a TIFF holds one picture, and no stack by ImageJ's way."""
    try:
        pages = tiff_pages(path)
    except (MeshdepictError, OSError):
        return False
    return len(pages) == 1 and scale_of(pages[0]).slices <= 1


def _on_map(path: Path, pages: list[Page]) -> bool:
    beside = any(path.with_suffix(suffix).is_file() for suffix in (".tfw", ".tifw", ".wld"))
    return pages[0].on_map or (beside and len(pages) == 1)


def _is_height_tiff(path: Path) -> bool:
    """Whether a TIFF is on a map, or a single page of numbers that are no shades of gray."""
    try:
        pages = tiff_pages(path)
    except MeshdepictError:
        return False
    first = pages[0]
    single = len(pages) == 1 and scale_of(first).slices <= 1 and first.get("samples", 1) == 1
    return _on_map(path, pages) or (single and first.kind not in ("", "u1", "i1"))


def is_mesh(path: Path) -> bool:
    """Whether a file's content is a mesh's, whatever its suffix."""
    try:
        return bool(format_of("", _start(path), path.stat().st_size))
    except MeshdepictError:
        return False


def heights_format(path: Path) -> str:
    """Return "esri", "usgs", "npy" or "raster" for a file whose content tells, else "".

    A TIFF is a raster here if it says where on a map it lies, or is no stack and no picture.
    """
    if path.is_dir():
        return "raster" if (path / "hdr.adf").is_file() else ""
    if not path.is_file():
        return ""
    start = _start(path)
    if _is_tiff(start):
        return "raster" if _is_height_tiff(path) else ""
    if start.startswith(b"\x93NUMPY"):
        return "npy" if _dimensions(path) == 2 else ""
    if is_esri_grid(start):
        return "esri"
    if is_usgs_dem(start):
        return "usgs"
    return "raster" if b"<VRTDataset" in start[:1024] else ""


def open_source(path: Path, band: int, unit: str) -> HeightSource:
    """Open a file's heights; see `Terrain`.

    Raises
    ------
    MeshdepictError
        For what is none: a clause whose subject is the file.
    """
    if not path.exists():
        raise MeshdepictError("there is no such file")
    kind = heights_format(path)
    if not kind and path.is_dir() and (instead := held(path, MAPS | MESHES)):
        raise MeshdepictError(f"is a folder, not a file{instead}")
    if not kind and path.is_file() and _start(path).startswith(b"\x93NUMPY"):
        kind = "npy"
    if kind in ("esri", "usgs", "npy") and band != 1:
        raise MeshdepictError(f"has one band, so that there is no band {band}")
    if kind == "npy":
        from meshdepict.io.npy_heights import open_npy_heights

        return open_npy_heights(path, unit)
    if kind in ("esri", "usgs"):
        with opened(path) as file:
            data = unmarked(file.read())
        return open_esri_grid(path, data, unit) if kind == "esri" else open_usgs_dem(data, unit)
    if path.is_file() and path.stat().st_size == 0:
        raise MeshdepictError("is empty")
    from meshdepict.io.rasters import open_raster

    return open_raster(path, band, unit)


def _start(path: Path) -> bytes:
    """Return a file's beginning, unpacked."""
    try:
        with opened(path) as file:
            start = file.read(_BEGINNING)
    except MeshdepictError:
        return b""
    return start.removeprefix(b"\xef\xbb\xbf")


def _dimensions(path: Path) -> float:
    from meshdepict.io.npy import npy_header

    try:
        with path.open("rb") as file:
            shape, _ = npy_header(file)
    except MeshdepictError:
        return math.nan
    return len(shape)
