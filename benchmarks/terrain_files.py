"""Terrain from file to file, and what others take for the same.

A peer that is no dependency is found where somebody put it: ``gdaldem`` on the path (Debian's
package gdal-bin), the Relief Visualization Toolbox in an environment of its own, whose Python
MESHDEPICT_RVT names.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import meshdepict as md
from benchmarks import terrain
from benchmarks.processes import PEAK
from meshdepict.baking.relief import Relief
from meshdepict.io.terrain import Terrain

SIZES = (2_000, 10_000)  # cells along a side
_BLOCK = 512

RVT = """
import importlib.util, pathlib, sys, time, types
import numpy as np, scipy.ndimage
old = types.ModuleType("scipy.ndimage.morphology")  # it asks for what scipy no longer has
old.distance_transform_edt = scipy.ndimage.distance_transform_edt
sys.modules[old.__name__] = old
place = importlib.util.find_spec("rvt").submodule_search_locations[0]
found = importlib.util.spec_from_file_location("vis", pathlib.Path(place, "vis.py"))
vis = importlib.util.module_from_spec(found)
found.loader.exec_module(vis)
heights = np.load(sys.argv[1])
start = time.perf_counter()
shares = vis.sky_view_factor(heights, 2.0, compute_svf=True, svf_n_dir=16, svf_r_max=10)["svf"]
print(time.perf_counter() - start)
np.save(sys.argv[2], shares)
"""


def heights(rows: slice, columns: slice) -> NDArray[np.float32]:
    """Return a part of endless hilly ground, in metres, rough to the last cell."""
    y = np.arange(rows.start, rows.stop, dtype=np.float32)[:, None]
    x = np.arange(columns.start, columns.stop, dtype=np.float32)[None]
    z = np.float32(500) + np.zeros((y.size, x.size), np.float32)
    for k in range(10):  # each half as wide as the one before, and turned
        turn = np.float32(2.4 * k)
        at = (np.cos(turn) * x + np.sin(turn) * y) * np.float32(2 * np.pi * 2**k / 3_000)
        other = (np.cos(turn) * y - np.sin(turn) * x) * np.float32(2 * np.pi * 2**k / 3_700)
        z += np.float32(150 * 0.5**k) * np.sin(at) * np.cos(other + np.sin(at / 3))
    return z


def write_ground(path: Path, size: int, *, every: int = 1) -> Path:
    """Write hilly ground as a GeoTIFF of size × size cells of a metre, in blocks.

    Of the blocks in each direction only one of ``every`` is written: the others take no room on
    the disk, and are read as level ground.
    """
    import rasterio

    with rasterio.open(
        path, "w", driver="GTiff", height=size, width=size, count=1, dtype="float32", tiled=True,
        blockxsize=_BLOCK, blockysize=_BLOCK, sparse_ok=True, bigtiff="IF_SAFER",
        crs="EPSG:3794", transform=rasterio.Affine(1, 0, 500_000, 0, -1, 100_000 + size),
    ) as out:  # fmt: skip
        for top in range(0, size, every * _BLOCK):
            for left in range(0, size, every * _BLOCK):
                rows = slice(top, min(top + _BLOCK, size))
                columns = slice(left, min(left + _BLOCK, size))
                window = ((rows.start, rows.stop), (columns.start, columns.stop))
                out.write(heights(rows, columns), 1, window=window)
    return path


class _Files:
    """Ground in a folder of its own, and relief of it."""

    params = (SIZES,)
    param_names = ("size",)
    number, repeat, warmup_time, timeout = 1, (1, 3, 60.0), 0.0, 900
    every = 1

    def setup(self, size: int) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="meshdepict-terrain-")
        self.relief("hillshade", write_ground(Path(self.folder.name, "small.tif"), 100))
        self.dem = write_ground(Path(self.folder.name, "dem.tif"), size, every=self.every)

    def teardown(self, size: int) -> None:
        self.folder.cleanup()

    @property
    def shaded(self) -> Path:
        """Where ours goes."""
        return Path(self.folder.name, "ours.tif")

    def relief(self, method: str, dem: Path | None = None, **chosen: object) -> None:
        """Shade the ground from file to file, as ``meshdepict relief`` does."""
        with Terrain(dem or self.dem) as source:
            Relief(source, md.Look(method, **chosen)).save(self.shaded)


class Hillshade(_Files):
    """Horn's, from file to file: a cloud-optimised, compressed GeoTIFF with overviews."""

    @property
    def theirs(self) -> Path:
        """Where gdaldem's goes."""
        return Path(self.folder.name, "theirs.tif")

    def time_relief(self, size: int) -> None:
        self.relief("hillshade", light=(315, 45))

    def time_gdaldem(self, size: int) -> None:
        """Make the same file by GDAL, on as many threads."""
        options = ("-of", "COG", "-co", "COMPRESS=DEFLATE", "-co", "NUM_THREADS=ALL_CPUS",
                   "-co", "OVERVIEW_RESAMPLING=AVERAGE")  # fmt: skip
        self.gdaldem(*options)

    def time_gdaldem_plain(self, size: int) -> None:
        """Uncompressed, without overviews: hardly more than the shading."""
        self.gdaldem()

    def gdaldem(self, *options: str) -> None:
        program = shutil.which("gdaldem")
        if program is None:
            raise NotImplementedError("gdaldem is not installed")
        words = [program, "hillshade", "-q", "-compute_edges", *options, self.dem, self.theirs]
        subprocess.run(words, check=True)


class Toolbox:
    """The Relief Visualization Toolbox's sky view, of what `terrain.Horizons` looks at."""

    params = ((1_000, 4_000),)
    param_names = ("side",)
    number, repeat, warmup_time, timeout = 1, 1, 0.0, 900

    def setup(self, side: int) -> None:
        if "MESHDEPICT_RVT" not in os.environ:
            raise NotImplementedError("MESHDEPICT_RVT doesn't name the toolbox's Python")

    def track_sky(self, side: int) -> float:
        """Return the seconds that its function takes, without Python's start; keep its result."""
        with tempfile.TemporaryDirectory(prefix="meshdepict-rvt-") as folder:
            files = Path(folder, "z.npy"), Path(folder, "svf.npy")
            np.save(files[0], terrain.ground(side))
            words = [os.environ["MESHDEPICT_RVT"], "-c", RVT, *map(str, files)]
            done = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True)
            self.shares = np.load(files[1])
        return float(done.stdout.split()[-1])

    track_sky.unit = "seconds"


class Exaggerated(_Files):
    """Nine scales under one light, from file to file."""

    params = ((1_000, 4_000),)

    def time_relief(self, size: int) -> None:
        self.relief("exaggerated")

    def peakmem_relief(self, size: int) -> None:
        self.relief("exaggerated")


class Huge:
    """40,000 × 40,000 cells in 2 GB, by the command: only where MESHDEPICT_HUGE is set.

    Of its blocks a sixteenth is written; all cells have heights, and are shaded.
    """

    number, repeat, rounds, warmup_time, timeout = 1, 1, 1, 0.0, 7_200
    size, every, allowed = 40_000, 4, "2GB"

    def setup(self) -> None:
        if "MESHDEPICT_HUGE" not in os.environ:
            raise NotImplementedError("MESHDEPICT_HUGE is not set")
        self.folder = tempfile.TemporaryDirectory(prefix="meshdepict-terrain-")
        self.dem = write_ground(Path(self.folder.name, "dem.tif"), self.size, every=self.every)
        self.peak = 0

    def teardown(self) -> None:
        self.folder.cleanup()

    def time_relief(self) -> None:
        words = (sys.executable, "-m", "meshdepict", "relief", self.dem.name, "-o", "out.tif",
                 "--force", "--quiet", "--max-memory", self.allowed)  # fmt: skip
        done = subprocess.run(
            (sys.executable, "-c", PEAK, *words), check=True, cwd=self.folder.name,
            stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.peak = 1024 * int(done.stdout.split()[-1])

    def track_memory(self) -> int:
        self.time_relief()
        return self.peak

    track_memory.unit = "bytes"
