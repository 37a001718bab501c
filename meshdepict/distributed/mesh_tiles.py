"""A mesh larger than any worker's memory, shaded by spatial tiles as it would be at once.

Nobody has it as a whole, and whoever hands out the work has least of it: a table of cells, a few
thousand samples. Tiles leave what others need in a folder beside the output, which goes at the end.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.choice_list import AUTO
from meshdepict.baking.choices import Choices
from meshdepict.baking.provenance import comment_lines, describe
from meshdepict.baking.sample_shading import SampleShading
from meshdepict.distributed import tile_tasks as tasks
from meshdepict.distributed.attempts import Pool, Work, results
from meshdepict.distributed.tile_files import Site
from meshdepict.distributed.tile_space import TileSpace
from meshdepict.distributed.tile_sums import halo_reach
from meshdepict.distributed.tiling import SIDE, Extent, cut, ranges
from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.io.ply_ranges import PlyRanges
from meshdepict.scales.ladder import Progress, check_ladder, ladder
from meshdepict.shading.fitted_tones import SAMPLES
from meshdepict.shapes.lengths import resolve_width

__all__ = ["TILE", "bake_by_tiles", "check_tiles"]

TILE = 500_000
"""Vertices of a tile, at most, unless somebody says otherwise."""

_LEAST = 1000  # vertices of a tile
_ROWS = 1 << 20  # of the file, that are read at once
_STEPS = 8
_NARROW = 8  # a halo may be so many times narrower than a tile
# Other choices are samples' own.
_UNUSUAL = ("refine", "creases", "ground", "blend", "tint", "budget")


def check_tiles(look: Choices, tile: int) -> Choices:
    """Return a look for tiles; refuse what needs the whole mesh.

    Raises
    ------
    MeshdepictError
        With what to leave out.
    """
    if tile < _LEAST:
        raise MeshdepictError(f"tiles={tile} makes no sense: give {_LEAST:,} vertices or more")
    unusual = [name for name in _UNUSUAL if getattr(look, name) is not None]
    usual = {"albedo": "none", "normals": "computed", "two_sided": False}
    unusual += [name for name, word in usual.items() if getattr(look, name) != word]
    if unusual:
        raise MeshdepictError(f"{unusual[0]} looks at the whole mesh: leave it out, or --tiles")
    if AUTO in (look.up, look.view):
        look = look.replace(
            up="y" if look.up == AUTO else look.up, view="front" if look.view == AUTO else look.view
        )
    look = look.of_kind("mesh")
    scales, ratio = look.ladder
    check_ladder(scales, ratio, look.facing, look.tolerance)
    reads = look.reads(scales)
    if not look.declared.local or look.declared.needs - {"view", "curvature"} or reads.rays:
        raise MeshdepictError(
            f"{look.method} looks at more than a vertex and its normals: take another method, or "
            "leave --tiles out"
        )
    if reads.curvature | reads.seen | reads.means:
        raise MeshdepictError(
            f"{look.method} asks how the surface bends: set its curvature's strength to 0, take "
            "another method, or leave --tiles out"
        )
    return look


def bake_by_tiles(
    path: Path,
    output: Path,
    look: Choices,
    pool_for: Callable[[Work], Any],
    *,
    tile: int = TILE,
    marks: Mapping[str, str] | None = None,
    progress: Progress | None = None,
) -> dict[str, str]:
    """Shade a mesh by tiles and write it with its colours.

    Parameters
    ----------
    path : Path
        Binary PLY of triangles, in a folder that all workers see. Faces are taken as they are
        wound.
    output : Path
        As well. Ends in .ply.
    look : Choices
    pool_for : callable
        As of `Workers.at_work`.
    tile : int
        Vertices of a tile, at most.
    marks : mapping of str, optional
        What else stands in the provenance.
    progress : callable, optional
        ``progress(done, total)``.

    Returns
    -------
    dict of str
        The provenance.

    Raises
    ------
    MeshdepictError
        As `check_tiles`, and for a file that can't be read by ranges or written.
    """
    look = check_tiles(look, tile)
    if output.suffix.lower() != ".ply":
        raise MeshdepictError(f"{output}: tiles are written as .ply")
    mesh = PlyRanges(path)
    try:
        folder = tempfile.mkdtemp(
            prefix=f".{output.name[:100]}.", suffix=".tiles", dir=output.parent
        )
    except OSError as error:
        raise MeshdepictError(f"{output} can't be written: {error.strerror}") from None
    try:
        with pool_for(tasks.call) as pool:
            work = _Work(mesh, Path(folder), look, pool, tile, progress)
            work.prepare()
            provenance = work.settle() | dict(marks or {})
            work.save(output, provenance)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return provenance


class _Work:
    def __init__(
        self,
        mesh: PlyRanges,
        folder: Path,
        look: Choices,
        pool: Pool,
        tile: int,
        progress: Progress | None,
    ) -> None:
        self._mesh, self._look, self._pool, self._progress = mesh, look, pool, progress
        self._tile = tile
        length = min(_ROWS, max(tile, _LEAST))
        self._rows = list(ranges(mesh.vertices, length))
        faces = -(-mesh.faces // len(self._rows))
        self._faces = list(ranges(mesh.faces, faces))
        self._faces += [slice(mesh.faces, mesh.faces)] * (len(self._rows) - len(self._faces))
        unknown = np.zeros(3)
        self._site = Site(
            Path(os.path.abspath(mesh.path)), Path(os.path.abspath(folder)),
            Extent(unknown, unknown, unknown[None]), parts=len(self._rows),
        )  # fmt: skip
        self._step = 0

    def _each(self, what: Callable[..., Any], items: Sequence[tuple[Any, ...]]) -> list[Any]:
        """Do a step for all ranges or tiles, and return what comes of each, in order."""
        found: list[Any] = [None] * len(items)
        for done, (number, value) in enumerate(
            results(self._pool, [(what, *item) for item in items]), 1
        ):
            found[number] = value
            if self._progress:
                self._progress(self._step + done / len(items), _STEPS)
        self._step += 1
        return found

    # --- geometry ---------------------------------------------------------------------------

    def prepare(self) -> None:
        """Let every tile have its vertices, normals and areas."""
        path = self._site.path
        cube = Extent(-np.ones(3), np.ones(3), np.array(_CORNERS))
        directions = np.concatenate([np.eye(3), self._look.eye(cube).frame])
        boxes = self._each(tasks.survey, [(path, rows, directions) for rows in self._rows])
        lows, highs, outlines = zip(*boxes, strict=True)
        extent = Extent(np.min(lows, axis=0), np.max(highs, axis=0), np.concatenate(outlines))
        number = np.zeros(SIDE**3, np.int64)
        for cells, many in self._each(tasks.count, [(path, rows, extent) for rows in self._rows]):
            number[cells] += many
        table = cut(number, self._tile)
        tiles = int(table.max()) + 1
        identity = f"{self._mesh.vertices} vertices {self._mesh.faces} triangles, by {tiles} tiles"
        self._site = replace(self._site, extent=replace(extent, identity=identity), tiles=tiles)
        self._site.keep("table", table)
        parts = zip(self._rows, self._faces, strict=True)
        self._each(tasks.sort, [(self._site, part, *each) for part, each in enumerate(parts)])
        self._built = self._each(tasks.build, [(self._site, tile) for tile in range(tiles)])
        self._site.keep("boxes", np.stack([each.box for each in self._built]))
        unit = extent.diagonal or 1.0
        measured = replace(self._site.extent, edge_length=unit * (_median(self._built) or 1.0))
        self._site = replace(self._site, extent=measured)

    # --- normals ----------------------------------------------------------------------------

    def settle(self) -> dict[str, str]:
        """Smooth all tiles, and find the numbers that follow the shape; return the provenance."""
        look, site = self._look, self._site
        eye = look.eye(site.extent)
        scales, ratio = look.ladder
        widths = ladder(scales, ratio, resolve_width(look.width, site.extent, eye))
        last = max(look.reads(scales).sets, default=0)
        read = [float(width) for width in widths[1 : last + 1]]
        longest = np.median([float((each.box[1] - each.box[0]).max()) for each in self._built])
        most = longest / _NARROW / halo_reach(look.tolerance)
        narrow = tuple(width for width in read if site.tiles == 1 or width <= most)
        wide = tuple(width for width in read if width not in narrow)
        largest = max(each.largest for each in self._built) or 1.0
        stride = max(1, -(-self._mesh.vertices // SAMPLES))
        self._how = tasks.Smoothing(
            widths, ratio, look.facing, look.tolerance, narrow, wide, largest, last, stride
        )
        every = range(site.tiles)
        self._each(tasks.spread_tile, [(site, tile, wide, look.facing, largest) for tile in every])
        smoothed = self._each(tasks.smooth, [(site, tile, self._how) for tile in every])
        chosen = np.sort(np.concatenate([part for part, _ in smoothed]), order="number")
        space = TileSpace(
            site.extent, chosen["point"], np.moveaxis(chosen["planes"], 0, 2),
            widths[: last + 1], ratio, facing=look.facing, tolerance=look.tolerance,
        )  # fmt: skip
        light = look.lighting(eye, "mesh")
        self._shading = SampleShading(look.settled(space), light, eye)
        provenance = describe(self._shading.look, space, light=light)
        if doubtful := sum(many for _, many in smoothed):
            provenance["doubtful"] = f"{doubtful} directions may be beyond the tolerance"
        return provenance

    # --- colours ----------------------------------------------------------------------------

    def save(self, output: Path, provenance: Mapping[str, str]) -> None:
        """Shade all tiles and write the file."""
        site, mesh = self._site, self._mesh
        every = range(site.tiles)
        self._each(tasks.shade, [(site, tile, self._how, self._shading) for tile in every])
        with atomic_write(output) as file:
            header = mesh.colored_header(comment_lines(provenance))
            file.write(header)
            file.truncate(mesh.colored_size(len(header)))
            file.flush()
            target = Path(os.path.abspath(file.name))
            self._each(
                tasks.write,
                [
                    (site, target, len(header), rows, faces, self._within(rows))
                    for rows, faces in zip(self._rows, self._faces, strict=True)
                ],
            )

    def _within(self, rows: slice) -> NDArray[np.intp]:
        """Return the tiles that have vertices of a range."""
        return np.array(
            [
                tile for tile, each in enumerate(self._built)
                if each.first < rows.stop and each.last >= rows.start
            ],
            np.intp,
        )  # fmt: skip


_CORNERS = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]


def _median(built: Sequence[tasks.Built]) -> float:
    """Return the median of all edges, in diagonals; 0 without any."""
    counts: Counter[float] = Counter()
    for each in built:
        counts.update(dict(zip(each.lengths.tolist(), each.counts.tolist(), strict=True)))
    lengths = np.array(sorted(counts))
    if not len(lengths):
        return 0.0
    upto = np.cumsum([counts[length] for length in lengths])
    middle = np.searchsorted(upto, [(upto[-1] - 1) // 2, upto[-1] // 2], side="right")
    return float(lengths[middle].mean())
