"""Small good files of terrain of every format, by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from height_files import DEGREES, asc, geotiff, hills, usgs
from volume_files import tiff


def height_seeds(folder: Path) -> dict[str, bytes]:
    """Return files by name; rasters of GDAL's where rasterio is there."""
    z = hills(9, 7)
    np.save(folder / "heights.npy", z)
    found = {
        "plain.asc": asc(z),
        "centres.asc": asc(z, xllcorner=None, xllcenter=5, NODATA_value="nan"),
        "survey.dem": usgs(hills(200, 5), starts=[3, 2, 1, 2, 3]),
        "arcs.dem": usgs(z, system=0, ground=3, step=(3, 3, 1), corner=(25_200, 165_600)),
        "heights.npy": (folder / "heights.npy").read_bytes(),
        "map_page.tif": tiff(z[None]),
    }
    try:
        import rasterio  # noqa: F401 - the extra [dem] may be missing
    except ImportError:
        return found
    path = folder / "map.tif"
    choices = {
        "map_strips.tif": {"nodata": 200},
        "map_tiles.tif": {"tiled": True, "blockxsize": 16, "blockysize": 16, "compress": "lzw"},
        "map_packed.tif": {"compress": "deflate", "predictor": 3, "bigtiff": "yes"},
        "map_degrees.tif": {"crs": DEGREES, "transform": (0.01, 0, 7, 0, -0.01, 46)},
        "map.img": {"driver": "HFA"},
    }  # fmt: skip
    return found | {
        name: geotiff(path.with_name(name), z, **given).read_bytes()
        for name, given in choices.items()
    }
