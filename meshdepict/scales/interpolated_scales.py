"""Samples between the vertices of a mesh: what a pixel inside a triangle sees.

Normals and curvature there are the vertices', interpolated as graphics cards do it, before any
shading: the reference that colours interpolated between vertices are judged by.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.frames import halved_angle, tangents
from meshdepict.curvature.principal import PrincipalCurvatures
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace

if TYPE_CHECKING:
    from meshdepict.scene.light import Light
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.occlusion import Openness
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["InterpolatedSpace"]

Floats = NDArray[np.float64]


class InterpolatedSpace(ScaleSpace):
    """Samples on the faces of a mesh, from those at its vertices.

    Parameters
    ----------
    source : ScaleSpace
        Of a mesh.
    corners : (n, 3) array of int
        For each sample the vertices of its triangle.
    weights : (n, 3) array of float
        Its barycentric coordinates there.
    normals : (n, 3) array, optional
        Unsmoothed ones, where they are not the vertices' interpolated: up to a crease.
    """

    def __init__(
        self,
        source: ScaleSpace,
        corners: NDArray[Any],
        weights: NDArray[Any],
        *,
        normals: NDArray[Any] | None = None,
    ) -> None:
        self.source, self._corners = source, np.ascontiguousarray(corners)
        self._weights = np.ascontiguousarray(weights, np.float64)
        own = self._unit(source.normals_at(0)) if normals is None else normals
        points = self._spread(source.unit_points)
        points = points * (source.shape.diagonal or 1.0) + source.shape.centre
        super().__init__(
            source.shape, points, source.widths, source.ratio, own.T,
            facing=source.facing, tolerance=source.tolerance,
        )  # fmt: skip
        self.tints = source.tints
        self.company, self.member = source.company, source.member

    def typical(self) -> ScaleSpace:
        """Return the samples of the whole."""
        return self.source.typical()

    @property
    def surface(self) -> Mesh:
        """What rays from the samples can meet."""
        return self.source.surface

    @property
    def own_surface(self) -> Mesh:
        """The mesh that the samples lie on."""
        return self.source.own_surface

    @property
    def vertical(self) -> NDArray[np.float64]:
        """What level ground faces."""
        return self.source.vertical

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Interpolate values of the vertices."""
        return self._spread(self.source.of_vertices(values))

    @property
    def vertex_space(self) -> ScaleSpace:
        """That of the source."""
        return self.source.vertex_space

    def transport(self, rays: int = 64) -> Transfer | Retraced:
        """Return where the rays from the vertices go."""
        return self.source.transport(rays)

    def seen_from_vertices(self, lights: Sequence[Light]) -> tuple[NDArray[np.float32], ...]:
        """Return what the vertices see, as the source knows."""
        return self.source.seen_from_vertices(lights)

    def _smoother(self) -> Fill:
        def fill(
            scale: int, out: NDArray[np.float32], done: Callable[[float], None] | None
        ) -> None:
            out[:] = self._unit(self.source.normals_at(scale)).T

        return fill

    def _made_from(self, scale: int) -> tuple[int, ...]:
        return ()  # but from the source's

    def _spread(self, values: NDArray[Any]) -> Floats:
        """Interpolate values (vertices, …)."""
        return np.einsum("nc,nc...->n...", self._weights, values[self._corners])

    def _unit(self, vectors: NDArray[Any]) -> Floats:
        """Interpolate unit vectors; where they cancel, the nearest vertex's."""
        mean = self._spread(vectors)
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        nearest = np.take_along_axis(self._corners, self._weights.argmax(axis=1)[:, None], 1)[:, 0]
        return np.where(length > 1e-6, mean / np.where(length > 1e-6, length, 1), vectors[nearest])

    def _principal(self, scale: int) -> PrincipalCurvatures:
        """Interpolate the shape operators and take their part in the tangent plane."""
        k1, k2, d1, d2 = self.source.curvature(scale)
        normal = self.normals_at(scale).astype(np.float64)
        a = tangents(normal)
        b = np.cross(normal, a)
        aa = ab = bb = np.zeros(len(normal))
        for corner, weight in zip(self._corners.T, self._weights.T, strict=True):
            for k, d in ((k1, d1), (k2, d2)):
                along, across = (np.einsum("ni,ni->n", d[corner], axis) for axis in (a, b))
                bend = weight * k[corner]
                aa, ab, bb = aa + bend * along**2, ab + bend * along * across, bb + bend * across**2
        mean, half = (aa + bb) / 2, (aa - bb) / 2
        radius = np.hypot(half, ab)
        cosine, sine = (v[:, None] for v in halved_angle(half, ab))
        large, small = cosine * a + sine * b, cosine * b - sine * a
        turned = mean < 0  # the smaller eigenvalue is larger in magnitude
        first, second = np.where(turned, -radius, radius) + mean, np.where(turned, radius, -radius)
        one = np.where(turned[:, None], small, large).astype(np.float32)
        two = np.where(turned[:, None], -large, small).astype(np.float32)
        return PrincipalCurvatures(first, mean + second, one, two)

    def _turns(self, scale: int) -> NDArray[np.float32]:
        return self.source._turns(scale)[self._corners].min(axis=1)

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import Openness

        values = self._spread(self.source.occlusion(rays)).astype(np.float32)
        return Openness(values, self.source.occlusion_errors[rays])
