"""Some samples of a scale space, with what they have there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace

if TYPE_CHECKING:
    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.scene.light import Light
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["ChosenSamples"]


class ChosenSamples(ScaleSpace):
    """Some samples of a scale space, with what they have there: normals, curvature, occlusion.

    Parameters
    ----------
    whole : ScaleSpace
    chosen : (k,) array of int, or (n,) array of bool
    """

    def __init__(self, whole: ScaleSpace, chosen: NDArray[Any]) -> None:
        super().__init__(
            whole.shape, whole.points[chosen], whole.widths, whole.ratio,
            whole.planes_at(0)[:, chosen], facing=whole.facing, tolerance=whole.tolerance,
        )  # fmt: skip
        self._whole, self._chosen = whole, chosen
        self.tints = whole.tints
        self.company, self.member = whole.company, whole.member

    def typical(self) -> ScaleSpace:
        """Return the samples of the whole."""
        return self._whole.typical()

    @property
    def surface(self) -> Mesh:
        """The whole surface."""
        return self._whole.surface

    @property
    def own_surface(self) -> Mesh:
        """The whole's."""
        return self._whole.own_surface

    @property
    def vertical(self) -> NDArray[np.float64]:
        """What is up of the whole."""
        return self._whole.vertical

    @property
    def relief_normals(self) -> NDArray[np.float32]:
        """(k, 3) those of the samples in the whole."""
        return self._whole.relief_normals[self._chosen]

    @property
    def zenith(self) -> NDArray[np.float64]:
        """(k, 3) those of the samples in the whole."""
        return self._whole.zenith[self._chosen]

    def ball_shares(self, radii: Sequence[float]) -> NDArray[np.float64]:
        """Return those of the samples in the whole."""
        return self._whole.ball_shares(radii)[:, self._chosen]

    def from_heights(self, find: Callable[[HeightField], NDArray[Any]]) -> NDArray[Any]:
        """Return what the whole finds, at the samples."""
        return self._whole.from_heights(find)[self._chosen]

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the values of those vertices that are there."""
        return self._whole.of_vertices(values)[self._chosen]

    def occlusion(self, rays: int = 256) -> NDArray[np.float32]:
        """Return the share of the light that reaches each sample."""
        return self._whole.occlusion(rays)[self._chosen]

    @property
    def vertex_space(self) -> ScaleSpace:
        """That of the whole."""
        return self._whole.vertex_space

    def transport(self, rays: int = 64) -> Transfer | Retraced:
        """Return where the rays of the whole go."""
        return self._whole.transport(rays)

    def seen_from_vertices(self, lights: Sequence[Light]) -> tuple[NDArray[np.float32], ...]:
        """Return what the vertices see, as the whole knows."""
        return self._whole.seen_from_vertices(lights)

    def _smoother(self) -> Fill:
        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            out[:] = self._whole.planes_at(scale)[:, self._chosen]

        return fill

    def _made_from(self, scale: int) -> tuple[int, ...]:
        return ()  # but from the whole's

    def _principal(self, scale: int) -> PrincipalCurvatures:
        found, at = self._whole.curvature(scale), self._chosen
        return type(found)(found.k1[at], found.k2[at], found.d1[at], found.d2[at])

    def _turns(self, scale: int) -> NDArray[np.float32]:
        return self._whole._turns(scale)[self._chosen]
