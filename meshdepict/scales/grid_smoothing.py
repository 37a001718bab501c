"""Normals of a grid at one width: of all samples, or of some, with the numbers of all."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.voxels.grid_normals import gradients_to_world, in_voxels, least_gradient
from meshdepict.voxels.grid_samples import Samples
from meshdepict.voxels.grid_sums import GRADIENT, GridSums, Piece

if TYPE_CHECKING:
    from meshdepict.voxels.grid import Grid

__all__ = ["GridSmoothing"]

Singles = NDArray[np.float32]
Numbers = NDArray[np.intp]


class GridSmoothing:
    """What makes the normals −∇f/‖∇f‖ of samples of a grid at any width.

    Attributes
    ----------
    sums : GridSums
        Of all samples.
    """

    def __init__(self, grid: Grid, piece: Piece, samples: Samples, tolerance: float) -> None:
        self.grid, self.piece, self.samples, self.tolerance = grid, piece, samples, tolerance
        self.sums = GridSums(piece, samples, tolerance)

    def kept(self, keep: NDArray[np.bool_]) -> GridSmoothing:
        """Return the same for some of the samples."""
        return GridSmoothing(self.grid, self.piece, self.samples.kept(keep), self.tolerance)

    def fill(
        self,
        width: float,
        out: Singles,
        done: Callable[[float], None] | None = None,
        *,
        lengths: NDArray[np.float64] | None = None,
    ) -> None:
        """Fill in normals (3, n), zero where there is no gradient, and the gradients' lengths."""
        from meshdepict.voxels.gaussian_gradient import normalise

        self.sums.derivatives(in_voxels(width, self.grid), GRADIENT, out, done)
        floor = least_gradient(width, self.grid)
        normalise(out, gradients_to_world(self.grid), floor, None, lengths)

    def of_some(self, some: Numbers, width: float) -> Singles:
        """Return the normals (3, k) of the samples of some numbers, in their order."""
        keep = np.zeros(len(self.samples), bool)
        keep[some] = True
        out = np.empty((3, len(some)), np.float32)
        self.kept(keep).fill(width, out)
        return out

    def first_normals(
        self, planes: Singles, there: set[int], widths: NDArray[np.float64]
    ) -> NDArray[np.int8]:
        """Give samples without a gradient the normals of the first scale at which they have one.

        Parameters
        ----------
        planes : (scales + 1, 3, n) array
            Zero where there is no gradient; the first set is filled in.
        there : set of int
            The scales whose sets are there.
        widths : (scales + 1,) array

        Returns
        -------
        (n,) array
            That scale; −1 where there is none.
        """
        first = np.zeros(planes.shape[2], np.int8)
        missing = np.flatnonzero(~planes[0].any(axis=0))
        for scale in range(1, len(widths)):
            if not len(missing):
                break
            found = (
                planes[scale][:, missing]
                if scale in there
                else self.of_some(missing, float(widths[scale]))
            )
            bent = found.any(axis=0)
            first[missing[bent]] = scale
            planes[0][:, missing[bent]] = found[:, bent]
            missing = missing[~bent]
        first[missing] = -1
        return first

    def fall_back(
        self,
        scale: int,
        planes: Singles,
        there: set[int],
        widths: NDArray[np.float64],
        first: NDArray[np.int8],
    ) -> None:
        """Give samples without a gradient at a scale the normals of the next finer one.

        Those that have none up to there have the unsmoothed set's, their first ones.
        """
        out = planes[scale]
        bare = np.flatnonzero(~out.any(axis=0))
        early = first[bare] > scale
        out[:, bare[early]] = planes[0][:, bare[early]]
        bare = bare[~early]
        for finer in range(scale - 1, -1, -1):
            if not len(bare):
                return
            found = (
                planes[finer][:, bare]
                if finer in there
                else self.of_some(bare, float(widths[finer]))
            )
            out[:, bare] = found
            bare = bare[~found.any(axis=0)]
