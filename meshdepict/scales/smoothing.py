"""Smoothing of a mesh's normals: Gaussian sums weighted by area and facing, their directions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.patches import PatchSums
from meshdepict.surface.triangles import mixed_voronoi_areas
from meshdepict.threads import each, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["LEAST_RESULTANT", "NormalSums"]

# An angle is as accurate as the sums are small against the resultant ‖m‖: METHODS' rule says that
# below this share of the mass the tolerance no longer binds …
LEAST_RESULTANT = 1e-3
# … and that below this one the direction is meaningless and the next finer normal is kept.
_NO_RESULTANT = 1e-6

_SYMMETRIC = ((0, 0), (1, 1), (0, 1), (0, 2), (1, 2), (2, 2))
_NONE = np.empty((0, 3))


class NormalSums:
    """Area-weighted Gaussian sums of a mesh's normals, and the directions they point in."""

    def __init__(
        self,
        mesh: Mesh,
        facing: int,
        tolerance: float,
        widths: Iterable[float] = (),
        *,
        corner_normals: NDArray[np.float64] | None = None,
    ) -> None:
        self.unit = mesh.diagonal or 1.0
        self.facing = facing
        self.tolerance = tolerance
        self.points, self.channels = mesh.unit_points, self._channels(mesh, corner_normals)
        patches = getattr(mesh, "patches", None)  # beyond a crease is another surface
        scaled = [self.scaled(width) for width in widths]
        self._sums = PatchSums(patches, self.points, self.channels, scaled)

    def _channels(
        self, mesh: Mesh, corner_normals: NDArray[np.float64] | None
    ) -> NDArray[np.float64]:
        """Return what is summed, (c, n)."""
        if corner_normals is None:
            areas = mesh.unit_areas / (mesh.unit_areas.max() or 1.0)
            return np.array(self.moments(areas, mesh.normals.T, self.facing))
        # What lies round a vertex on several sides of a crease counts with the normals of all.
        points, apart = (
            mesh.unit_points[mesh.faces.ravel()],
            np.arange(mesh.faces.size).reshape(-1, 3),
        )
        areas = mixed_voronoi_areas(points, apart)
        moments = self.moments(areas, corner_normals.reshape(-1, 3).T, self.facing)
        at, count = mesh.faces.ravel(), len(mesh.vertices)
        channels = np.array([np.bincount(at, moment, minlength=count) for moment in moments])
        channels /= channels[0].max() or 1.0
        return channels

    def scaled(self, width: float) -> float:
        """Return a width in diagonals."""
        # Narrower than any two distinct positions can be apart, a Gaussian is a single point.
        return max(float(width) / self.unit, 1e-18)

    @staticmethod
    def moments(
        areas: NDArray[np.float64], n: NDArray[np.float64], facing: int
    ) -> list[NDArray[np.float64]]:
        """Return what is to be summed: A, A n and, for facing, A n nᵀ, of normals (3, n)."""
        # F is linear in r·n_j: facing needs the second moments Σ A G n nᵀ and nothing else. Their
        # trace is Σ A G.
        second = [areas * n[a] * n[b] for a, b in _SYMMETRIC[:-1]] if facing else []
        return [areas, *(areas * n), *second]

    def direction(
        self,
        width: float,
        finer: Callable[[], NDArray[Any]],
        done: Callable[[float], None] | None,
    ) -> NDArray[np.float64]:
        """Return the (3, n) unit normals at one width.

        ``finer`` returns the next finer ones. It is asked where facing looks along them, and else
        only where sums cancel.
        """
        # A first pass for resultants that are a fair share of the mass …
        error = self.tolerance / 4
        scaled = self.scaled(width)
        reference = finer() if self.facing else None
        sums = self._sums.at(scaled, error=error, done=done)
        vector, mass, share = self._resultant(sums, reference)
        # … and a second for those that cancel: there the sums must be that much finer. Nowhere
        # without mass is there a direction, or an error.
        weak = (mass > 0) & (error > self.tolerance * share)
        if weak.any():
            narrower = float(self.tolerance * share[weak].min())
            heaviest = float(sums[0].max())
            again = self._sums.at(scaled, error=narrower, targets=weak, heaviest=heaviest)
            along = None if reference is None else reference[:, weak]
            vector[:, weak], mass[weak], _ = self._resultant(again[:, weak], along)
        firm = self._directions(vector, mass, reference)
        if reference is not None or firm.all():
            return vector
        return np.where(firm, vector, finer())

    def _directions(
        self,
        vector: NDArray[np.float64],
        mass: NDArray[np.float64],
        reference: NDArray[Any] | None,
    ) -> NDArray[np.bool_]:
        """Make unit vectors of resultants, in their place, and say where they are long enough."""
        from meshdepict.scales.resultants import directions

        firm = np.empty(len(mass), np.bool_)
        instead = _NONE if reference is None else reference.T
        each(
            lambda a, b: directions(vector, mass, _NO_RESULTANT, instead, a, b, firm),
            spans(len(mass), thread_count()),
        )
        return firm

    def _resultant(
        self, sums: NDArray[Any], reference: NDArray[Any] | None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return m = Σ A F G n (3, n), its mass Σ A F G (n,), and its share of that (n,)."""
        from meshdepict.scales.resultants import resultants

        count = sums.shape[1]
        found, mass, share = np.empty((3, count)), np.empty(count), np.empty(count)
        rows = np.ascontiguousarray(sums.T)  # as they mostly are
        looking = _NONE if reference is None else reference.T
        each(
            lambda a, b: resultants(
                rows, looking, reference is not None, LEAST_RESULTANT, a, b, found, mass, share
            ),
            spans(count, thread_count()),
        )
        return found, mass, share
