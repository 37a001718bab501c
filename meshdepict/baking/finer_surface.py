"""Detail of a finer mesh for the texture of a coarser one: where on it each texel's place is."""

from __future__ import annotations

import threading
import warnings
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.texture_choices import CAGE
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.lengths import resolve_width
from meshdepict.surface.closest_points import ClosestPoints
from meshdepict.transport.rays import ray_scene
from meshdepict.transport.surface_across import surface_across

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["FinerSurface"]


class FinerSurface:
    """A finer mesh of the same surface, seen from a coarser one.

    Parameters
    ----------
    mesh, finer : Mesh
    cage : float or str, optional
        In world units, or a share of the coarse mesh's diagonal.

    Attributes
    ----------
    misses : int
        Texels whose rays met nothing so far; they have the closest point instead.

    Raises
    ------
    MeshdepictError
        For meshes that lie apart.
    """

    def __init__(self, mesh: Mesh, finer: Mesh, cage: float | str | None = None) -> None:
        self._mesh, self._finer = mesh, finer
        try:
            self.cage = resolve_width(CAGE if cage is None else cage, mesh, averages=False)
        except MeshdepictError:
            raise MeshdepictError(
                f"cage={cage!r} is not a positive length such as 0.5 (world units) or '2%' (of the "
                "diagonal)"
            ) from None
        low = np.maximum(mesh.vertices.min(axis=0), finer.vertices.min(axis=0))
        high = np.minimum(mesh.vertices.max(axis=0), finer.vertices.max(axis=0))
        if (low - high > 2 * self.cage).any():
            raise MeshdepictError(
                "the finer mesh lies elsewhere than the mesh that gets its detail: give both in "
                "the same coordinates"
            )
        self.misses = self.texels = 0
        self._counting = threading.Lock()
        ray_scene(finer)  # once, and not by every thread
        _ = finer.outward_faces

    def begin(self) -> None:
        """Count from the beginning."""
        self.misses = self.texels = 0

    def tell(self) -> None:
        """Say how many texels look past the finer mesh."""
        if self.misses:
            warnings.warn(
                f"{self.misses:,} of {self.texels:,} texels met nothing of the finer mesh within "
                f"{self.cage:.4g} along their normals: they take its closest point (a larger "
                "--cage meets more)",
                MeshdepictWarning,
                stacklevel=4,
            )

    @property
    def described(self) -> str:
        """In words for provenance."""
        identity = self._finer.identity
        return f"of {identity} within {self.cage:.6g}, {self.misses} of {self.texels} texels missed"

    @cached_property
    def _closest(self) -> ClosestPoints:
        return ClosestPoints(self._finer.unit_points, self._finer.faces)

    def places(
        self, triangle: NDArray[np.int32], weights: NDArray[np.float32]
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Return triangles and barycentric coordinates on the finer mesh, for places on the other.

        Parameters
        ----------
        triangle, weights : (n,) and (n, 3) arrays
        """
        mesh, corners = self._mesh, self._mesh.faces[triangle]
        points = np.einsum("nc,ncx->nx", weights, mesh.vertices[corners])
        normals = np.einsum("nc,ncx->nx", weights, mesh.normals[corners])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.where(length > 1e-9, normals / np.where(length > 0, length, 1), (0, 0, 1))
        unit = self._finer.diagonal or 1.0
        points = self._finer.recentred(points)
        found, shares = surface_across(self._finer, points, normals, self.cage / unit)
        missed = np.flatnonzero(found < 0)
        with self._counting:
            self.misses += len(missed)
            self.texels += len(found)
            if len(missed):
                _ = self._closest
        if len(missed):
            found[missed], shares[missed] = self._closest.at(points[missed])
        return found, shares.astype(np.float32)
