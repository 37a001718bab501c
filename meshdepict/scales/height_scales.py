"""The scale space of a height field: Gaussians of its gradient, cells without a height left out.

The area-weighted mean normal of a height field is that of the mean gradient, n ∝ (−∇h, 1): with w
1 where a gradient is known and 0 elsewhere, n(σ) is the direction of (−G_σ(w ∇h), G_σ(w)). Nothing
bleeds from where nothing is known (normalised convolution), and borders mirror. A cell that has no
neighbour along an axis knows no gradient, and weighs nothing either.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.heights.gradients import gradients
from meshdepict.heights.horizons import open_angles, sky_shares
from meshdepict.heights.horn import horn_slopes, mark_relief, relief
from meshdepict.heights.normals import upward_normals
from meshdepict.heights.smoothing import blurred
from meshdepict.heights.spread_cells import typical_cells
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.ladder import TOLERANCE, Progress
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace
from meshdepict.shapes.height_field import HeightField

if TYPE_CHECKING:
    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.shapes.mesh import Mesh

__all__ = ["HeightSpace", "height_space"]

Single = NDArray[np.float32]

_WIDEST = 1e9  # distances of cells: no raster has as many


class HeightSpace(ScaleSpace):
    """Samples at the cells of a height field."""

    shape: HeightField
    at_vertices = True
    _means_of_smoothing = ("_block",)

    def __init__(
        self, field: HeightField, widths: NDArray[np.float64], ratio: float, *, tolerance: float
    ) -> None:
        slopes, known = gradients(field.z, field.valid, field.steps)
        planes = np.empty((len(widths), 3, field.count), np.float32)
        upward_normals(slopes, None, field.valid, planes[0])
        if not known.all():
            slopes *= known
            slopes = np.concatenate([slopes, known[None].astype(np.float32)])
        self._block = slopes
        super().__init__(
            field, None, widths, ratio, planes[0], planes=planes, facing=0, tolerance=tolerance
        )

    @property
    def points(self) -> NDArray[np.float64]:
        """(n, 3) positions in metres; nobody needs them to shade relief, and they are large."""
        return self.shape.points

    @property
    def surface(self) -> Mesh:
        """The ground as a mesh."""
        return self.shape.mesh

    @property
    def vertical(self) -> NDArray[np.float64]:
        """Up."""
        return np.array([0.0, 0.0, 1.0])

    def typical(self) -> ScaleSpace:
        """Return cells spread over the raster, the same ones whether it is whole or in windows."""
        field = self.shape
        columns, rows = field.size
        return ChosenSamples(self, field.sample(typical_cells(rows, columns)))

    @property
    def zenith(self) -> NDArray[np.float64]:
        """Up."""
        return np.broadcast_to(self.vertical, (self.count, 3))

    @property
    def unit_areas(self) -> NDArray[np.float64]:
        """(n,) areas of the ground in the cells."""
        field = self.shape
        cells = np.abs(np.linalg.det(field.steps / (field.diagonal or 1.0)))
        level = field.sample(np.broadcast_to(cells[:, None], field.z.shape))
        found: NDArray[np.float64] = level / self.planes_at(0)[2]
        return found

    @property
    def relief_normals(self) -> Single:
        """(n, 3) normals to Horn's slopes."""
        east, north = (self.shape.sample(slope) for slope in horn_slopes(*self._ground))
        down = 1 / np.sqrt(1 + east * east + north * north)
        return np.stack([-east * down, -north * down, down], axis=1)

    def relief(self, light: NDArray[np.float64]) -> Single:
        """Return the cosines (n,) between these normals and a light."""
        return np.asarray(self.shape.sample(relief(*self._ground, light)))

    def grazing_relief(self, frame: NDArray[np.float64], elevation: float) -> Single:
        """Return the shade (n,) under Mark's four lights, from compass directions of the map."""
        return np.asarray(self.shape.sample(mark_relief(*self._ground, elevation)))

    def sky_shares(self, *, rays: int, radius: float, horizon: str) -> Single:
        """Return the share (n,) of the sky that horizons leave; see `ReliefSamples`."""
        found = sky_shares(*self._ground, **self._round(rays, radius), horizon=horizon)
        return np.asarray(self.shape.sample(found))

    def open_angles(self, *, rays: int, radius: float, horizon: str, negative: bool) -> Single:
        """Return the openness (n,) in degrees, of horizons; see `ReliefSamples`."""
        found = open_angles(
            *self._ground, **self._round(rays, radius), horizon=horizon, negative=negative
        )
        return np.asarray(self.shape.sample(found))

    def from_heights(self, find: Callable[[HeightField], NDArray[Any]]) -> NDArray[Any]:
        """Return at the samples what is found of the field's heights."""
        return self.shape.sample(find(self.shape))

    @property
    def _ground(self) -> tuple[NDArray[Any], NDArray[np.bool_] | None, NDArray[np.float64]]:
        """Heights, which are known if not all are, and steps."""
        field = self.shape
        return field.z, None if field.whole else field.valid, field.steps

    def _round(self, rays: int, radius: float) -> dict[str, Any]:
        """Return directions and radius of horizons that stand for so many rays."""
        return {
            "directions": max(3, round(math.sqrt(rays))),
            "radius": min(radius, float(max(self.shape.size))),
        }

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the values as they are: the ground's vertices are the samples."""
        return values

    def mean(self, values: NDArray[Any], width: float) -> NDArray[np.float64]:
        """Return values averaged under a Gaussian over the cells that hold a height."""
        field = self.shape
        weights = field.valid.astype(np.float32)
        block = np.stack([field.image(np.asarray(values, np.float64)), weights])
        sums, mass = self._blurred(block, width)
        found: NDArray[np.float64] = field.sample(sums).astype(np.float64) / field.sample(mass)
        return found

    def _smoother(self) -> Fill:
        def fill(scale: int, out: Single, done: Callable[[float], None] | None) -> None:
            sums = self._blurred(self._block, float(self.widths[scale]))
            mass = sums[2] if len(sums) > 2 else None
            upward_normals(sums[:2], mass, self.shape.valid, out, self.planes_at(0))

        return fill

    def _blurred(self, block: NDArray[Any], width: float) -> NDArray[Any]:
        field = self.shape
        along = np.linalg.norm(field.steps[..., 0], axis=1)
        width = min(width, _WIDEST * max(along.max(), field.spacing[1]))
        return blurred(
            block, width / field.spacing[1], width / along,
            tolerance=self.tolerance, narrowest=width / field.widest,
        )  # fmt: skip

    def _made_from(self, scale: int) -> tuple[int, ...]:
        return ()

    def _principal(self, scale: int) -> PrincipalCurvatures:
        from meshdepict.curvature.heights import height_curvatures
        from meshdepict.curvature.principal import PrincipalCurvatures

        k, d = height_curvatures(self.shape.index, self.planes_at(scale), self.shape.steps)
        return PrincipalCurvatures(*k, *d)

    def _turns(self, scale: int) -> Single:
        from meshdepict.curvature.image import least_cosines

        return least_cosines(self.shape.index, self.planes_at(scale))


def height_space(
    field: HeightField,
    widths: NDArray[np.float64],
    ratio: float,
    *,
    tolerance: float = TOLERANCE,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> HeightSpace:
    """Return the normals of a height field at every width; see `scale_space`."""
    space = HeightSpace(field, widths, float(ratio), tolerance=tolerance)
    space.smooth(at_once, progress=progress)
    return space
