"""Baking volumes: from CT numbers and a method's name to an RGBA value for every voxel."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.provenance import comment_lines
from meshdepict.baking.surfaces import refuse_other_scales
from meshdepict.baking.voxel_shading import VolumeRecipe, volume_recipe
from meshdepict.errors import MeshdepictError
from meshdepict.scales.grid_scales import MEMORY, GridSpace, sample_bytes, space_of_mask
from meshdepict.scales.ladder import Progress
from meshdepict.scene.view import View
from meshdepict.voxels.grid_samples import shaded_voxels
from meshdepict.voxels.grid_sums import Piece

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.shapes.volume import Volume

__all__ = ["BakedVolume", "bake_volume"]


class BakedVolume:
    """Colour and opacity of every voxel, and how they came about.

    Attributes
    ----------
    shape : Volume
    space : GridSpace or None
        What was shaded, for the next light; None of a volume that was shaded slab by slab.
    intensity : (n,) or (n, 3) array of float32, or None
        What the method returned for the samples of the space.
    provenance : dict of str
    view : View
        The view that names of lights referred to.
    shaded_share : float
        Shaded voxels over all voxels.
    """

    def __init__(
        self,
        recipe: VolumeRecipe,
        *,
        space: GridSpace | None = None,
        intensity: NDArray[np.float32] | None = None,
        rgba: NDArray[np.uint8] | None = None,
        shaded_share: float,
    ) -> None:
        self.shape: Any = recipe.shape
        self.view = recipe.view
        self.space, self.intensity = space, intensity
        self.shaded_share = shaded_share
        self.provenance = recipe.provenance(space, shaded_share)
        self._recipe = recipe
        if rgba is not None:
            self.rgba = rgba

    def __repr__(self) -> str:
        """Return method, size and share."""
        nz, ny, nx = self.shape.counts
        method = self.provenance["method"]
        return f"<BakedVolume: {method} on {self.shaded_share:.1%} of {nx} x {ny} x {nz} voxels>"

    @property
    def transfer(self) -> TransferFunction | None:
        """What is shown, in the volume's unit."""
        return self._recipe.transfer

    @property
    def linear(self) -> bool:
        """Whether the intensity is linear light, and not a display value."""
        return self._recipe.linear

    @cached_property
    def rgba(self) -> NDArray[np.uint8]:
        """(nz, ny, nx, 4) sRGB and opacity; made when first asked for.

        All 0 where nothing is shown, but for colours without opacity beside what is: renderers
        interpolate, and black neighbours would draw seams.
        """
        assert self.space is not None
        assert self.intensity is not None
        rgba = np.zeros((*self.shape.counts, 4), np.uint8)
        self._recipe.paint(self.space, self.intensity, rgba, (0, 0, 0))
        return rgba

    def save(self, path: str | Path) -> Path:
        """Write the voxels' RGBA on the volume's grid; the suffix decides the format.

        Raises
        ------
        MeshdepictError
            For a format that holds no volumes of RGBA, or where the file cannot be written.
        """
        from meshdepict.io.volumes import write_volume

        write_volume(path, self.rgba, self.shape, comments=comment_lines(self.provenance))
        return Path(path)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.ImageData`` with the point data "RGBA"."""
        from meshdepict.shapes.exchange import image_of

        return image_of(self.rgba, self.shape)


def bake_volume(
    volume: Any,
    method: str = "exaggerated",
    *,
    transfer: str | TransferFunction | None = None,
    light: Any = "northwest",
    view: str | View = "front",
    up: str = "z",
    scales: int | None = None,
    width: float | str | None = None,
    ratio: float | None = None,
    tolerance: float = 1e-4,
    memory: float = MEMORY,
    progress: Progress | None = None,
    **options: Any,
) -> BakedVolume:
    """Shade the voxels that a transfer function shows, in its colours.

    Parameters
    ----------
    volume : path, Volume or GridSpace
        A `GridSpace` is used as it is: a new light or method takes a moment.
    method : str
        A name of `shading.METHODS`. Those that cast rays need a surface, and say so.
    transfer : str or TransferFunction, optional
        Opacity and base colour; a preset's name, a .toml file or a function. "bone" unless given;
        a `GridSpace` has its own.
    light, view, up
        As for `bake`; z points up unless said otherwise, as in a patient's frame, so that "front"
        is the patient's. Normals point towards lower values.
    scales, width, ratio, tolerance
        See `scale_space`; None takes what the method declares, and for the width the largest
        spacing.
    memory : float
        Bytes that normals may take. Where they would take more, the volume is shaded slab by slab,
        and every new light starts from the beginning.
    progress : callable, optional
        ``progress(done, total)``.
    **options
        The method's own options.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range, where nothing is shown, and for methods that cannot
        be had slab by slab.
    """
    space = volume if isinstance(volume, GridSpace) else None
    if space is not None:
        asked = {"scales": scales, "width": width, "ratio": ratio, "tolerance": tolerance}
        refuse_other_scales(space, asked)
        if transfer is not None and transfer is not space.transfer:
            raise MeshdepictError(
                "the transfer function comes too late: this GridSpace has been made with one; "
                "leave it out, or bake the volume"
            )
        recipe = volume_recipe(
            space.shape, method, transfer=space.transfer, light=light, view=view, up=up,
            widths=space.widths, ratio=space.ratio, tolerance=space.tolerance, **options,
        )  # fmt: skip
    else:
        shape = as_volume(volume)
        recipe = volume_recipe(
            shape, method, transfer="bone" if transfer is None else transfer,
            light=light, view=view, up=up,
            scales=scales, width=width, ratio=ratio, tolerance=tolerance, **options,
        )  # fmt: skip
        mask = shaded_voxels(shape, None, recipe.transfer)
        counts = np.count_nonzero(mask, axis=(1, 2))
        if counts.sum() * sample_bytes(len(recipe.widths)) > memory:
            return _by_slabs(recipe, counts, memory, progress)
        space = space_of_mask(
            shape, mask, recipe.widths, recipe.ratio,
            transfer=recipe.transfer, tolerance=tolerance, memory=memory, progress=progress,
        )  # fmt: skip
    intensity = recipe.shade(space)
    return BakedVolume(recipe, space=space, intensity=intensity, shaded_share=space.shaded_share)


def as_volume(volume: Any) -> Volume:
    """Return a `Volume` from a path, a Volume or a PyVista ``ImageData``."""
    from meshdepict.shapes.volume import Volume

    if isinstance(volume, Volume):
        return volume
    if isinstance(volume, (str, os.PathLike)):
        from meshdepict.io.volumes import read_volume

        return read_volume(volume)
    if hasattr(volume, "GetSpacing") and hasattr(volume, "point_data"):
        return Volume.from_pyvista(volume)
    raise MeshdepictError(
        f"a {type(volume).__name__} is not a volume: give a path, a Volume, a GridSpace or a "
        "pyvista.ImageData"
    )


def _by_slabs(
    recipe: VolumeRecipe, counts: NDArray[np.intp], memory: float, progress: Progress | None
) -> BakedVolume:
    """Shade slab by slab, none of which has more samples than memory allows."""
    recipe.refuse_pieces(
        "their normals take more memory than allowed: allow more with memory=, or show fewer voxels"
    )
    values = recipe.shape.values
    nz, ny, nx = values.shape
    piece = Piece(values, (0, 0, 0), (nz, ny, nx), recipe.shape.range)
    rgba, shaded = np.zeros((nz, ny, nx, 4), np.uint8), 0
    most = memory / sample_bytes(len(recipe.widths))
    for begin, end in _groups(counts, most):
        rgba[begin:end], count = recipe.rgba(piece, (begin, 0, 0), (end, ny, nx))
        shaded += count
        if progress:
            progress(end, nz)
    return BakedVolume(recipe, rgba=rgba, shaded_share=shaded / values.size)


def _groups(counts: NDArray[np.intp], most: float) -> Iterator[tuple[int, int]]:
    """Group slices, each with its neighbours counted along, up to a number of samples."""
    begin = 0
    while begin < len(counts):
        end = begin + 1
        while end < len(counts) and counts[max(begin - 1, 0) : end + 2].sum() <= most:
            end += 1
        yield begin, end
        begin = end
