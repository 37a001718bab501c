"""What methods from maps ask of samples of any kind: relief, open sky, balls about them, heights.

A height field has an answer of its own to each; what stands here is everybody else's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.normal_sets import NormalSets
from meshdepict.scene.shape import one_of

if TYPE_CHECKING:
    from meshdepict.scene.shape import Shape
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh

__all__ = ["ReliefSamples"]

Single = NDArray[np.float32]


class ReliefSamples(NormalSets):
    """Samples as maps of terrain look at them; the base of `ScaleSpace`."""

    shape: Shape

    @property
    def points(self) -> NDArray[np.float64]:
        """(n, 3) world positions of the samples."""
        raise NotImplementedError

    def ray_points(self, *, turned: NDArray[np.bool_] | bool = False) -> NDArray[np.float64]:
        """Return where rays from the samples start, (n, 3) world positions: mostly where these are.

        Of what lies within triangles it is where their normals pretend the surface to be; see
        `transport.terminators`.

        Parameters
        ----------
        turned : bool or (n,) array
            Whether rays leave on the other side than the normals say.
        """
        return self.points

    @property
    def count(self) -> int:
        """Number of samples."""
        return self.planes_at(0).shape[1]

    @property
    def surface(self) -> Mesh:
        """The surface that rays from the samples can meet.

        Raises
        ------
        MeshdepictError
            Where the shape is none.
        """
        raise MeshdepictError(
            f"rays need a surface to meet, and {one_of(self.shape.kind)} is none: use another "
            "method, or shade a mesh"
        )

    @property
    def unit_points(self) -> NDArray[np.float64]:
        """(n, 3) positions moved to the shape's centre, in diagonals of the shape."""
        return self.shape.recentred(self.points)

    @property
    def unit_areas(self) -> NDArray[np.float64]:
        """(n,) areas of the surface that samples stand for, in squared diagonals of the shape.

        Raises
        ------
        MeshdepictError
            Where they are no parts of a surface.
        """
        raise MeshdepictError(
            f"areas of a surface are needed, and samples of {one_of(self.shape.kind)} have none: "
            "use another method, or shade a mesh"
        )

    @property
    def zenith(self) -> NDArray[np.float64]:
        """(n, 3) unit vectors to the middle of each sample's sky: up, else its own normal."""
        return self.normals_at(0).astype(np.float64)

    @property
    def relief_normals(self) -> Single:
        """(n, 3) normals that shaded relief is made of: Horn's of terrain, else the shape's own."""
        return self.normals_at(0)

    def relief(self, light: NDArray[np.float64]) -> Single:
        """Return the cosines (n,) between these normals and a light."""
        found: Single = self.relief_normals @ light.astype(np.float32)
        return found

    def grazing_relief(self, frame: NDArray[np.float64], elevation: float) -> Single:
        """Return the shade (n,) under Mark's four lights; see `heights.horn.mark_shades`.

        ``frame`` is (3, 3), east, north and up of the map in its rows. Terrain has its own.
        """
        from meshdepict.heights.horn import mark_shades

        return mark_shades(self.relief_normals @ frame.T.astype(np.float32), elevation)

    def sky_shares(self, *, rays: int, radius: float, horizon: str) -> Single:
        """Return the share (n,) of the sky about `zenith` that each sample sees, evenly weighed.

        Parameters
        ----------
        rays : int
            From each sample; of terrain, horizons in as many directions as the square root.
        radius : float
            How far away the sky may be hidden, in edge lengths of the shape, cells of terrain.
        horizon : {"lines", "cells"}
            See `heights.horizons.sky_shares`; about terrain alone.
        """
        from meshdepict.transport.occlusion import sky_openness

        reach = self._reach(radius, horizon)
        at = self.ray_points(), self.normals_at(0)
        return sky_openness(
            self.surface, self.zenith, at=at, rays=rays, even=True, radius=reach
        ).values

    def open_angles(self, *, rays: int, radius: float, horizon: str, negative: bool) -> Single:
        """Return the openness (n,) in degrees, mean(90° − γ); parameters as for `sky_shares`."""
        from meshdepict.transport.occlusion import zenith_angles

        reach = self._reach(radius, horizon)
        side = -1 if negative else 1
        at = self.ray_points(turned=negative), side * self.normals_at(0)
        return zenith_angles(self.surface, side * self.zenith, at=at, rays=rays, radius=reach)

    def _reach(self, radius: float, horizon: str) -> float | None:
        """Return a radius in world units; refuse what is about terrain."""
        if horizon != "lines":
            raise MeshdepictError(
                f"horizon={horizon!r} is about cells of terrain, and {one_of(self.shape.kind)} has "
                "none: leave it out"
            )
        return radius * self.shape.edge_length

    def ball_shares(self, radii: Sequence[float]) -> NDArray[np.float64]:
        """Return the shares (k, n) of balls about the samples that lie below the surface.

        ``radii`` are in diagonals of the shape; see `sums.ball_shares`. The last ones are kept.
        """
        from meshdepict.sums import ball_shares

        known, shares = getattr(self, "_balls", ((), np.empty(0)))
        if known != tuple(radii):
            given = self.unit_points, self.normals_at(0), self.unit_areas
            shares = ball_shares.ball_shares(*given, radii)
            shares.setflags(write=False)
            self._balls = tuple(radii), shares
        return shares

    def from_heights(self, find: Callable[[HeightField], NDArray[Any]]) -> NDArray[Any]:
        """Return at the samples (n, …) what is found of heights on a raster (rows, columns, …).

        Raises
        ------
        MeshdepictError
            Where there is no raster of heights.
        """
        raise MeshdepictError(
            f"heights on a raster are needed, and {one_of(self.shape.kind)} has none: use another "
            "method, or shade a HeightField"
        )
