"""Relief as PNG and JPEG, with what says beside them where they lie: world file, PRJ, AUX.XML."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.limits import as_text, max_memory
from meshdepict.io.gdal import gdal
from meshdepict.io.relief_layout import ReliefLayout
from meshdepict.io.world_files import auxiliary, world

__all__ = ["check_relief_picture", "written_picture"]

_JPEG_SIDE = 65_500  # pixels: its library's limit
_COMMENT = 65_000  # bytes of a JPEG's comment
_QUALITY = 95  # of JPEG's 100; above, files grow and nobody sees why
_COPIES = 2  # of the picture: ours, and the encoder's


def check_relief_picture(
    path: str | os.PathLike[str], shape: tuple[int, int], kind: str, channels: int
) -> None:
    """Refuse values, and more pixels than the format or memory holds."""
    rows, cols = shape
    if kind == "values":
        raise MeshdepictError(f"{path}: a picture holds no values; write a .tif")
    if Path(path).suffix.lower() != ".png" and max(shape) > _JPEG_SIDE:
        raise MeshdepictError(
            f"{path}: a JPEG has at most {_JPEG_SIDE:,} pixels a side, not {cols:,} x {rows:,}; "
            "write a .tif"
        )
    needed = _COPIES * channels * rows * cols
    if needed > max_memory():
        raise MeshdepictError(
            f"{path}: a picture of {cols:,} x {rows:,} pixels takes {as_text(needed)} of memory, "
            f"more than the {as_text(max_memory())} that are allowed; write a .tif, which is "
            "written in windows, or allow more with --max-memory"
        )


@contextmanager
def written_picture(
    path: Path, layout: ReliefLayout
) -> Iterator[Callable[[int, int, NDArray[Any]], None]]:
    """Give what takes planes (bands, rows, cols) from a row and a column on.

    Raises
    ------
    MeshdepictError
        For every failure to write.
    """
    pixels = np.zeros((layout.rows, layout.cols, layout.bands + 1), np.uint8)

    def write(row: int, col: int, planes: NDArray[Any]) -> None:
        _, rows, cols = planes.shape
        pixels[row : row + rows, col : col + cols] = planes.transpose(1, 2, 0)

    with ExitStack() as stack:
        # All are written before any takes its name, the picture last.
        file = stack.enter_context(atomic_write(path))
        yield write
        _save(file, pixels, path, layout)
        file.flush()
        for name, data in _beside(path, layout).items():
            beside = stack.enter_context(atomic_write(name))
            beside.write(data)
            beside.flush()


def _beside(path: Path, layout: ReliefLayout) -> dict[Path, bytes]:
    """Return the files beside a picture; a PRJ that is there stays: it may be another file's."""
    stem = ".pgw" if path.suffix.lower() == ".png" else ".jgw"
    found = {
        path.with_suffix(stem): world(layout.transform),
        path.with_name(f"{path.name}.aux.xml"): auxiliary(layout.transform, layout.crs),
    }
    prj, text = path.with_suffix(".prj"), _esri(layout.crs)
    if text and not os.path.lexists(prj):
        found[prj] = text.encode()
    return found


def _esri(crs: str) -> str:
    """Return a system's text in ESRI's words where rasterio is there, else as it is."""
    try:
        with gdal("translating a reference system") as rasterio:
            return str(rasterio.CRS.from_user_input(crs).to_wkt(version="WKT1_ESRI")) if crs else ""
    except (MeshdepictError, ValueError):  # CRSError is a ValueError
        return crs if "[" in crs else ""


def _save(file: BinaryIO, pixels: NDArray[np.uint8], path: Path, layout: ReliefLayout) -> None:
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    if path.suffix.lower() == ".png":
        texts = PngInfo()
        for line in layout.lines:
            key, _, text = line.partition(": ")
            texts.add_text(key, text)
        Image.fromarray(pixels).save(file, format="PNG", pnginfo=texts)
        return
    nothing = pixels[..., -1] == 0
    pixels[nothing] = 255  # a JPEG has no transparency
    shown = pixels[..., :-1] if layout.bands == 3 else pixels[..., 0]
    comment = "\n".join(layout.lines).encode("utf-8", "replace")[:_COMMENT]
    Image.fromarray(np.ascontiguousarray(shown)).save(
        file, format="JPEG", quality=_QUALITY, subsampling=0, comment=comment
    )
