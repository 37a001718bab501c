"""A raster of heights on the disk, of which windows are read: it may be larger than memory."""

from __future__ import annotations

import os
import warnings
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.any_numbers import any_numbers
from meshdepict.files.limits import as_text, check_claim, max_memory
from meshdepict.files.reach import regular
from meshdepict.heights.cells import Transform
from meshdepict.io.about_file import about_file
from meshdepict.io.doubtful_heights import doubts
from meshdepict.io.height_formats import open_source
from meshdepict.io.height_source import INFINITE, HeightSource
from meshdepict.io.height_units import chosen_unit
from meshdepict.io.tiles import mosaic

if TYPE_CHECKING:
    from meshdepict.shapes.height_field import HeightField

__all__ = ["Paths", "Terrain"]

Paths = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]


class Terrain:
    """A raster of heights, opened and not read.

    One thread at a time reads from it. Close it, or use it in a ``with`` statement.

    Parameters
    ----------
    paths : str, path-like or sequence of them
        A file as for `meshdepict.io.heightfields.read_heightfield`, or tiles of one grid.
    band : int
        Which of a raster's bands holds heights, from 1.
    unit : str, optional
        What heights are in ("m", "ft", "us-ft", …), whatever the file says.

    Attributes
    ----------
    rows, cols : int
    transform : tuple of six floats
        From columns and rows, counted from the first cell's corner, to x and y: `HeightField`'s.
    crs : str
    degrees : bool
    unit : float
        Metres of a unit of the transform.
    attributes : dict
        What else is known.

    Raises
    ------
    MeshdepictError
        For what is no raster of heights: one sentence that begins with the file's name.
    """

    def __init__(self, paths: Paths, *, band: int = 1, unit: str | None = None) -> None:
        files = _files(paths)
        self._opened = [os.path.abspath(path) for path in files], band, unit
        name = chosen_unit(unit)
        if isinstance(band, bool) or not isinstance(band, int):
            raise MeshdepictError(f"band={band!r} is no number of a band: the first is 1")
        sources: list[HeightSource] = []
        try:
            for path in files:
                with about_file(path):
                    regular(path)
                    sources.append(open_source(path, band, name))
                    if len(files) > 64:  # as many as are kept open
                        sources[-1].release()
            names = [str(path) for path in files]
            self._source = sources[0] if len(files) == 1 else mosaic(sources, names)
        except BaseException:
            for source in sources:
                source.release()
            raise
        self._name = names[0] if len(files) == 1 else f"{names[0]} and {len(files) - 1:,} more"
        self.rows, self.cols = self._source.rows, self._source.cols
        self.transform: Transform = self._source.transform
        self.crs, self.degrees = self._source.crs, self._source.degrees
        self.unit = self._source.unit
        self.attributes: dict[str, Any] = dict(self._source.attributes) | {"source": self._name}
        try:
            with about_file(self._name), any_numbers():
                notes = [note for source in sources for note in source.notes]
                notes += doubts(self._source)
        except BaseException:
            self.close()
            raise
        self._infinity_is_said = INFINITE in notes
        if notes:
            text = "; ".join(dict.fromkeys(notes))
            warnings.warn(f"{self._name}: {text}", MeshdepictWarning, stacklevel=2)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.cols

    @property
    def bytes_per_cell(self) -> int:
        """What a cell takes in memory: its height, and whether there is one."""
        return self._source.kind.itemsize + 1

    def check_whole(self) -> None:
        """Refuse to read all of it where so small a file can't honestly hold so many cells."""
        with about_file(self._name):
            check_claim(self.rows * self.cols * self.bytes_per_cell, self._source.size, "cells")

    def read(
        self, rows: slice | None = None, cols: slice | None = None
    ) -> tuple[NDArray[Any], NDArray[np.bool_]]:
        """Return the heights of a window in metres, 0 where there are none, and where there are.

        Parameters
        ----------
        rows, cols : slice, optional
            Without steps; None: all of them.

        Raises
        ------
        MeshdepictError
            For damaged files, and windows that memory doesn't hold.
        """
        down, across = _span(rows, self.rows, "rows"), _span(cols, self.cols, "cols")
        count = (down.stop - down.start) * (across.stop - across.start)
        needed = count * self.bytes_per_cell
        with about_file(self._name):
            if needed > max_memory():
                raise MeshdepictError(
                    f"has {count:,} cells, which take more than the {as_text(max_memory())} of "
                    "memory that are allowed: work in windows (meshdepict relief), or allow more "
                    "with --max-memory"
                )
            with any_numbers():
                z, valid, infinite = self._source.read(down, across)
        if infinite and not self._infinity_is_said:
            self._infinity_is_said = True
            warnings.warn(f"{self._name}: {INFINITE}", MeshdepictWarning, stacklevel=2)
        return z, valid

    def window(self, rows: slice | None = None, cols: slice | None = None) -> HeightField:
        """Return a part as a `HeightField` at its place; see `read`."""
        from meshdepict.shapes.height_field import window_of
        from meshdepict.shapes.raster_place import RasterPlace

        down, across = _span(rows, self.rows, "rows"), _span(cols, self.cols, "cols")
        z, valid = self.read(down, across)
        with about_file(self._name):
            if not valid.any():
                raise MeshdepictError("holds no heights: all of its cells are no data")
            place = RasterPlace(
                self.rows, self.cols, self.transform,
                crs=self.crs, degrees=self.degrees, unit=self.unit,
            )  # fmt: skip
            return window_of(place, down.start, across.start, z, valid, attributes=self.attributes)

    def close(self) -> None:
        """Close the files; reading opens them again."""
        self._source.release()

    def __enter__(self) -> Terrain:
        """Return itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the files."""
        self.close()

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what opens the same files in another process."""
        return _again, self._opened

    def __repr__(self) -> str:
        """Return the size and the file."""
        return f"<Terrain: {self.rows} x {self.cols} cells of {self._name}>"


def _again(paths: Sequence[str], band: int, unit: str | None) -> Terrain:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what is odd was said when it was opened first
        return Terrain(paths[0] if len(paths) == 1 else paths, band=band, unit=unit)


def _span(given: slice | None, count: int, name: str) -> slice:
    """Return a slice with its two ends.

    Raises
    ------
    MeshdepictError
        For steps, and a slice of nothing.
    """
    start, stop, step = (given or slice(None)).indices(count)
    if step != 1 or stop <= start:
        raise MeshdepictError(f"{name}={given!r} is no window of {count:,} {name}")
    return slice(start, stop)


def _files(paths: Paths) -> list[Path]:
    if isinstance(paths, (str, os.PathLike)):
        return [Path(paths)]
    found = [Path(path) for path in paths]
    if not found:
        raise MeshdepictError("there are no tiles: give one file or several")
    twice = [path for path, count in Counter(found).items() if count > 1]
    if twice:
        raise MeshdepictError(f"{twice[0]} is named twice among the tiles")
    return found
