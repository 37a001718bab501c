"""Making the scale space of a volume: which voxels are samples, and what they may take."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.grid_scales import GridSpace, opacity_of
from meshdepict.scales.grid_smoothing import GridSmoothing
from meshdepict.scales.ladder import MEMORY, TOLERANCE, Progress, checked_scales, reporter
from meshdepict.voxels.grid_normals import packed
from meshdepict.voxels.grid_samples import Samples, shaded_voxels
from meshdepict.voxels.grid_sums import Piece

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.shapes.volume import Volume
    from meshdepict.voxels.grid import Grid

__all__ = ["grid_space", "piece_space", "sample_bytes", "space_of_mask"]


def grid_space(
    volume: Volume,
    widths: NDArray[np.float64],
    ratio: float,
    *,
    where: NDArray[np.bool_] | None = None,
    transfer: TransferFunction | None = None,
    tolerance: float = TOLERANCE,
    memory: float = MEMORY,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> GridSpace:
    """Return normals at every width at the voxels of a volume that are shown, and beside them.

    Parameters
    ----------
    volume : Volume
    widths : (scales + 1,) array
        Of the Gaussians, in world units, the first 0.
    ratio : float
    where : (nz, ny, nx) array of bool, optional
        Voxels to be shaded; all others are left out.
    transfer : TransferFunction, optional
        In the volume's unit: voxels without opacity, and not beside one with, are left out.
    tolerance : float
        Largest angular error of a normal in radians, wherever the values change by 1e-3 of their
        range or more within one width.
    memory : float
        Bytes that the normals may take.
    at_once
        As for `scale_space`.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    MeshdepictError
        Where nothing is shown or nothing shown has a gradient, for normals that take more memory
        than allowed, and for `where` of another shape.
    """
    return space_of_mask(
        volume, shaded_voxels(volume, where, transfer), widths, ratio,
        transfer=transfer, tolerance=tolerance, memory=memory, at_once=at_once, progress=progress,
    )  # fmt: skip


def space_of_mask(
    volume: Volume,
    mask: NDArray[np.bool_],
    widths: NDArray[np.float64],
    ratio: float,
    *,
    transfer: TransferFunction | None,
    tolerance: float,
    memory: float,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> GridSpace:
    """Return the scale space of the voxels of a mask; see `grid_space`."""
    samples = Samples.of_mask(mask)
    if not len(samples):
        raise MeshdepictError(
            "no voxel of the volume is shown: lower the values where the opacity begins, "
            f"{volume.range[0]:g} to {volume.range[1]:g} is what there is"
        )
    needed = len(samples) * sample_bytes(len(widths))
    if needed > memory:
        raise MeshdepictError(
            f"the normals of {len(samples):,} voxels at {len(widths) - 1} scales take "
            f"{needed / 1e9:.2g} GB, more than the {memory / 1e9:.2g} GB allowed: show fewer "
            "voxels by a transfer function, allow more with memory=, or let bake_volume go slab by "
            "slab"
        )
    shape = volume.counts
    piece = Piece(volume.values, (0, 0, 0), (shape[0], shape[1], shape[2]), volume.range)
    space = piece_space(
        volume, piece, samples, widths, ratio,
        transfer=transfer, tolerance=tolerance, at_once=at_once, progress=progress,
    )  # fmt: skip
    if not space.count:
        raise MeshdepictError("the voxels shown are all alike, so that there is nothing to shade")
    return space


def sample_bytes(count: int) -> int:
    """Return the bytes that a voxel's normals at `count` scales take, with its place."""
    return 12 * count + 40


def piece_space(
    shape: Grid,
    piece: Piece,
    samples: Samples,
    widths: NDArray[np.float64],
    ratio: float,
    *,
    transfer: TransferFunction | None,
    tolerance: float,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> GridSpace:
    """Return the scale space of chosen voxels, of which a piece of the volume is at hand.

    It has no samples where none of them is left by the gradient opacity, or has a gradient.
    """
    smoothing = GridSmoothing(shape, piece, samples, tolerance)
    own, gradient = np.empty((3, len(samples)), np.float32), np.empty(len(samples))
    if len(samples):
        smoothing.fill(0.0, own, lengths=gradient)
        with np.errstate(over="ignore"):
            gradient *= piece.half_range / float(shape.spacing.min())
        np.minimum(gradient, np.finfo(np.float64).max, out=gradient)
    if transfer is not None and transfer.gradient_opacity is not None:
        keep = samples.beside(opacity_of(transfer, shape, piece, samples, gradient) > 0)
        smoothing, own, gradient = smoothing.kept(keep), own[:, keep], gradient[keep]
        samples = smoothing.samples
    planes = np.empty((len(widths), 3, len(samples)), np.float32)
    planes[0] = own
    del own
    wanted = checked_scales(at_once, len(widths) - 1) - {0}
    for number, scale in enumerate(sorted(wanted) if len(samples) else (), 1):
        done = reporter(progress, number, len(wanted))
        smoothing.fill(float(widths[scale]), planes[scale], done)
    first = smoothing.first_normals(planes, wanted, widths)
    bent = first >= 0
    flat = samples.kept(~bent)
    if len(flat):
        planes = packed(planes, bent, (0, *sorted(wanted)))
        first, gradient, smoothing = first[bent], gradient[bent], smoothing.kept(bent)
    space = GridSpace(
        smoothing, flat, gradient, widths, float(ratio), planes, first, transfer=transfer
    )
    space.adopt(wanted)
    return space
