"""Relief as GeoTIFF: tiles as they come, then a cloud-optimised copy with overviews."""

from __future__ import annotations

import os
import re
import shutil
import stat
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.atomic import atomic_write
from meshdepict.files.library_noise import library_noise
from meshdepict.files.mark import MARK, SOFTWARE
from meshdepict.io.gdal import gdal, said
from meshdepict.io.relief_layout import ReliefLayout
from meshdepict.io.tiff_pages import tiff_pages
from meshdepict.threads import thread_count

__all__ = ["check_tiff", "tiff_provenance", "written_tiff"]

_BLOCK = 512
_LEVEL = 2  # of deflate's nine: relief grows by 2 % against the usual 6, in a third of its time
_NEED = "writing GeoTIFF"
_PACKED = 1 << 30  # bytes from which on tiles are packed, too, before the copy: for the disk's sake
_SPARE = 1 << 20  # bytes: a disk with less is full


def check_tiff(path: str | os.PathLike[str]) -> None:
    """Refuse where rasterio is missing, and what is no file."""
    try:
        with gdal(_NEED):
            pass
    except MeshdepictError as error:
        raise MeshdepictError(f"{path}: {error}, or write a .png") from error
    with suppress(OSError):
        if not stat.S_ISREG(os.stat(path).st_mode) and not os.path.isdir(path):
            raise MeshdepictError(f"{path} is a device or a pipe: a GeoTIFF needs a file")


@contextmanager
def written_tiff(
    path: Path, layout: ReliefLayout
) -> Iterator[Callable[[int, int, NDArray[Any]], None]]:
    """Give what writes planes (bands, rows, cols) from a row and a column on.

    Raises
    ------
    MeshdepictError
        For every failure to write.
    """
    with atomic_write(path) as file:
        home = Path(file.name).parent
        name = f".{path.name[:100]}."
        with tempfile.TemporaryDirectory(".part", name, home, ignore_cleanup_errors=True) as folder:
            tiles = Path(folder, "tiles.tif")
            with _sentences(path, home), gdal(_NEED) as rasterio:
                crs = _crs(rasterio, layout.crs)
                dataset = _created(rasterio, tiles, layout, crs)
            if layout.crs and crs is None:
                warnings.warn(
                    f"{path}: the terrain's coordinate reference system is not understood, and is "
                    "left out",
                    MeshdepictWarning,
                    stacklevel=2,
                )

            def write(row: int, col: int, planes: NDArray[Any]) -> None:
                _, rows, cols = planes.shape
                window = ((row, row + rows), (col, col + cols))
                with _sentences(path, home) as errors, gdal(_NEED, errors):
                    dataset.write(planes, window=window)

            try:
                yield write
                with _sentences(path, home) as errors, gdal(_NEED, errors):
                    dataset.close()
            except BaseException:
                with suppress(Exception), gdal(_NEED):  # what is closed is thrown away
                    dataset.close()
                raise
            mode = stat.S_IMODE(os.stat(file.name).st_mode)
            with _sentences(path, home) as errors, gdal(_NEED, errors) as rasterio:
                _optimised(rasterio, tiles, Path(file.name))
                os.chmod(
                    file.name, mode
                )  # GDAL deletes what is there, and begins a file of its own


def _created(rasterio: Any, tiles: Path, layout: ReliefLayout, crs: Any) -> Any:
    values = layout.kind == "values"
    colours = {} if values else {
        "photometric": "RGB" if layout.kind == "color" else "MINISBLACK",
        "alpha": "NON-PREMULTIPLIED",
    }  # fmt: skip
    bands = layout.bands + (not values)
    size = layout.rows * layout.cols * bands * np.dtype(layout.dtype).itemsize
    packed = {} if size < _PACKED else {"compress": "deflate", "zlevel": 1}
    dataset = rasterio.open(
        tiles, "w", driver="GTiff", height=layout.rows, width=layout.cols,
        count=bands, dtype=str(layout.dtype), crs=crs,
        transform=rasterio.Affine(*layout.transform), nodata=float("nan") if values else None,
        tiled=True, blockxsize=_BLOCK, blockysize=_BLOCK, bigtiff="IF_SAFER",
        num_threads=str(thread_count()), **packed, **colours,
    )  # fmt: skip
    facts = dict(layout.words) | {
        line.partition(": ")[0]: line.partition(": ")[2] for line in layout.lines
    }
    dataset.update_tags(
        AREA_OR_POINT=layout.point_or_area, TIFFTAG_SOFTWARE=SOFTWARE,
        TIFFTAG_IMAGEDESCRIPTION="\n".join(layout.lines), **facts,
    )  # fmt: skip
    return dataset


def _optimised(rasterio: Any, tiles: Path, target: Path) -> None:
    """Copy tiles in the order that readers over a network like, with overviews first."""
    with rasterio.Env(CPL_TMPDIR=str(tiles.parent)):
        rasterio.shutil.copy(
            tiles, target, driver="COG", blocksize=_BLOCK, compress="DEFLATE", level=_LEVEL,
            predictor="YES", overview_resampling="AVERAGE", bigtiff="IF_SAFER",
            num_threads=str(thread_count()),
        )  # fmt: skip


def _crs(rasterio: Any, text: str) -> Any:
    """Return a system as rasterio has it, None where it isn't understood."""
    try:
        return rasterio.CRS.from_user_input(text) if text else None
    except ValueError:  # CRSError is one
        return None


@contextmanager
def _sentences(path: Path, folder: Path) -> Iterator[list[str]]:
    """Turn what GDAL raises, reports or prints of a failure into one sentence."""
    errors: list[str] = []
    noise: list[str] = []
    try:
        with library_noise(noise):  # libtiff prints why the system took no more bytes
            yield errors
    except MeshdepictError:
        raise
    except Exception as error:  # GDAL's own have no class in common but this one
        errors.append(said(error))
    # A progress bar may stand on the same line.
    reasons = [match[1] for line in noise if (match := re.search(r"_tiff\w+: (.+)", line))]
    found = reasons + errors
    if found:
        full = shutil.disk_usage(folder).free < _SPARE or "No space left" in found[0]
        why = "no space is left on the disk" if full else found[0].rstrip(".")
        raise MeshdepictError(f"{path} could not be written: {why}")


def tiff_provenance(path: Path) -> list[str] | None:
    """Return the lines that this program wrote into a TIFF, None where there are none."""
    try:
        lines = tiff_pages(path)[0].description.splitlines()
    except MeshdepictError:
        return None
    return [line for line in lines if line.startswith(MARK)] or None
