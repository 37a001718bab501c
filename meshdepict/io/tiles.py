"""Several rasters as one: tiles of one grid, each at its place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.height_source import Cells, HeightSource

__all__ = ["mosaic"]

_OFF = 0.01  # of a cell: what rounding in files may shift a tile by
_OPEN = 64  # tiles that are kept open
_EMPTIEST = 1000  # times the tiles' area: beyond it they belong to different places


class _Mosaic:
    """Tiles and where they begin; the first that holds a height wins."""

    def __init__(
        self, tiles: Sequence[HeightSource], places: NDArray[np.int64], kind: np.dtype[Any]
    ) -> None:
        self._tiles, self._places, self._kind = tiles, places, kind
        self._sizes = np.array([(tile.rows, tile.cols) for tile in tiles])
        self._used: list[int] = []

    def read(self, rows: slice, cols: slice) -> Cells:
        """Return the cells of a window."""
        start, stop = np.array([rows.start, cols.start]), np.array([rows.stop, cols.stop])
        shape = tuple((stop - start).tolist())
        z, valid = np.zeros(shape, self._kind), np.zeros(shape, bool)
        infinite = False
        low = np.maximum(self._places, start)
        high = np.minimum(self._places + self._sizes, stop)
        for i in np.flatnonzero((low < high).all(axis=1)).tolist():
            there = tuple(
                slice(*ends) for ends in zip(low[i] - start, high[i] - start, strict=True)
            )
            if valid[there].all():
                continue
            inner = [slice(*ends) for ends in zip(
                (low[i] - self._places[i]).tolist(), (high[i] - self._places[i]).tolist(),
                strict=True,
            )]  # fmt: skip
            self._touch(i)
            found, has, odd = self._tiles[i].read(*inner)
            infinite = infinite or odd
            new = has & ~valid[there]
            z[there][new] = found[new]
            valid[there] |= has
        return Cells(z, valid, infinite)

    def release(self) -> None:
        """Close all tiles."""
        for i in self._used:
            self._tiles[i].release()
        self._used.clear()

    def _touch(self, tile: int) -> None:
        if tile in self._used:
            self._used.remove(tile)
        self._used.append(tile)
        while len(self._used) > _OPEN:
            self._tiles[self._used.pop(0)].release()


def mosaic(tiles: Sequence[HeightSource], names: Sequence[str]) -> HeightSource:
    """Return one raster of several, as large as their bounds.

    Where tiles overlap, the first that holds a height wins.

    Parameters
    ----------
    tiles : sequence of HeightSource
    names : sequence of str
        Their files', for the sentence.

    Raises
    ------
    MeshdepictError
        For a tile of another system, another cell size, or between the first one's cells, and for
        tiles that lie too far from each other: one sentence that begins with the tile's name.
    """
    first = tiles[0]
    linear = np.array(first.transform)[[0, 1, 3, 4]].reshape(2, 2)
    inverse = np.linalg.inv(linear)
    origin = np.array(first.transform)[[2, 5]]
    places = []
    for tile, name in zip(tiles, names, strict=True):
        _check_alike(first, tile, names[0], name)
        own = np.array(tile.transform)[[0, 1, 3, 4]].reshape(2, 2)
        drift = np.abs(inverse @ own - np.eye(2)) @ [tile.cols, tile.rows]
        if drift.max() > _OFF:
            raise MeshdepictError(
                f"{name} has cells of {_size(own)}, and {names[0]} of {_size(linear)}: bring all "
                "tiles to one grid first (gdalwarp)"
            )
        col, row = inverse @ (np.array(tile.transform)[[2, 5]] - origin)
        off = max(abs(col - round(col)), abs(row - round(row)))
        if off > _OFF:
            raise MeshdepictError(
                f"{name} lies {off:.2g} of a cell between the cells of {names[0]}: bring all tiles "
                "to one grid first (gdalwarp)"
            )
        places.append((round(row), round(col)))
    starts = np.array(places)
    ends = starts + [(tile.rows, tile.cols) for tile in tiles]
    corner = starts.min(axis=0)
    rows, cols = (ends.max(axis=0) - corner).tolist()
    if rows * cols > _EMPTIEST * sum(tile.rows * tile.cols for tile in tiles):
        far = int(np.argmax(np.abs(starts - np.median(starts, axis=0)).max(axis=1)))
        raise MeshdepictError(
            f"{names[far]} lies too far from the other tiles to be one raster with them"
        )
    a, b, c, d, e, f = first.transform
    row, col = corner.tolist()
    kind = np.result_type(*(tile.kind for tile in tiles))
    work = _Mosaic(tiles, starts - corner, kind)
    return HeightSource(
        rows, cols, (a, b, c + a * col + b * row, d, e, f + d * col + e * row), work.read,
        first.crs, first.degrees, first.unit, dict(first.attributes) | {"tiles": len(tiles)},
        kind=kind, is_placed=first.is_placed, size=sum(tile.size for tile in tiles),
        release=work.release,
    )  # fmt: skip


def _check_alike(first: HeightSource, tile: HeightSource, one: str, other: str) -> None:
    if (tile.crs, tile.degrees, tile.unit) != (first.crs, first.degrees, first.unit):
        raise MeshdepictError(
            f"{other} is in another coordinate reference system than {one}: reproject it first "
            "(gdalwarp)"
        )


def _size(linear: NDArray[np.float64]) -> str:
    wide, high = np.linalg.norm(linear, axis=0)
    return f"{wide:.12g} x {high:.12g}"
