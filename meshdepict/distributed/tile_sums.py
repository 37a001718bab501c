"""The normals of a tile at all widths, equal to those of the whole mesh.

Narrow Gaussians see the vertices of a halo around the tile. Of wider ones every tile has spread its
vertices on blocks of one grid, and the tile gathers from those within reach (`sums.shared_grid`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.distributed.tile_files import Site
from meshdepict.scales.smoothing import LEAST_RESULTANT, NormalSums
from meshdepict.sums.gaussian import MARGIN, GaussianSums
from meshdepict.sums.shared_grid import FINEST, Blocks, block_reach, gathered_sums, spread_blocks

__all__ = ["TileNormals", "channels_of", "halo_reach", "spread_tile"]


def halo_reach(tolerance: float) -> float:
    """Return how many widths away a vertex doesn't count any more."""
    return math.sqrt(2 * math.log(MARGIN / (tolerance * LEAST_RESULTANT)))


def channels_of(
    site: Site, tile: int, facing: int, largest: float, which: NDArray[np.bool_] | slice
) -> NDArray[np.float64]:
    """Return what is summed of some vertices of a tile, (c, n)."""
    areas = site.find(f"areas-{tile}")[which] / largest
    normals = site.find(f"normals-{tile}")[:, which]
    return np.array(NormalSums.moments(areas, normals, facing))


def spread_tile(
    site: Site, tile: int, widths: Sequence[float], facing: int, largest: float
) -> None:
    """Leave the blocks on which a tile's vertices are spread, for each width in world units."""
    unit = site.extent.diagonal or 1.0
    points = site.extent.recentred(np.asarray(site.find(f"points-{tile}")))
    channels = channels_of(site, tile, facing, largest, slice(None))
    for number, width in enumerate(widths):
        found = spread_blocks(points, channels, width / unit)
        site.keep(f"places-{tile}-{number}", found.places)
        site.keep(f"blocks-{tile}-{number}", found.values)


class TileNormals(NormalSums):
    """Directions of sums at the vertices of a tile.

    Parameters
    ----------
    site : Site
    tile : int
    facing : {0, 1}
    tolerance : float
    narrow, wide : sequences of float
        Widths in world units of which a halo is looked at, and those that were spread.
    largest : float
        Area of any vertex.

    Attributes
    ----------
    doubtful : int
        Vertices whose direction at some wide width may be off by more than the tolerance.
    """

    def __init__(
        self,
        site: Site,
        tile: int,
        *,
        facing: int,
        tolerance: float,
        narrow: Sequence[float],
        wide: Sequence[float],
        largest: float,
    ) -> None:
        self.unit = site.extent.diagonal or 1.0
        self.facing, self.tolerance = facing, tolerance
        self._sums: Any = self  # which `direction` asks: see `at`
        self._site, self._tile, self._largest = site, tile, largest
        self._wide = {self.scaled(width): number for number, width in enumerate(wide)}
        self._boxes = np.asarray(site.find("boxes"))
        self._own = site.extent.recentred(np.asarray(site.find(f"points-{tile}")))
        reach = max(narrow, default=0.0) * halo_reach(tolerance)
        points, channels = self._around(reach)
        self._near = GaussianSums(points, channels, [self.scaled(width) for width in narrow])
        self._count, self._met = channels.shape
        self._gathered: tuple[float, NDArray[np.float32]] = 0.0, np.empty((0, 0), np.float32)
        self.doubtful = 0

    def at(
        self,
        width: float,
        *,
        error: float,
        targets: NDArray[np.bool_] | None = None,
        heaviest: float | None = None,
        done: Callable[[float], None] | None = None,
    ) -> NDArray[Any]:
        """Return sums (c, n) at the tile's own vertices; see `GaussianSums.at`."""
        if width in self._wide:
            return self._from_blocks(width, error, targets)
        own = np.zeros(self._met, bool)
        own[: len(self._own)] = True if targets is None else targets
        # A first pass tells the largest mass, which a second one needs to know.
        found = self._near.at(width, error=error, targets=own, heaviest=heaviest or 0.0)
        if heaviest is None:
            heaviest = float(found[0].max())
            short = own & (heaviest > MARGIN * found[0])
            if short.any():
                again = self._near.at(width, error=error, targets=short, heaviest=heaviest)
                found = found.astype(again.dtype)
                found[:, short] = again[:, short]
        return found[:, : len(self._own)]

    def _from_blocks(
        self, width: float, error: float, targets: NDArray[np.bool_] | None
    ) -> NDArray[Any]:
        if self._gathered[0] != width:
            parts = self._parts(width, self._wide[width])
            self._gathered = width, gathered_sums(self._own, self._count, width, parts)
        sums = self._gathered[1]
        # The finest rule has been taken already: what isn't good enough is counted.
        bound = FINEST.error * float(sums[0].max())
        short = bound > error * sums[0]
        self.doubtful += int((short if targets is None else short & targets).sum())
        return sums

    def _parts(self, width: float, number: int) -> Iterator[Blocks]:
        """Yield what tiles spread that lie within reach."""
        _, reach = block_reach(width)
        for other in self._neighbours(reach * self.unit):
            name = f"{other}-{number}"
            yield Blocks(
                np.asarray(self._site.find(f"places-{name}")), self._site.find(f"blocks-{name}")
            )

    def _neighbours(self, reach: float) -> NDArray[np.intp]:
        """Return the tiles, itself among them, that lie within a reach in world units."""
        low, high = self._boxes[self._tile]
        lows, highs = self._boxes[:, 0], self._boxes[:, 1]
        near = ((lows <= high + reach) & (highs >= low - reach)).all(axis=1)
        return np.flatnonzero(near)

    def _around(self, reach: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the points and channels of the tile, and then of what lies around it."""
        low, high = self._boxes[self._tile]
        found = [(self._own, self._channels_of(self._tile, slice(None)))]
        for other in self._neighbours(reach):
            if other != self._tile:
                points = np.asarray(self._site.find(f"points-{other}"))
                near = ((points >= low - reach) & (points <= high + reach)).all(axis=1)
                if near.any():
                    unit = self._site.extent.recentred(points[near])
                    found.append((unit, self._channels_of(int(other), near)))
        points_found, channels = zip(*found, strict=True)
        return np.concatenate(points_found), np.concatenate(channels, axis=1)

    def _channels_of(self, tile: int, which: NDArray[np.bool_] | slice) -> NDArray[np.float64]:
        return channels_of(self._site, tile, self.facing, self._largest, which)
