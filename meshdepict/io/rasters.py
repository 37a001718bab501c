"""Heights from GeoTIFF and other rasters: what rasterio opens, but for what leads elsewhere."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from meshdepict.errors import MeshdepictError, printable
from meshdepict.files.library_noise import library_noise
from meshdepict.files.limits import check_claim
from meshdepict.files.mark import MARK
from meshdepict.heights.cells import checked_transform
from meshdepict.io.crs import units_of
from meshdepict.io.gdal import gdal, said
from meshdepict.io.height_source import (
    WORDS,
    Cells,
    HeightSource,
    height_kind,
    heights_of,
    note_units,
)

__all__ = ["open_raster"]

# Formats that hold their cells themselves, or in a file beside: none that fetches or runs anything.
_DRIVERS = (
    "GTiff", "VRT", "AAIGrid", "GRASSASCIIGrid", "USGSDEM", "HFA", "EHdr", "ENVI", "AIG", "DTED",
    "SRTMHGT", "BT", "BIL", "GSAG", "GSBG", "GS7BG", "GXF", "GTX", "NTv2", "HF2", "ILWIS", "KRO",
    "LCP", "Leveller", "netCDF", "HDF5", "HDF5Image", "BAG", "GRIB", "JP2OpenJPEG", "JPEG", "PNG",
    "BMP", "PNM", "NITF", "PCIDSK", "PCRaster", "RMF", "ROI_PAC", "RRASTER", "RST", "SAGA", "SDTS",
    "SIGDEM", "SNODAS", "Terragen", "VICAR", "XYZ", "ZMap", "ISG", "NGSGEOID", "BYN", "GFF", "S102",
    "GPKG", "MRF", "ISIS3", "PDS", "ACE2", "JDEM", "NOAA_B", "GenBin",
)  # fmt: skip
_COLOURS = (
    "red", "green", "blue", "alpha", "palette", "hue", "saturation", "lightness", "cyan", "magenta",
    "yellow", "black", "Y", "Cb", "Cr",
)  # fmt: skip
# Of a file and its numbers, not of what they mean.
_ABOUT_FILES = (
    "AREA_OR_POINT", "STATISTICS_", "OVR_", "TIFFTAG_IMAGEDESCRIPTION", "TIFFTAG_SOFTWARE",
    "TIFFTAG_XRES", "TIFFTAG_YRES", "TIFFTAG_RES", "TIFFTAG_MIN", "TIFFTAG_MAX", MARK,
)  # fmt: skip
_LONGEST_WORD, _MOST_WORDS = 1000, 64
_NO_PLACE = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)  # GDAL's way to say that there is none
_PICTURES = ("PNG", "JPEG", "BMP", "PNM", "JP2OpenJPEG")


def open_raster(path: Path, band: int, unit: str) -> HeightSource:
    """Open a raster.

    Parameters
    ----------
    path : Path
    band : int
        Which one holds heights, from 1.
    unit : str
        Of its heights, "" to believe the file.

    Raises
    ------
    MeshdepictError
        For what rasterio doesn't open, pictures, missing bands, cells without a grid: a clause
        whose subject is the file.
    """
    if path.suffix.lower() == ".vrt" or _begins(path, b"<VRTDataset"):
        from meshdepict.io.vrt import check_vrt

        check_vrt(path)
    source = _Raster(path, band)
    with source.opened() as dataset:
        return _described(path, dataset, band, unit, source)


def _begins(path: Path, mark: bytes) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return mark in file.read(1024)


class _Raster:
    """A dataset that is opened when it is read, and stays open until it is released."""

    def __init__(self, path: Path, band: int) -> None:
        self._path, self._band = path, band
        self._dataset: Any = None
        self.scale, self.offset, self.is_masked = 1.0, 0.0, True
        self.nodata: float | None = None

    @contextmanager
    def opened(self) -> Iterator[Any]:
        """Give the dataset, which stays open if all goes well."""
        with gdal("reading GeoTIFF, and all but .asc, .dem and .npy,") as rasterio:
            try:
                with library_noise([]):  # libtiff's, of files that are cut off
                    yield self.dataset(rasterio)
            except MeshdepictError:
                self.release()
                raise
            except Exception as error:  # GDAL's own have no class in common but this one
                self.release()
                raise MeshdepictError(f"is cut off or damaged: {said(error)}") from error

    def dataset(self, rasterio: Any) -> Any:
        """Return the dataset."""
        if self._dataset is None:
            try:
                self._dataset = rasterio.io.DatasetReader(
                    os.path.abspath(self._path), driver=list(_DRIVERS)
                )
            except Exception as error:  # GDAL's own have no class in common but this one
                text = said(error)
                why = "" if "not recognized" in text else f": {text}"
                raise MeshdepictError(
                    f"is cut off, damaged or in no format of heights that is known{why}"
                ) from error
        return self._dataset

    def release(self) -> None:
        """Close the dataset."""
        if self._dataset is not None:
            self._dataset.close()
            self._dataset = None

    def read(self, rows: slice, cols: slice) -> Cells:
        """Return heights, scaled, and where there are any."""
        # Where a bar shows progress on the same stderr, it matters more than libtiff's words.
        quiet = nullcontext() if sys.stderr and sys.stderr.isatty() else library_noise([])
        with gdal("reading rasters") as rasterio, quiet:
            dataset = self.dataset(rasterio)
            window = ((rows.start, rows.stop), (cols.start, cols.stop))
            try:
                raw = dataset.read(self._band, window=window)
                if self.is_masked:
                    valid = dataset.read_masks(self._band, window=window) > 0
                else:  # a comparison is faster than GDAL's second reading
                    nothing = None if self.nodata is None else raw.dtype.type(self.nodata)
                    valid = np.ones(raw.shape, bool) if nothing is None else raw != nothing
            except MemoryError:
                raise MeshdepictError("takes more memory than there is") from None
            except Exception as error:  # GDAL's own have no class in common but this one
                raise MeshdepictError(
                    f"is cut off or damaged: cells of its rows {rows.start + 1:,} to "
                    f"{rows.stop:,} can't be read ({said(error)})"
                ) from error
        return heights_of(raw, valid, self.scale, self.offset)


def _described(path: Path, dataset: Any, band: int, unit: str, cells: _Raster) -> HeightSource:
    _check_files(path, dataset)
    _check_band(dataset, band)
    kind = np.dtype(dataset.dtypes[band - 1])
    notes: list[str] = []
    transform = checked_transform(tuple(dataset.transform)[:6])
    is_placed = transform != _NO_PLACE
    if not is_placed:
        if dataset.gcps[0]:
            raise MeshdepictError("is placed by single points only: rectify it first (gdalwarp)")
        transform = (1, 0, 0, 0, -1, float(dataset.height))
        notes.append("it doesn't say where it lies: its cells count as 1 m")
    crs = dataset.crs.to_wkt() if dataset.crs else ""
    units = units_of(crs)
    source = HeightSource(
        dataset.height, dataset.width, transform, cells.read, crs, units.degrees, units.unit,
        notes=notes, kind=height_kind(kind), is_placed=is_placed, release=cells.release,
    )  # fmt: skip
    metres = note_units(source, dataset.units[band - 1] or "", units.vertical, unit, notes)
    scale, offset = dataset.scales[band - 1], dataset.offsets[band - 1]
    cells.scale, cells.offset = scale * metres, offset * metres
    if not np.isfinite([cells.scale, cells.offset]).all() or not cells.scale:
        raise MeshdepictError(f"says a scale of {scale:g} and an offset of {offset:g}")
    flags = {flag.name for flag in dataset.mask_flag_enums[band - 1]}
    nodata = dataset.nodatavals[band - 1]
    cells.is_masked = not (flags <= {"all_valid", "nodata"} and _fits(nodata, kind))
    cells.nodata = nodata if "nodata" in flags else None
    source.attributes |= {
        name: value
        for name, value in (
            ("band", band), ("band_name", dataset.descriptions[band - 1]), ("scale", scale),
            ("offset", offset), ("nodata", nodata),
            ("point_or_area", dataset.tags().get("AREA_OR_POINT")), ("driver", dataset.driver),
        )
        if value is not None
    } | _words(dataset)  # fmt: skip
    names = {str(path), *dataset.files}
    source.size = sum(os.path.getsize(name) for name in names if os.path.isfile(name))
    high, wide = dataset.block_shapes[band - 1]  # GDAL makes room for one at least
    check_claim(high * wide * kind.itemsize, source.size, "cells in a block")
    return source


def _words(dataset: Any) -> dict[str, str]:
    """Return what people wrote of the data, which goes with them: whose they are, and of when."""
    found = {
        name: printable(text)
        for name, text in dataset.tags().items()
        if len(text) <= _LONGEST_WORD
        and re.fullmatch(r"[\w .:/#-]{3,80}", name)
        and not name.startswith(_ABOUT_FILES)
    }
    return {f"{WORDS}{name}": found[name] for name in sorted(found)[:_MOST_WORDS]}


def _fits(nodata: float | None, kind: np.dtype[Any]) -> bool:
    """Whether a value for no height is one of the numbers of a type."""
    if nodata is None or kind.kind == "f":
        return True
    ends = np.iinfo(kind)
    return bool(ends.min <= nodata <= ends.max and nodata == int(nodata))


def _check_files(path: Path, dataset: Any) -> None:
    """Refuse a dataset that takes files from elsewhere."""
    home = Path(os.path.realpath(path)).parent
    for name in dataset.files:
        if not Path(os.path.realpath(name)).is_relative_to(home):
            raise MeshdepictError(
                f"names the file {name!r}: only files in its own folder, or in folders below it, "
                "are read"
            )


def _check_band(dataset: Any, band: int) -> None:
    """Refuse a band that isn't there, and one that holds no heights."""
    count = dataset.count
    if not count and dataset.subdatasets:
        raise MeshdepictError(
            f"holds {len(dataset.subdatasets):,} rasters: extract one of them first "
            "(gdal_translate)"
        )
    if dataset.driver == "GTiff" and dataset.subdatasets and not dataset.crs:
        raise MeshdepictError(
            f"is a stack of {len(dataset.subdatasets):,} pages without a place on the map, not an "
            "elevation model: read it as a volume"
        )
    if not 1 <= band <= count:
        have = "one band" if count == 1 else f"{count:,} bands"
        raise MeshdepictError(f"has {have}, so that there is no band {band}")
    kind, meaning = dataset.dtypes[band - 1], dataset.colorinterp[band - 1].name
    eight = kind == "uint8"
    others = [found.name for found in dataset.colorinterp]
    picture = eight and (dataset.driver in _PICTURES or "alpha" in others)
    if meaning in _COLOURS or picture:
        colour = f"colours (band {band} is {meaning})" if meaning != "gray" else "shades of gray"
        raise MeshdepictError(
            f"is a picture, not an elevation model: it holds {colour}; give the model that it was "
            "made from"
        )
    if kind.startswith("complex"):
        raise MeshdepictError(f"holds numbers of type {kind}, which are no heights")
