"""What every format keeps of terrain and of relief, found by writing and reading back."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
from height_files import SLOVENIA, asc, geotiff, hills, usgs

from meshdepict.io import read_provenance
from meshdepict.io.heightfields import read_heightfield
from meshdepict.io.relief_files import relief_writer
from meshdepict.io.usgs_crs import usgs_crs
from meshdepict.shapes.height_field import HeightField

YES, NO = "kept", "–"
_FOOT = 0.3048


def height_table(folder: Path) -> list[str]:
    """Return the table of formats that terrain is read from."""
    heading = "| format | place | coordinate reference system | cells without height | unit |"
    lines = [heading, "| --- " * 5 + "|"]
    z = hills()
    z[2, 3] = -9999
    crs = usgs_crs(1, 33, 3)
    (folder / "probe.prj").write_text(crs)
    place = {"transform": (30, 0, 500_000, 0, -30, 5_000_360), "crs": crs, "nodata": -9999}

    def in_feet(dataset: object) -> None:
        dataset.units = ["ft"]  # type: ignore[attr-defined]

    geotiff(folder / "probe.tif", z, after=in_feet, **place)
    geotiff(folder / "probe.img", z, driver="HFA", **place)
    (folder / "probe.dem").write_bytes(usgs(np.where(z == -9999, -32767, z), up=1, datum=3))
    corner = {"xllcorner": 500_000, "yllcorner": 5_000_000, "cellsize": 30}
    (folder / "probe.asc").write_bytes(asc(z, **corner))
    np.save(folder / "probe.npy", np.where(z == -9999, np.nan, z))
    for suffix in (".tif", ".img", ".dem", ".asc", ".npy"):
        field = read_heightfield(folder / f"probe{suffix}")
        found = (
            field.transform == place["transform"],
            "UTM zone 33N" in field.crs,
            np.argwhere(~field.valid).tolist() == [[2, 3]],
            bool(np.allclose(field.z[0], z[0] * _FOOT)),
        )
        lines.append(f"| {suffix} | " + " | ".join(YES if kept else NO for kept in found) + " |")
    return lines


def relief_table(folder: Path) -> list[str]:
    """Return the table of formats that relief is written as."""
    import rasterio

    heading = (
        "| format | bands of gray relief | values | place | coordinate reference system | "
        "provenance | files beside |"
    )
    lines = [heading, "| --- " * 7 + "|"]
    crs = rasterio.CRS.from_string(SLOVENIA)
    field = HeightField(hills(), transform=(10, 0, 1000, 0, -10, 2120), crs=crs.to_wkt())
    gray = np.full(field.z.shape, 200, np.uint8)
    gray[:8] = 40
    valid = np.ones(gray.shape, bool)
    valid[8:] = False
    for suffix in (".tif", ".png", ".jpg"):
        home = folder / suffix[1:]
        home.mkdir()
        values = NO
        with contextlib.suppress(ValueError):
            with relief_writer(home / f"values{suffix}", like=field, kind="values") as out:
                out.write(slice(None), slice(None), gray.astype(np.float32))
            values = "float32"
            (home / f"values{suffix}").unlink()
        path = home / f"probe{suffix}"
        with relief_writer(path, like=field, provenance={"method": "lambert"}) as out:
            out.write(slice(None), slice(None), gray, valid)
        beside = sorted(p.name.removeprefix("probe") for p in home.iterdir() if p != path)
        with rasterio.open(path) as dataset:
            bands = " + ".join(band.name for band in dataset.colorinterp)
            if dataset.count == 1 and dataset.read(1)[-1].min() > 250:
                bands += ", white without height"
            kept = tuple(dataset.transform)[:6] == field.transform, dataset.crs == crs
        lines.append(
            f"| {suffix} | {bands} | {values} | "
            + " | ".join(YES if each else NO for each in (*kept, _has_provenance(path)))
            + f" | {', '.join(beside) or NO} |"
        )
    return lines


def _has_provenance(path: Path) -> bool:
    if path.suffix == ".tif":
        lines = read_provenance(path)
    else:
        from meshdepict.drawing.picture_files import read_picture_provenance

        lines = read_picture_provenance(path)
    return "meshdepict method: lambert" in (lines or [])
