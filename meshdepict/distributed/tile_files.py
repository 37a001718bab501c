"""What tiles of a mesh leave for each other: arrays in a folder that all workers see."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.distributed.tiling import Extent
from meshdepict.files.atomic import atomic_write

__all__ = ["Site"]


@dataclass(frozen=True)
class Site:
    """A mesh that is worked on by tiles.

    Attributes
    ----------
    path : Path
        Of the mesh.
    folder : Path
        For what tiles leave.
    extent : Extent
    tiles : int
        How many there are.
    parts : int
        Into how many ranges the rows of the file were cut.
    """

    path: Path
    folder: Path
    extent: Extent
    tiles: int = 0
    parts: int = 0

    def keep(self, name: str, array: NDArray[Any]) -> None:
        """Leave an array, wholly or not at all."""
        with atomic_write(self.folder / f"{name}.npy") as file:
            np.save(file, array)

    def find(self, name: str) -> Any:
        """Return an array, mapped into memory."""
        return np.load(self.folder / f"{name}.npy", mmap_mode="r")

    def keep_sorted(self, name: str, rows: NDArray[np.int64], tile: NDArray[Any]) -> None:
        """Leave rows in the order of their tiles, with where those of each begin."""
        order = np.argsort(tile, kind="stable")
        starts = np.searchsorted(tile[order], np.arange(self.tiles + 1))
        self.keep(name, rows[order])
        self.keep(f"{name}-starts", starts)

    def find_sorted(self, kind: str, tile: int) -> NDArray[np.int64]:
        """Return the rows of a tile from all ranges, in the file's order."""
        found = []
        for part in range(self.parts):
            starts = self.find(f"{kind}-{part}-starts")
            if starts[tile] < starts[tile + 1]:
                found.append(np.array(self.find(f"{kind}-{part}")[starts[tile] : starts[tile + 1]]))
        return np.concatenate(found)
