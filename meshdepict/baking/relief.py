"""Shaded relief of a terrain, window by window: as large as the disk, in bounded memory."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.budget import Predicted, within_budget
from meshdepict.baking.choice_list import HEIGHTS
from meshdepict.baking.choices import Choices
from meshdepict.baking.layers import Layered
from meshdepict.baking.provenance import describe
from meshdepict.baking.sample_shading import SampleShading
from meshdepict.baking.tinting import spanned_tint
from meshdepict.baking.windows import Cut, Window, cut_for
from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import max_memory
from meshdepict.heights.spread_cells import is_large, typical_cells, typical_places
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.gathered import GatheredSamples
from meshdepict.scales.height_scales import HeightSpace, height_space
from meshdepict.scales.ladder import Progress, check_ladder, ladder
from meshdepict.scales.light_errors import FoundRays
from meshdepict.scales.reads import Reads
from meshdepict.shading.sampled import AUTO_RAYS
from meshdepict.shapes.height_field import HeightField, window_of
from meshdepict.shapes.lengths import resolve_width
from meshdepict.shapes.raster_extent import RasterExtent

__all__ = ["HeightWindows", "Relief", "Shaded"]

Floats = NDArray[np.float64]

_PATCH = 64  # cells along the sides of what stands for all of it in predictions
_CELLS = 1 << 22  # that are read at once where all heights are looked at


class HeightWindows(Protocol):
    """A raster of heights of which windows can be read; see `io.terrain.Terrain`."""

    rows: int
    cols: int
    transform: Any
    crs: str
    degrees: bool
    unit: float
    attributes: dict[str, Any]

    def read(self, rows: slice, cols: slice) -> tuple[NDArray[Any], NDArray[np.bool_]]:
        """Return heights in metres, and where there are any."""


class Shaded(NamedTuple):
    """A window in its shading.

    Attributes
    ----------
    rows, columns : slice
        Of the raster.
    colors : (h, w, 3) array of uint8
        sRGB; 0 where there is no height.
    values : (h, w) or (h, w, 3) array of float32
        What the method returned, in [0, 1]; NaN where there is no height.
    valid : (h, w) array of bool
    """

    rows: slice
    columns: slice
    colors: NDArray[np.uint8]
    values: NDArray[np.float32]
    valid: NDArray[np.bool_]


Each = Callable[[Iterable[Window]], Iterable[Shaded]]


class Relief:
    """How a terrain is shaded; `windows` does it.

    Parameters
    ----------
    terrain : HeightWindows or HeightField
    look : Choices
    spent : float
        Seconds of the look's budget that are gone already.
    memory : float, optional
        Bytes that a window may take; half of the machine's memory unless given, or as
        `files.limits.set_max_memory` was told.

    Attributes
    ----------
    look : Choices
        With all that followed from the terrain.
    extent : RasterExtent
    cut : Cut
    provenance : dict of str
    kind : {"gray", "color"}
        What its colours are.

    Raises
    ------
    MeshdepictError
        For choices that are about other shapes, and windows that memory doesn't hold.
    """

    def __init__(
        self,
        terrain: HeightWindows | HeightField,
        look: Choices,
        *,
        memory: float | None = None,
        spent: float = 0.0,
    ) -> None:
        self._given: Any = terrain
        self._terrain = _InMemory(terrain) if isinstance(terrain, HeightField) else terrain
        self._memory = max_memory() if memory is None else memory
        self.extent = self._extent(look)
        look, allowed = self._within(look, spent)
        chosen, look = look, look.of_kind(HEIGHTS)
        if look.refine is not None or look.albedo == "keep":
            word = "refine" if look.refine is not None else "albedo"
            raise MeshdepictError(f"{word} is about a mesh, and this is terrain: leave it out")
        self._layered = None if look.blend is None else _layered(chosen, look)
        self._scales, self._ratio = look.ladder
        check_ladder(self._scales, self._ratio, look.facing, look.tolerance)
        self.eye = look.eye(self.extent)
        self._widths = ladder(
            self._scales, self._ratio, resolve_width(look.width, self.extent, self.eye)
        )
        self._light = look.lighting(self.eye, HEIGHTS)
        self.look = look
        self.cut = self._cut(look)
        typical = GatheredSamples(
            self.extent, self._typical, self._widths, self._ratio, tolerance=look.tolerance
        )
        if self._layered is None:
            self.look = look.settled(typical)
        else:
            settled = self._layered.settle(dict.fromkeys(self._layered.ladders, typical))
            self.look = look.replace(blend=settled.blend, scales=chosen.scales, ratio=chosen.ratio)
        if look.tint is not None:
            self.look = self.look.replace(tint=spanned_tint(look.tint, self._span))
        found = self._find_rays()
        self.provenance = describe(self.look, typical, light=self._light)
        if found is not None:
            self.provenance["rays auto"] = str(found)
        if allowed is not None:
            self.provenance["budget"] = str(allowed)
        if look.z_factor != 1:
            self.provenance["z factor"] = f"{look.z_factor:g}"
        self.kind, self.bands = self._looks()

    @property
    def widths(self) -> NDArray[np.float64]:
        """(scales + 1,) widths in metres, the first 0."""
        return self._widths

    @property
    def linear(self) -> bool:
        """Whether values are linear light."""
        return self._layered is None and self.look.declared.linear

    def windows(
        self, progress: Progress | None = None, *, each: Each | None = None
    ) -> Iterator[Shaded]:
        """Shade window after window.

        Parameters
        ----------
        progress : callable, optional
            ``progress(done, total)``.
        each : callable, optional
            Shades windows as `shade` does, in any order: by other processes, perhaps.

        Raises
        ------
        MeshdepictError
            Where the terrain can't be read, or no cell of it has a height.
        """
        some, windows = False, self.cut.windows()
        for done, part in enumerate(map(self.shade, windows) if each is None else each(windows), 1):
            some = some or bool(part.valid.any())
            yield part
            if progress:
                progress(done, len(self.cut))
        if not some:
            raise MeshdepictError(f"{self.extent.name or 'the terrain'} holds no heights")

    def shade(self, window: Window) -> Shaded:
        """Shade a window."""
        return self._shaded(self._field(window), window)

    def save(
        self,
        path: str | Path,
        *,
        values: bool = False,
        progress: Progress | None = None,
        each: Each | None = None,
    ) -> Path:
        """Shade all windows and write them on the terrain's grid; see `io.relief_files`.

        Parameters
        ----------
        path : path
            Ends in .tif (GeoTIFF), .png or .jpg (with a world file).
        values : bool
            Write what the method returns, as float32 in a GeoTIFF, and no colours.
        progress, each
            As for `windows`.

        Raises
        ------
        MeshdepictError
            As `windows`, for another suffix, values of several bands, and where the file can't be
            written.
        """
        from meshdepict.io.relief_files import relief_writer

        if values and self.bands > 1:
            raise MeshdepictError(
                f"{self.look.title} gives colours, and no single value a cell: leave --values out"
            )
        kind = "values" if values else self.kind
        with relief_writer(path, like=self._given, kind=kind, provenance=self.provenance) as out:
            for part in self.windows(progress, each=each):
                shown = part.colors[..., 0] if kind == "gray" else part.colors
                out.write(part.rows, part.columns, part.values if values else shown, part.valid)
        return Path(path)

    def _within(self, look: Choices, spent: float) -> tuple[Choices, Predicted | None]:
        """Return a look that its budget allows: predicted by a level patch, for all cells."""
        if look.budget is None:
            return look, None
        level = np.zeros((_PATCH, _PATCH), np.float32)
        patch = window_of(self.extent, 0, 0, level, np.ones(level.shape, bool))
        cells = self._terrain.rows * self._terrain.cols
        return within_budget(look, patch, spent=spent, writes=True, cells=cells)

    def _find_rays(self) -> FoundRays | None:
        """Find how many rays it takes, if that is asked: what has rays is one window."""
        looks = [self.look] if self._layered is None else self._layered.looks
        if all(each.options.get("rays") != AUTO_RAYS for each in looks):
            return None
        field = self._field(next(iter(self.cut.windows())))
        if field is None:
            return None
        space = self._space(field)
        if self._layered is None:
            self.look = self.look.with_rays(space, self._light, self.eye)
            return space.light_errors.found
        spaces = dict.fromkeys(self._layered.ladders, space)
        self.look = self.look.replace(blend=self._layered.find_rays(spaces, self.eye).blend)
        return None

    # --- one window -------------------------------------------------------------------------

    def _field(self, window: Window) -> HeightField | None:
        """Return a window with what is around it; None without a height where any is wanted."""
        z, valid = self._terrain.read(window.outer_rows, window.outer_columns)
        if not valid[window.inner].any():
            return None
        row, column = window.outer_rows.start, window.outer_columns.start
        field = window_of(self.extent, row, column, z, valid)
        return field.raised(self.look.z_factor)

    def _space(self, field: HeightField) -> HeightSpace:
        """Return its scale space, with what the method reads."""
        return height_space(
            field, self._widths, self._ratio, tolerance=self.look.tolerance,
            at_once=self._reads().sets,
        )  # fmt: skip

    def _shaded(self, field: HeightField | None, window: Window) -> Shaded:
        shape = tuple(part.stop - part.start for part in window[:2])
        if field is None:
            values = np.full(shape, np.nan, np.float32)
            nothing = np.zeros(shape, bool)
            return Shaded(*window[:2], np.zeros((*shape, 3), np.uint8), values, nothing)
        intensity, colors = self._painted(self._space(field))
        inner = window.inner
        return Shaded(
            *window[:2],
            field.image(colors)[inner],
            field.image(intensity.astype(np.float32), background=np.nan)[inner],
            field.valid[inner],
        )

    def _painted(self, space: HeightSpace) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """Return what the method makes of some samples, and their colours."""
        shading = SampleShading(self.look, self._light, self.eye, self._layered)
        intensity = shading.values(dict.fromkeys(shading.ladders, space))
        heights = space.points[:, 2] / self.look.z_factor
        return intensity, shading.colors(intensity, lambda: heights)

    # --- all of it --------------------------------------------------------------------------

    def _looks(self) -> tuple[str, int]:
        """Return what colours a level patch gets, "gray" or "color", and of how many values."""
        patch = window_of(self.extent, 0, 0, np.zeros((3, 3), np.float32), np.ones((3, 3), bool))
        intensity, _ = self._painted(self._space(patch))
        gray = intensity.ndim == 1 and self.look.colormap is None and self.look.tint is None
        return "gray" if gray else "color", 1 if intensity.ndim == 1 else intensity.shape[1]

    def _cut(self, look: Choices) -> Cut:
        looks = [look] if self._layered is None else self._layered.looks
        around = max(_around(each, each.reads(self._scales)) for each in looks)
        return cut_for(
            self.extent, self._widths, self._reads(),
            tolerance=look.tolerance, around=around, memory=self._memory,
        )  # fmt: skip

    def _reads(self) -> Reads:
        if self._layered is not None:
            return self._layered.reads(self._layered.ladders[0], self._scales)
        return self.look.reads(self._scales)

    def _extent(self, look: Choices) -> RasterExtent:
        """Return where the terrain lies; with its heights where widths or lengths depend on them.

        Shares of the diagonal and pixels of the view do, and are those of `bake`.
        """
        source, filled = self._terrain, None
        if isinstance(look.width, str) and any(mark in look.width for mark in ("%", "px")):
            rows, columns, low, high = self._filled
            filled = rows, columns, low * look.z_factor, high * look.z_factor
        return RasterExtent(
            source.rows, source.cols, source.transform, crs=source.crs, degrees=source.degrees,
            unit=source.unit, filled=filled, name=str(source.attributes.get("source", "")),
        )  # fmt: skip

    @functools.cached_property
    def _filled(self) -> tuple[Floats, Floats, float, float]:
        """Which rows and columns hold heights, and between what, in one pass over everything."""
        source = self._terrain
        rows, columns = np.zeros(source.rows, bool), np.zeros(source.cols, bool)
        low, high = np.inf, -np.inf
        step = max(1, _CELLS // source.cols)
        for top in range(0, source.rows, step):
            span = slice(top, min(top + step, source.rows))
            z, valid = source.read(span, slice(0, source.cols))
            if valid.any():
                rows[span], columns = valid.any(axis=1), columns | valid.any(axis=0)
                heights = z[valid]
                low, high = min(low, float(heights.min())), max(high, float(heights.max()))
        if not rows.any():
            name = source.attributes.get("source", "the terrain")
            raise MeshdepictError(f"{name} holds no heights")
        down, across = (np.flatnonzero(some).astype(np.float64) for some in (rows, columns))
        return down, across, low, high

    def _span(self) -> tuple[float, float]:
        """Return the least and the largest height of the ground."""
        return self._filled[2:]

    def _typical(self) -> Iterator[ChosenSamples]:
        """Yield the samples that numbers are fitted to, those of `HeightSpace.typical`."""
        for window, cells in self._typical_windows():
            field = self._field(window)
            if field is None:
                continue
            chosen = np.zeros(field.valid.shape, bool)
            chosen[window.inner] = cells
            chosen &= field.valid
            if chosen.any():
                yield ChosenSamples(self._space(field), np.flatnonzero(field.sample(chosen)))

    def _typical_windows(self) -> Iterator[tuple[Window, NDArray[np.bool_]]]:
        """Yield windows that hold some of them, with which of their own cells these are."""
        columns, rows = self.extent.size
        if len(self.cut) > 1 and is_large(rows, columns):
            for down, across in typical_places(rows, columns):
                shape = down.stop - down.start, across.stop - across.start
                yield self.cut.around(down, across), np.ones(shape, bool)
            return
        for window in self.cut.windows():
            cells = typical_cells(rows, columns, window.rows, window.columns)
            if cells.any():
                yield window, cells


def _layered(chosen: Choices, look: Choices) -> Layered:
    """Return the layers of a look; refuse those that are smoothed differently."""
    layered = Layered(chosen.replace(view=look.view, up=look.up), HEIGHTS)
    if len({*layered.ladders}) > 1:
        names = " and ".join(dict.fromkeys(each.method for each in layered.looks if each.ladder[0]))
        raise MeshdepictError(
            f"{names} are smoothed at different widths, and relief smooths once: give scales and "
            "ratio for all of the blend"
        )
    return layered


def _around(look: Choices, reads: Reads) -> float:
    """Return how many cells around one a method looks at, beside what its widths take in."""
    if reads.around is not None:
        return reads.around
    if reads.rays:
        return np.inf
    averages = bool(reads.means)  # which look as far as their widths
    return 0.0 if look.declared.local or averages else np.inf


class _InMemory:
    """A height field as windows of it."""

    def __init__(self, field: HeightField) -> None:
        self._field = field
        self.cols, self.rows = field.size
        self.transform, self.crs = field.transform, field.crs
        self.degrees, self.unit = field.degrees, field.unit
        self.attributes = field.attributes

    def read(self, rows: slice, cols: slice) -> tuple[NDArray[Any], NDArray[np.bool_]]:
        """Return heights, and where there are any."""
        return self._field.z[rows, cols], self._field.valid[rows, cols]
