"""Files of terrain written letter by letter, or by rasterio: as right or as wrong as wanted."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

SLOVENIA = "EPSG:3794"  # in metres
DEGREES = "EPSG:4326"


def hills(rows: int = 12, cols: int = 9) -> np.ndarray:
    """Heights in whole metres, all of them different."""
    row, col = np.mgrid[:rows, :cols]
    return (200 + 7 * row + row * row % 5 + 100 * col).astype(np.float32)


def asc(z: np.ndarray, *, end: str = "\n", **words: object) -> bytes:
    """An ESRI ASCII grid; ``None`` leaves a word of the header out."""
    rows, cols = z.shape
    header = {
        "ncols": cols, "nrows": rows, "xllcorner": 1000, "yllcorner": 2000, "cellsize": 10,
        "NODATA_value": -9999,
    } | words  # fmt: skip
    lines = [f"{word} {value}" for word, value in header.items() if value is not None]
    lines += [" ".join(f"{height:.9g}" for height in row) for row in z]
    return (end.join(lines) + end).encode()


def number(value: float) -> bytes:
    """As FORTRAN's D24.15."""
    return f"{value:24.15E}".replace("E", "D").encode()


def usgs(
    z: np.ndarray, *, system: int = 1, zone: int = 33, ground: int = 2, up: int = 2,
    step: tuple[float, float, float] = (30, 30, 1), datum: int = 4, corner=(500_015, 5_000_015),
    starts=None, local: float = 0.0,
) -> bytes:  # fmt: skip
    """A USGS model of integers, rows from the north; −32767 is no height.

    ``starts`` leaves out so many heights at the south of each column, and as many at its north.
    """
    rows, cols = z.shape
    head = b"HILLS".ljust(144) + b"%6d%6d%6d%6d" % (1, 1, system, zone)
    head = head.ljust(528) + b"%6d%6d%6d" % (ground, up, 4)
    x, y = ((corner[i], corner[i] + step[i] * (n - 1)) for i, n in ((0, cols), (1, rows)))
    corners = (x[0], y[0], x[0], y[1], x[1], y[1], x[1], y[0])
    head += b"".join(map(number, corners)) + number(z.min()) + number(z.max()) + number(0)
    head += b"%6d" % 0 + b"".join(f"{s:12.6E}".encode() for s in step) + b"%6d%6d" % (1, cols)
    body = head.ljust(890) + b"%2d" % datum
    body = body.ljust(1024)
    for col in range(cols):
        skip = 0 if starts is None else starts[col]
        profile = z[skip : rows - skip, col][::-1].astype(int)
        place = number(corner[0] + step[0] * col) + number(corner[1] + step[1] * skip)
        record = b"%6d%6d%6d%6d" % (1, col + 1, len(profile), 1) + place + number(local)
        record += number(0) + number(0)
        words = [b"%6d" % value for value in profile]
        record = (record + b"".join(words[:146])).ljust(1024)
        for at in range(146, len(words), 170):
            record += b"".join(words[at : at + 170]).ljust(1024)
        body += record
    return body


def geotiff(path: Path, z: np.ndarray, *, transform=None, crs=SLOVENIA, **choices) -> Path:
    """A GeoTIFF by rasterio; bands first where there are several. ``after(dataset)`` adds words."""
    import rasterio
    from rasterio.transform import Affine

    bands = z if z.ndim == 3 else z[None]
    after = choices.pop("after", None)
    place = {} if transform == "none" else {
        "transform": Affine(*(transform or (10, 0, 1000, 0, -10, 2000 + 10 * bands.shape[1])))
    }  # fmt: skip
    given = {"driver": "GTiff", "dtype": bands.dtype, "crs": crs} | place | choices
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # rasterio's, of rasters without a place
        with rasterio.open(
            path, "w", height=bands.shape[1], width=bands.shape[2], count=len(bands), **given
        ) as dataset:
            dataset.write(bands)
            if after:
                after(dataset)
    return path
