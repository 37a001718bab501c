"""The scale space of a mesh: Gaussian sums over its vertices, curvature from its triangles."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import Progress
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.patches import PatchSums
from meshdepict.scales.smoothing import NormalSums
from meshdepict.scales.space import ScaleSpace
from meshdepict.shapes.mesh import Mesh

if TYPE_CHECKING:
    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.transport.occlusion import Openness

__all__ = ["MeshSpace", "mesh_space"]

# Of the area: the mean normal's length from which on a mesh is a sheet; a half sphere has 0.5.
_SHEET = 0.4

# Of a mean value, relative: at unsharp masking's default amount less than half a grey level.
_ERROR = 1e-3


class MeshSpace(ScaleSpace):
    """Samples at the vertices of a mesh."""

    shape: Mesh
    at_vertices = True

    def __init__(
        self,
        mesh: Mesh,
        widths: NDArray[np.float64],
        ratio: float,
        own: NDArray[np.float64],
        corners: NDArray[np.float64] | None = None,
        *,
        facing: int,
        tolerance: float,
    ) -> None:
        super().__init__(
            mesh, mesh.vertices, widths, ratio, own.T, facing=facing, tolerance=tolerance
        )
        self._corners = corners
        # The coarsest normals so far, not yet rounded: the next scale looks along them.
        self._coarsest: tuple[int, NDArray[Any]] = 0, own.T

    @property
    def unit_points(self) -> NDArray[np.float64]:
        """(n, 3) vertices moved to the origin and scaled to a diagonal of one."""
        return self.shape.unit_points

    @property
    def surface(self) -> Mesh:
        """The mesh itself, or that of all that stand together."""
        return self.shape if self.company is None else self.company.surface

    @property
    def own_surface(self) -> Mesh:
        """The mesh itself."""
        return self.shape

    @property
    def vertical(self) -> NDArray[np.float64]:
        """The axis that a sheet looks along most: up of terrain, to the eye of a tablet's face."""
        mean = self.shape.unit_areas @ self.shape.normals
        if np.linalg.norm(mean) < _SHEET * self.shape.unit_areas.sum():
            return super().vertical
        axis = int(np.abs(mean).argmax())
        found = np.zeros(3)
        found[axis] = np.copysign(1.0, mean[axis])
        return found

    @property
    def zenith(self) -> NDArray[np.float64]:
        """(n, 3) up of a sheet; the normals of a mesh that is none."""
        try:
            up = self.vertical
        except MeshdepictError:
            return super().zenith
        return np.broadcast_to(up, self.points.shape)

    @property
    def unit_areas(self) -> NDArray[np.float64]:
        """(n,) mixed Voronoi areas in squared diagonals."""
        return self.shape.unit_areas

    def mean(self, values: NDArray[Any], width: float) -> NDArray[np.float64]:
        """Return ``Σ_j A_j G(x_i − x_j) c_j / Σ_j A_j G(x_i − x_j)``, A mixed Voronoi areas.

        A vertex with no area in reach keeps its value.
        """
        mass = self.shape.unit_areas / (self.shape.unit_areas.max() or 1.0)
        scaled = max(width / (self.shape.diagonal or 1.0), 1e-18)
        channels = np.stack([mass, mass * values])
        patches = getattr(self.shape, "patches", None)
        sums = PatchSums(patches, self.unit_points, channels).at(scaled, error=_ERROR)
        some = sums[0] > 0
        return np.where(some, sums[1] / np.where(some, sums[0], 1), values)

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the values as they are."""
        return values

    def _smoother(self) -> Fill:
        sums = NormalSums(
            self.shape, self.facing, self.tolerance, self.widths[1:], corner_normals=self._corners
        )

        def finer(scale: int) -> NDArray[Any]:
            known, normals = self._coarsest
            return normals if known == scale else self.planes_at(scale)

        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            width = float(self.widths[scale])
            known, found = self._coarsest
            if known != scale:  # else somebody stopped it at the last moment
                found = sums.direction(width, lambda: finer(scale - 1), done)
            out[:] = found
            if self.facing and scale < self.last:
                self._coarsest = scale, found

        return fill

    def _made_from(self, scale: int) -> tuple[int, ...]:
        # The paper's sum has no need of a direction to look along.
        return (scale - 1,) if self.facing else ()

    def _principal(self, scale: int) -> PrincipalCurvatures:
        from meshdepict.curvature.principal import principal_curvatures

        return principal_curvatures(self.shape, normals=self.normals_at(scale))

    def _turns(self, scale: int) -> NDArray[np.float32]:
        from meshdepict.curvature.creases import neighbour_cosines

        return neighbour_cosines(self.shape, self.normals_at(scale))

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import ambient_openness

        if self.company is not None:
            at = self.points, self.shape.normals
            return ambient_openness(self.surface, at=at, rays=rays)
        return ambient_openness(self.shape, rays=rays)


def mesh_space(
    mesh: Mesh,
    widths: NDArray[np.float64],
    ratio: float,
    *,
    facing: int,
    tolerance: float,
    normals: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> MeshSpace:
    """Return the normals of a mesh at every width; see `scale_space`.

    ``normals`` of the vertices (n, 3) and of the triangles' corners (m, 3, 3), unit, stand for the
    mesh's own where somebody knows better: on both sides of creases.
    """
    own, corners = (mesh.normals, None) if normals is None else normals
    space = MeshSpace(mesh, widths, float(ratio), own, corners, facing=facing, tolerance=tolerance)
    space.smooth(at_once, progress=progress)
    return space
