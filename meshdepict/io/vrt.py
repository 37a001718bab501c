"""GDAL's virtual rasters (VRT): which files they name, before GDAL opens any of them."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import inside

__all__ = ["check_vrt"]

_LARGEST = 64 << 20  # bytes: hundreds of thousands of tiles
_DEEPEST = 4  # of virtual rasters made of virtual rasters
_SOURCES = ("SimpleSource", "ComplexSource")
_BANDS = ("", "VRTSourcedRasterBand")
_PART = 1e-6  # of a cell


def check_vrt(path: Path, depth: int = 0) -> None:
    """Refuse a virtual raster that is more than tiles side by side, from files in its own folder.

    Raises
    ------
    MeshdepictError
        For files elsewhere, programs, warped and resampled tiles: a clause whose subject is the
        file.
    """
    if depth > _DEEPEST:
        raise MeshdepictError("is made of virtual rasters that are made of others, too deep")
    root = _tree(path)
    if root.tag != "VRTDataset" or root.get("subClass"):
        kind = root.get("subClass") or root.tag
        raise MeshdepictError(
            f"is a virtual raster of the kind {kind[:40]!r}, which computes its cells: save it as "
            "GeoTIFF first (gdal_translate)"
        )
    for band in root.iter("VRTRasterBand"):
        if band.get("subClass", "") not in _BANDS:
            raise MeshdepictError(
                f"has a band of the kind {str(band.get('subClass'))[:40]!r}, which computes its "
                "cells: save it as GeoTIFF first (gdal_translate)"
            )
        for source in band:
            if source.tag in _SOURCES:
                _check_source(path, source, depth)
            elif source.tag.endswith("Source"):
                raise MeshdepictError(
                    f"has a source of the kind {source.tag[:40]!r}, which computes its cells: save "
                    "it as GeoTIFF first (gdal_translate)"
                )
    _check_names(path, root)


def _tree(path: Path) -> ElementTree.Element:
    if path.stat().st_size > _LARGEST:
        raise MeshdepictError("is too long for a virtual raster")
    data = path.read_bytes()
    if re.search(rb"<!(?:DOCTYPE|ENTITY)", data):
        raise MeshdepictError("declares XML entities, which no virtual raster needs")
    try:
        return ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError, RecursionError) as error:
        raise MeshdepictError(f"is cut off or damaged: it is no XML ({error})") from error


def _check_names(path: Path, root: ElementTree.Element) -> None:
    """Refuse sources of masks and overviews that lie elsewhere, too."""
    for name in root.iter("SourceFilename"):
        _file(path, name)
    for tag in ("SourceDataset", "GDALWarpOptions"):
        if next(root.iter(tag), None) is not None:
            raise MeshdepictError(
                f"has a {tag}, which computes its cells: save it as GeoTIFF first (gdal_translate)"
            )


def _check_source(path: Path, source: ElementTree.Element, depth: int) -> None:
    name = source.find("SourceFilename")
    if name is None:
        raise MeshdepictError("has a tile without a file's name")
    tile = _file(path, name)
    rectangles = [source.find(tag) for tag in ("SrcRect", "DstRect")]
    try:
        sizes = [
            [float(rectangle.get(key, "")) for key in ("xSize", "ySize")]
            for rectangle in rectangles
            if rectangle is not None
        ]
    except ValueError:
        raise MeshdepictError(f"places the tile {tile.name!r} by what is no number") from None
    if len(sizes) == 1:
        raise MeshdepictError(f"says only half of where the tile {tile.name!r} lies")
    if sizes and not all(abs(a - b) <= _PART * abs(a) for a, b in zip(*sizes, strict=True)):
        raise MeshdepictError(
            f"resamples the tile {tile.name!r}, whose cells are of another size: bring all tiles "
            "to one size first (gdalwarp)"
        )
    if tile.suffix.lower() == ".vrt":
        check_vrt(tile, depth + 1)
        return
    with tile.open("rb") as file:
        start = file.read(1024)
    if start.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"<", b"{")):
        raise MeshdepictError(f"names the tile {tile.name!r}, which is text, not a raster")


def _file(path: Path, name: ElementTree.Element) -> Path:
    tile = inside(path.parent, (name.text or "").strip(), "tile")
    if not tile.is_file():
        raise MeshdepictError(f"names the tile {tile.name!r}, which is not there")
    return tile
