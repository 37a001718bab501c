"""Baking volumes: from CT numbers and a method's name to an RGBA value for every voxel."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.baked import Depiction
from meshdepict.baking.budget import within_budget
from meshdepict.baking.choices import Choices
from meshdepict.baking.surfaces import refuse_other_scales
from meshdepict.baking.voxel_shading import VoxelShading, voxel_shading
from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scales.grid_making import sample_bytes, space_of_mask
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.scales.ladder import MEMORY, Progress
from meshdepict.shapes.height_grids import is_layer
from meshdepict.voxels.grid_samples import shaded_voxels
from meshdepict.voxels.grid_sums import Piece

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.drawing.figure import Figure
    from meshdepict.drawing.page import Page
    from meshdepict.shapes.volume import Volume

__all__ = ["BakedVolume", "as_volume", "bake_grid", "is_volume"]


class BakedVolume(Depiction):
    """Colour and opacity of every voxel, and how they came about.

    Attributes
    ----------
    shape : Volume
    space : GridSpace or None
        What was shaded, for the next light; None of a volume that was shaded slab by slab.
    intensity : (n,) or (n, 3) array of float32, or None
        What the method returned for the samples of the space.
    provenance, view, look
        As of every `Depiction`.
    shaded_share : float
        Shaded voxels over all voxels.
    """

    shape: Volume

    def __init__(
        self,
        shading: VoxelShading,
        *,
        space: GridSpace | None = None,
        intensity: NDArray[np.float32] | None = None,
        rgba: NDArray[np.uint8] | None = None,
        shaded_share: float,
    ) -> None:
        super().__init__(
            shading.shape, shading.provenance(space, shaded_share), shading.view,
            shading.look.replace(light=shading.light),
        )  # fmt: skip
        self.space, self.intensity = space, intensity
        self.shaded_share = shaded_share
        self._shading = shading
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
        return self._shading.transfer

    @property
    def linear(self) -> bool:
        """Whether the intensity is linear light, and not a display value."""
        return self._shading.linear

    @cached_property
    def rgba(self) -> NDArray[np.uint8]:
        """(nz, ny, nx, 4) sRGB and opacity; made when first asked for.

        All 0 where nothing is shown, but for colours without opacity beside what is: renderers
        interpolate, and black neighbours would draw seams.
        """
        assert self.space is not None
        assert self.intensity is not None
        rgba = np.zeros((*self.shape.counts, 4), np.uint8)
        self._shading.paint(self.space, self.intensity, rgba, (0, 0, 0))
        return rgba

    def save(self, path: str | Path) -> Path:
        """Write the voxels' RGBA on the volume's grid; the suffix decides the format.

        Raises
        ------
        MeshdepictError
            For a format that holds no volumes of RGBA, or where the file cannot be written.
        """
        from meshdepict.io.volumes import write_volume

        write_volume(path, self.rgba, self.shape, comments=self.comments)
        return Path(path)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.ImageData`` with the point data "RGBA"."""
        from meshdepict.shapes.exchange import image_of

        return image_of(self.rgba, self.shape, self.comments)

    def _page(self, figure: Figure) -> Page:
        """Return what `picture` writes."""
        from meshdepict.drawing.volume_picture import draw_volume_page

        return draw_volume_page(self, figure)


def bake_grid(
    volume: object, look: Choices, *, memory: float = MEMORY, progress: Progress | None = None
) -> BakedVolume:
    """Shade a volume; see `bake_volume`.

    Parameters
    ----------
    volume : path, Volume or GridSpace
    look : Choices
    memory, progress
        As for `bake_volume`.
    """
    if not (real(memory) or 0) > 0:
        raise MeshdepictError(f"memory={memory!r} is not a number of bytes above 0")
    begun = time.perf_counter()
    space = volume if isinstance(volume, GridSpace) else None
    allowed = None
    if look.budget is not None:
        volume = as_volume(volume) if space is None else volume
        shape: Any = volume if space is None else space.shape
        look, allowed = within_budget(look, shape, spent=time.perf_counter() - begun)
    baked = _bake_grid(volume, look, space, memory, progress)
    if allowed is not None:
        baked.provenance["budget"] = str(allowed)
    return baked


def _bake_grid(
    volume: Any,
    look: Choices,
    space: GridSpace | None,
    memory: float,
    progress: Progress | None,
) -> BakedVolume:
    chosen, look = look, look.of_kind("volume")
    if space is not None:
        refuse_other_scales(space, chosen)
        if chosen.transfer is not None and chosen.transfer is not space.transfer:
            raise MeshdepictError(
                "the transfer function comes too late: this GridSpace has been made with one; "
                "leave it out, or bake the volume"
            )
        made = {"scales": len(space.widths) - 1, "ratio": space.ratio, "transfer": space.transfer}
        look = look.replace(**made, tolerance=space.tolerance)
        space.smooth(look.reads(space.last).sets, progress=progress)
        shading = voxel_shading(space.shape, look, transfer=space.transfer, widths=space.widths)
    else:
        shape = as_volume(volume)
        shading = voxel_shading(shape, look, transfer=look.transfer)
        mask = shaded_voxels(shape, None, shading.transfer)
        counts = np.count_nonzero(mask, axis=(1, 2))
        if counts.sum() * sample_bytes(len(shading.widths)) > memory:
            return _by_slabs(shading, counts, memory, progress)
        space = space_of_mask(
            shape, mask, shading.widths, shading.ratio,
            transfer=shading.transfer, tolerance=look.tolerance, memory=memory,
            at_once=shading.sets, progress=progress,
        )  # fmt: skip
    shading = shading.settled(space)
    intensity = shading.shade(space)
    return BakedVolume(shading, space=space, intensity=intensity, shaded_share=space.shaded_share)


def is_volume(shape: object) -> bool:
    """Whether this is a volume, its scale space, its file or PyVista's image data of layers."""
    if isinstance(shape, (str, os.PathLike)):
        from meshdepict.io.volumes import is_volume_path

        return is_volume_path(shape)
    sampled = shape.shape if isinstance(shape, GridSpace) else shape
    image = hasattr(shape, "GetSpacing") and not is_layer(shape)
    return getattr(sampled, "kind", None) == "volume" or image


def as_volume(volume: object) -> Volume:
    """Return a `Volume` from a path, a Volume or a PyVista ``ImageData``."""
    from meshdepict.shapes.volume import Volume

    if isinstance(volume, Volume):
        return volume
    if isinstance(volume, (str, os.PathLike)):
        from meshdepict.io.volumes import read_volume

        return read_volume(volume)
    if hasattr(volume, "GetClassName"):  # of VTK: an image, or what says which call makes one
        return Volume.from_pyvista(volume)
    if hasattr(volume, "dask"):
        raise MeshdepictError(
            "a dask.array is shaded block by block: take bake_lazily, or bake_out_of_core; or make "
            "a Volume of it, which is read at once"
        )
    raise MeshdepictError(
        f"a {type(volume).__name__} is not a volume: give a path, a Volume, a GridSpace or a "
        "pyvista.ImageData"
    )


def _by_slabs(
    shading: VoxelShading, counts: NDArray[np.intp], memory: float, progress: Progress | None
) -> BakedVolume:
    """Shade slab by slab, none of which has more samples than memory allows."""
    shading.refuse_pieces(
        "their normals take more memory than allowed: allow more with memory=, or show fewer voxels"
    )
    values = shading.shape.values
    nz, ny, nx = values.shape
    piece = Piece(values, (0, 0, 0), (nz, ny, nx), shading.shape.range)
    shading = shading.settled_by(lambda begin, end: piece)
    rgba, shaded = np.zeros((nz, ny, nx, 4), np.uint8), 0
    most = memory / sample_bytes(len(shading.widths))
    for begin, end in _groups(counts, most):
        rgba[begin:end], count = shading.rgba(piece, (begin, 0, 0), (end, ny, nx))
        shaded += count
        if progress:
            progress(end, nz)
    return BakedVolume(shading, rgba=rgba, shaded_share=shaded / values.size)


def _groups(counts: NDArray[np.intp], most: float) -> Iterator[tuple[int, int]]:
    """Group slices, each with its neighbours counted along, up to a number of samples."""
    begin = 0
    while begin < len(counts):
        end = begin + 1
        while end < len(counts) and counts[max(begin - 1, 0) : end + 2].sum() <= most:
            end += 1
        yield begin, end
        begin = end
