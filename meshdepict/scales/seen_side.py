"""Samples with the normals of the side that is seen: of sheets, whose other side is as real."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.principal import PrincipalCurvatures
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace

if TYPE_CHECKING:
    from meshdepict.scene.view import View
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["SeenSide", "towards_eye"]

Floats = NDArray[np.float64]


def towards_eye(points: Floats, view: View) -> Floats:
    """Return the unit vectors (n, 3) from points to the eye, or (1, 3) in a parallel view."""
    if view.parallel_scale is not None:
        return view.towards_eye[None]
    away = view.position - points
    length = np.linalg.norm(away, axis=1, keepdims=True)
    return np.where(length > 0, away / np.where(length > 0, length, 1), view.towards_eye)


class SeenSide(ScaleSpace):
    """The samples of a scale space, turned to the eye where they look away from it.

    A sample is turned at every scale or at none, by its own unsmoothed normal, and bends the other
    way then. Rays leave on the side that is seen.

    Parameters
    ----------
    source : ScaleSpace
    view : View
    """

    def __init__(self, source: ScaleSpace, view: View) -> None:
        self.source = source
        cosine = (source.normals_at(0) * towards_eye(source.points, view)).sum(axis=1)
        self.turned = cosine < 0
        super().__init__(
            source.shape, source.points, source.widths, source.ratio, self._to_eye(0),
            facing=source.facing, tolerance=source.tolerance,
        )  # fmt: skip
        self.at_vertices = source.at_vertices
        self.light_errors, self.progress = source.light_errors, source.progress
        self.tints = source.tints
        self.company, self.member = source.company, source.member
        self._share_rays()

    def _share_rays(self) -> None:
        """Take over what was traced of the same sides: the source's, or the last that were seen."""
        source, turned = self.source, np.packbits(self.turned).tobytes()
        if not self.turned.any():
            self._transfers, self._lights_seen = source._transfers, source._lights_seen
        elif source._sides_seen is not None and source._sides_seen[0] == turned:
            _, self._transfers, self._lights_seen = source._sides_seen
        else:
            source._sides_seen = turned, self._transfers, self._lights_seen

    def transport(self, rays: int = 64) -> Transfer | Retraced:
        """Return where rays from the vertices go: of other samples those of the source's."""
        return super().transport(rays) if self.at_vertices else self.source.transport(rays)

    def typical(self) -> ScaleSpace:
        """Return the samples of the whole."""
        return self.source.typical()

    def ray_points(self, *, turned: NDArray[np.bool_] | bool = False) -> Floats:
        """Return where rays start on the side that is seen."""
        return self.source.ray_points(turned=self.turned ^ turned)

    def _to_eye(self, scale: int) -> NDArray[np.float32]:
        planes = self.source.planes_at(scale)
        return np.where(self.turned, -planes, planes)

    def _smoother(self) -> Fill:
        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            out[:] = self._to_eye(scale)

        return fill

    def _made_from(self, scale: int) -> tuple[int, ...]:
        return ()  # but from the source's

    @property
    def unit_points(self) -> Floats:
        """As the source has them."""
        return self.source.unit_points

    @property
    def surface(self) -> Mesh:
        """The surface that rays from the samples can meet."""
        return self.source.surface

    @property
    def own_surface(self) -> Mesh:
        """The source's."""
        return self.source.own_surface

    @property
    def vertical(self) -> NDArray[np.float64]:
        """What level ground faces; of a sheet that is seen from behind, on the side of the eye."""
        up = self.source.vertical
        return -up if self.turned.mean() > 0.5 else up

    @property
    def zenith(self) -> Floats:
        """(n, 3) the source's, turned to the eye as normals are."""
        zenith = self.source.zenith
        return np.where(self.turned[:, None], -zenith, zenith)

    @property
    def relief_normals(self) -> NDArray[np.float32]:
        """(n, 3) the source's, turned to the eye as the others are."""
        normals = self.source.relief_normals
        return np.where(self.turned[:, None], -normals, normals)

    @property
    def unit_areas(self) -> Floats:
        """As the source has them."""
        return self.source.unit_areas

    def ball_shares(self, radii: Sequence[float]) -> Floats:
        """Return what lies on the other side of the surface than the eye."""
        shares = self.source.ball_shares(radii)
        return np.where(self.turned, 1 - shares, shares)

    def from_heights(self, find: Callable[[HeightField], NDArray[Any]]) -> NDArray[Any]:
        """Return what the source finds."""
        return self.source.from_heights(find)

    def mean(self, values: NDArray[Any], width: float) -> Floats:
        """Return values averaged over the samples around; see `ScaleSpace.mean`."""
        return self.source.mean(values, width)

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of vertices at the samples; see `ScaleSpace.of_vertices`."""
        return self.source.of_vertices(values)

    def _principal(self, scale: int) -> PrincipalCurvatures:
        k1, k2, d1, d2 = self.source.curvature(scale)
        sign = np.where(self.turned, -1.0, 1.0)
        # Of the turned normal d1 and −d2 are right-handed.
        return PrincipalCurvatures(sign * k1, sign * k2, d1, d2 * sign[:, None].astype(np.float32))

    def _turns(self, scale: int) -> NDArray[np.float32]:
        return self.source._turns(scale)
