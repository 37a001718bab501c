"""Shading voxels: all that it takes but the voxels themselves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.choices import Choices
from meshdepict.baking.provenance import describe
from meshdepict.errors import MeshdepictError
from meshdepict.scales.grid_making import piece_space
from meshdepict.scales.grid_scales import GridSpace, typical_slices
from meshdepict.scales.ladder import check_ladder, ladder
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import Lighting
from meshdepict.scene.view import View
from meshdepict.shapes.lengths import resolve_width
from meshdepict.threads import each, spans
from meshdepict.voxels.grid import Triple
from meshdepict.voxels.grid_samples import Samples, grown
from meshdepict.voxels.grid_sums import Piece

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.voxels.grid import Grid

__all__ = ["BESIDE", "VoxelShading", "voxel_shading"]

BESIDE = 2
"""How many voxels around a box have a say in it, beyond what their own normals reach."""

_PART = 1 << 16  # samples coloured at a time, in parallel and in the cache

_FLAT = 0.5  # display value of what is shown but has no normal: the middle of all methods


@dataclass(frozen=True)
class VoxelShading:
    """All that shading voxels takes but the voxels: the same for a volume, a slab or a block."""

    shape: Grid
    look: Choices
    light: Lighting
    view: View
    widths: NDArray[np.float64]
    ratio: float
    tolerance: float
    transfer: TransferFunction | None

    @property
    def linear(self) -> bool:
        """Whether the method's values are linear."""
        return self.look.declared.linear

    def settled(self, space: ScaleSpace) -> VoxelShading:
        """Return the same with numbers for the options that follow the shape."""
        return replace(self, look=self.look.settled(space))

    def settled_by(self, piece_of: Callable[[int, int], Piece]) -> VoxelShading:
        """Return the same as `settled` does, of a volume that is at hand in pieces.

        Parameters
        ----------
        piece_of : callable (begin, end) → Piece
            What normals in some slices along z need.
        """
        if not self.look.following:
            return self
        nz, ny, nx = self.shape.counts

        def between(begin: int, end: int) -> ScaleSpace:
            space, _ = self._space(piece_of(begin, end), (begin, 0, 0), (end, ny, nx))
            if space is not None:
                return space.between(begin, end)
            none = np.empty((3, 0), np.float32)
            return ScaleSpace(self.shape, np.empty((0, 3)), self.widths, self.ratio, none)

        return self.settled(typical_slices(between, nz))

    @property
    def sets(self) -> frozenset[int]:
        """The scales whose normals are read."""
        return self.look.reads(len(self.widths) - 1).sets

    def shade(self, space: GridSpace) -> NDArray[np.float32]:
        """Return the method's values for the samples of a space."""
        shaded: NDArray[np.float32] = self.look.shade(space, self.light, self.view)
        return shaded

    def paint(
        self,
        space: GridSpace,
        intensity: NDArray[np.float32],
        rgba: NDArray[np.uint8],
        corner: Triple,
    ) -> None:
        """Fill in the samples of an array (z, y, x, 4) that begins at a voxel."""
        out, box = rgba.reshape(-1, 4), (rgba.shape[0], rgba.shape[1], rgba.shape[2])
        at, base, alpha = space.samples.flat(box, corner), space.base_color, space.alpha

        def fill(a: int, b: int) -> None:
            light = intensity[a:b] if self.linear else color.srgb_to_linear(intensity[a:b])
            tinted = base[a:b] * (light if light.ndim == 2 else light[:, None])
            out[at[a:b], :3] = color.encode(tinted, linear=True)
            out[at[a:b], 3] = alpha[a:b]

        each(fill, spans(len(at), len(at) // _PART + 1))
        if len(space.flat):
            at = space.flat.flat(box, corner)
            dim = color.srgb_to_linear(np.float32(_FLAT))
            out[at, :3] = color.encode(space.color_at(space.flat) * dim, linear=True)
            out[at, 3] = space.opacity_at(space.flat, np.zeros(len(space.flat)))

    def rgba(self, piece: Piece, low: Triple, high: Triple) -> tuple[NDArray[np.uint8], int]:
        """Return RGBA of a box of the volume's voxels, and how many of them are shaded.

        Parameters
        ----------
        piece : Piece
            The box's values with those around that its normals take, and `BESIDE` voxels more.
        low, high : (z, y, x)
            The box.
        """
        begin, _ = _wider(low, high, BESIDE, self.shape.counts)
        space, size = self._space(piece, low, high)
        rgba, count = np.zeros((*size, 4), np.uint8), 0
        if space is not None:
            intensity = self.shade(space) if space.count else np.empty(0, np.float32)
            self.paint(space, intensity, rgba, begin)
            places = space.samples.indices()[:, ::-1]
            count = int(((places >= low) & (places < high)).all(axis=1).sum())
        return rgba[_box(low, high, begin)], count

    def _space(self, piece: Piece, low: Triple, high: Triple) -> tuple[GridSpace | None, Triple]:
        """Return the samples of a box and `BESIDE` voxels around, None without any; its size."""
        limits = self.shape.counts
        # One voxel further, neighbours compare their normals; two, they may be shown themselves,
        # and three, others make them neighbours of what is shown.
        begin, end = _wider(low, high, BESIDE, limits)
        wide_begin, wide_end = _wider(low, high, BESIDE + 1, limits)
        wide = _box(wide_begin, wide_end, piece.corner)
        shown = np.ones([b - a for a, b in zip(wide_begin, wide_end, strict=True)], bool)
        if self.transfer is not None:
            shown = grown(self.transfer.opacity(np.asarray(piece.values[wide])) > 0)
        shown = shown[_box(begin, end, wide_begin)]
        size = (shown.shape[0], shown.shape[1], shown.shape[2])
        if not shown.any():
            return None, size
        space = piece_space(
            self.shape, piece, Samples.of_mask(shown, begin), self.widths, self.ratio,
            transfer=self.transfer, tolerance=self.tolerance, at_once=self.sets,
        )  # fmt: skip
        return space, size

    def refuse_pieces(self, why: str) -> None:
        """Refuse a method that can't be had in pieces."""
        if not self.look.declared.local:
            raise MeshdepictError(f"{self.look.method} needs all voxels at once, and {why}")

    def provenance(self, space: GridSpace | None, share: float) -> dict[str, str]:
        """Return what was shaded, and how."""
        if space is None:
            none = Samples((0, 0, 0), np.zeros((0, 1), np.int64), np.zeros(0, np.int32))
            piece = Piece(np.zeros((0, 0, 0)), (0, 0, 0), (0, 0, 0), (0.0, 1.0))
            space = piece_space(
                self.shape, piece, none, self.widths, self.ratio,
                transfer=self.transfer, tolerance=self.tolerance,
            )  # fmt: skip
        described = describe(self.look, space, light=self.light)
        if self.transfer is not None:
            described["albedo"] = f"transfer function {self.transfer.name}"
        return described | {"shaded": f"{share:.3%} of the voxels"}


def _wider(
    low: Triple, high: Triple, margin: int, limits: tuple[int, ...]
) -> tuple[Triple, Triple]:
    """Return a box with a margin, within the grid."""
    a, b, c = (max(x - margin, 0) for x in low)
    d, e, f = (min(x + margin, n) for x, n in zip(high, limits, strict=True))
    return (a, b, c), (d, e, f)


def _box(low: Triple, high: Triple, corner: Triple) -> tuple[slice, ...]:
    """Return the slices of a box in an array that begins at a corner."""
    return tuple(slice(a - c, b - c) for a, b, c in zip(low, high, corner, strict=True))


def voxel_shading(
    shape: Grid,
    look: Choices,
    *,
    transfer: str | TransferFunction | None,
    widths: NDArray[np.float64] | None = None,
) -> VoxelShading:
    """Check all that shading a volume takes.

    Parameters
    ----------
    shape : Grid
    look : Choices
        Of a volume; see `Choices.of_kind`.
    transfer : str or TransferFunction, optional
        What is shown; the whole grid unless given.
    widths : (scales + 1,) array, optional
        Of a scale space that has been made; else they follow from the look.
    """
    from meshdepict.color.transfer import for_volume

    look = look.posed(shape)
    scales, ratio = look.ladder
    eye = look.eye(shape)
    if widths is None:
        check_ladder(scales, ratio, 0, look.tolerance)
        widths = ladder(scales, ratio, resolve_width(look.width, shape, eye))
    return VoxelShading(
        shape=shape,
        look=look,
        light=look.lighting(eye, shape.kind),
        view=eye,
        widths=widths,
        ratio=float(ratio),
        tolerance=look.tolerance,
        transfer=None if transfer is None else for_volume(transfer, shape),
    )
