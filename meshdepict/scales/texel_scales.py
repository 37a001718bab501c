"""The scale space of a texture: samples in the middle of texels, from those at the vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.principal import PrincipalCurvatures
from meshdepict.scales.interpolated_scales import InterpolatedSpace

if TYPE_CHECKING:
    from meshdepict.scales.mapped_normals import NormalMaps
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.transport.occlusion import Openness

__all__ = ["TexelSpace"]


class TexelSpace(InterpolatedSpace):
    """Samples on the faces of a mesh that cast their own rays.

    Parameters
    ----------
    source, corners, weights
        As for its base.
    maps : NormalMaps, optional
        What gives the unsmoothed normals, and how these bend.
    triangle : (n,) array of int, optional
        In which each sample lies; needed by maps.
    """

    def __init__(
        self,
        source: ScaleSpace,
        corners: NDArray[Any],
        weights: NDArray[Any],
        *,
        maps: NormalMaps | None = None,
        triangle: NDArray[Any] | None = None,
    ) -> None:
        self._maps, self._triangle = maps, triangle
        normals = None
        if maps is not None and triangle is not None:
            normals = maps.at(triangle, weights)
        super().__init__(source, corners, weights, normals=normals)

    def typical(self) -> ScaleSpace:
        """Return the samples: they know normal maps, and those of the vertices don't."""
        return super().typical() if self._maps is None else self

    def _principal(self, scale: int) -> PrincipalCurvatures:
        if scale != 0 or self._maps is None or self._triangle is None:
            return super()._principal(scale)
        mapped = self._maps.reach(self._triangle)
        found = self._maps.curvature(self._triangle, self._weights)
        if mapped.all():
            return found
        other = super()._principal(scale)

        def mixed(one: NDArray[Any], two: NDArray[Any]) -> NDArray[Any]:
            return np.where(mapped if one.ndim == 1 else mapped[:, None], one, two)

        return PrincipalCurvatures(
            mixed(found.k1, other.k1), mixed(found.k2, other.k2),
            mixed(found.d1, other.d1), mixed(found.d2, other.d2),
        )  # fmt: skip

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import ambient_openness

        at = self.ray_points(), np.asarray(self.normals_at(0), np.float64)
        return ambient_openness(self.surface, at=at, rays=rays)
