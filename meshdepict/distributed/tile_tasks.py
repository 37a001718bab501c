"""What workers do for a mesh that none of them has as a whole, step by step.

Each step is done for every range of rows of the file, or for every tile, in any order, and leaves
its arrays in a folder for the next one. To do one again changes nothing.
"""

from __future__ import annotations

import warnings
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.sample_shading import SampleShading
from meshdepict.distributed.tile_files import Site
from meshdepict.distributed.tile_space import TileSpace
from meshdepict.distributed.tile_sums import TileNormals, spread_tile
from meshdepict.distributed.tiling import Extent, cell_of
from meshdepict.io.ply_ranges import PlyRanges
from meshdepict.shapes.mesh import Mesh

__all__ = [
    "Built", "Smoothing", "build", "call", "count", "shade", "smooth", "sort", "spread_tile",
    "survey", "write",
]  # fmt: skip

_KEY = 8  # bits of a length's single precision that are left out: a median is off by 2e-5


class Built(NamedTuple):
    """What is known of a tile once its geometry is there.

    Attributes
    ----------
    box : (2, 3) array
        Of its own vertices.
    largest : float
        Area of any of them, in squared diagonals.
    lengths, counts : arrays
        Edges: their lengths in diagonals, rounded, and how many have each.
    first, last : int
        Least and largest number of its vertices in the file.
    """

    box: NDArray[np.float64]
    largest: float
    lengths: NDArray[np.float32]
    counts: NDArray[np.int64]
    first: int
    last: int


class Smoothing(NamedTuple):
    """How normals are smoothed: the ladder, and which widths see a halo and which blocks."""

    widths: NDArray[np.float64]
    ratio: float
    facing: int
    tolerance: float
    narrow: tuple[float, ...]
    wide: tuple[float, ...]
    largest: float
    last: int  # the coarsest scale that is read
    stride: int  # between vertices to which numbers are fitted


def call(item: tuple[Any, ...]) -> Any:
    """Do a step: a function and what it takes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a part of a mesh lacks, the whole may have
        return item[0](*item[1:])


def survey(
    path: Path, rows: slice, directions: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the box about a range of vertices, and those furthest out in some directions."""
    points = PlyRanges(path).points(rows)
    middle = points.mean(axis=0)
    along = (points - middle) @ directions.T
    outer = np.unique([along.argmin(axis=0), along.argmax(axis=0)])
    return points.min(axis=0), points.max(axis=0), points[outer]


def count(path: Path, rows: slice, extent: Extent) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the cells that a range of vertices lies in, and how many lie in each."""
    cells, number = np.unique(cell_of(PlyRanges(path).points(rows), extent), return_counts=True)
    return cells, number


def sort(site: Site, part: int, rows: slice, faces: slice) -> None:
    """Leave which vertices of a range are a tile's own, and which faces touch any of them."""
    mesh, table = PlyRanges(site.path), site.find("table")
    own = table[cell_of(mesh.points(rows), site.extent)]
    site.keep_sorted(f"vertices-{part}", np.arange(rows.start, rows.stop), own)
    triangles = mesh.triangles(faces)
    used, corners = np.unique(triangles, return_inverse=True)
    tile = table[cell_of(mesh.points(used), site.extent)][corners.reshape(-1, 3)]
    met = [np.ones(len(tile), bool), tile[:, 1] != tile[:, 0]]
    met.append((tile[:, 2] != tile[:, 0]) & (tile[:, 2] != tile[:, 1]))
    touching = np.concatenate([triangles[some] for some in met])
    of = np.concatenate([tile[some, corner] for corner, some in enumerate(met)])
    number = np.concatenate([np.flatnonzero(some) for some in met])
    order = np.argsort(number, kind="stable")  # as the file has them
    site.keep_sorted(f"faces-{part}", touching[order], of[order])


def build(site: Site, tile: int) -> Built:
    """Leave positions, normals and areas of a tile's own vertices."""
    mesh, unit = PlyRanges(site.path), site.extent.diagonal or 1.0
    own = site.find_sorted("vertices", tile)
    faces = site.find_sorted("faces", tile)
    around = np.setdiff1d(faces, own)
    known = np.concatenate([own, around])
    order = np.argsort(known, kind="stable")
    local = order[np.searchsorted(known[order], faces)]
    points = mesh.points(known)
    normals = np.tile((0.0, 0.0, 1.0), (len(own), 1))  # what `Mesh` gives what no face meets
    areas = np.zeros(len(own))
    lengths = np.empty(0, np.float32)
    if len(faces):
        part = Mesh(points, local, winding="keep")
        normals, areas = part.normals[: len(own)], part.areas[: len(own)] / unit**2
        lengths = _own_edges(points / unit, local, known, len(own))
    site.keep(f"own-{tile}", own)
    site.keep(f"points-{tile}", points[: len(own)])
    site.keep(f"normals-{tile}", np.ascontiguousarray(normals.T))
    site.keep(f"areas-{tile}", areas)
    keys, number = np.unique(lengths.view(np.uint32) >> _KEY, return_counts=True)
    middle = ((keys << _KEY) + (1 << _KEY - 1)).astype(np.uint32).view(np.float32)
    box = np.stack([points[: len(own)].min(axis=0), points[: len(own)].max(axis=0)])
    return Built(box, float(areas.max()), middle, number, int(own[0]), int(own[-1]))


def _own_edges(
    points: NDArray[np.float64],
    faces: NDArray[np.int64],
    known: NDArray[np.int64],
    own: int,
) -> NDArray[np.float32]:
    """Return the lengths of edges whose vertex of lower number is the tile's own, each once."""
    ends = np.concatenate([faces[:, (c, (c + 1) % 3)] for c in range(3)])
    swap = known[ends[:, 0]] > known[ends[:, 1]]
    ends[swap] = ends[swap][:, ::-1]
    ends = ends[ends[:, 0] < own]
    key = np.unique(ends[:, 0] * len(points) + ends[:, 1])
    lengths = np.linalg.norm(points[key // len(points)] - points[key % len(points)], axis=1)
    return lengths[lengths > 0].astype(np.float32)


def smooth(site: Site, tile: int, how: Smoothing) -> tuple[NDArray[Any], int]:
    """Leave the normals of a tile at all scales.

    Returns
    -------
    chosen : array of records
        The vertices to which numbers are fitted: number, position, normals.
    doubtful : int
        See `TileNormals`.
    """
    planes = np.empty((how.last + 1, 3, len(site.find(f"own-{tile}"))), np.float32)
    found: Any = np.asarray(site.find(f"normals-{tile}"))
    planes[0] = found
    sums = TileNormals(
        site, tile, facing=how.facing, tolerance=how.tolerance, narrow=how.narrow, wide=how.wide,
        largest=how.largest,
    )  # fmt: skip
    for scale in range(1, how.last + 1):
        found = sums.direction(float(how.widths[scale]), partial(np.asarray, found), None)
        planes[scale] = found
    site.keep(f"planes-{tile}", planes)
    own = np.asarray(site.find(f"own-{tile}"))
    some = own % how.stride == 0
    kind = [("number", "i8"), ("point", "f8", 3), ("planes", "f4", (how.last + 1, 3))]
    chosen = np.empty(int(some.sum()), kind)
    chosen["number"], chosen["point"] = own[some], site.find(f"points-{tile}")[some]
    chosen["planes"] = np.moveaxis(planes[:, :, some], 2, 0)
    return chosen, sums.doubtful


def shade(site: Site, tile: int, how: Smoothing, shading: SampleShading) -> None:
    """Leave the colours of a tile's vertices."""
    points, planes = (np.asarray(site.find(f"{name}-{tile}")) for name in ("points", "planes"))
    space = TileSpace(
        site.extent, points, planes,
        how.widths[: how.last + 1], how.ratio, facing=how.facing, tolerance=how.tolerance,
    )  # fmt: skip
    values = shading.values(dict.fromkeys(shading.ladders, space))
    # (A tint, which would ask for heights, has been refused.)
    site.keep(f"colors-{tile}", shading.colors(values, lambda: np.zeros(space.count)))


def write(
    site: Site, target: Path, header: int, rows: slice, faces: slice, tiles: NDArray[np.intp]
) -> None:
    """Write a range of rows of the file with colours, at its place in a file that is there."""
    mesh = PlyRanges(site.path)
    colors = np.zeros((rows.stop - rows.start, 3), np.uint8)
    for tile in tiles:
        own = site.find(f"own-{tile}")
        first, last = np.searchsorted(own, (rows.start, rows.stop))
        colors[own[first:last] - rows.start] = site.find(f"colors-{tile}")[first:last]
    with target.open("r+b") as file:
        mesh.write_vertices(file, header, rows, colors)
        mesh.write_faces(file, header, faces)
