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
from meshdepict.threads import each, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.scene.light import Light
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.occlusion import Openness
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["InterpolatedSpace", "bent"]

Floats = NDArray[np.float64]

_MANY = 20_000  # samples that are worth several threads


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
        single = weights.dtype == np.float32
        self._weights: NDArray[Any] = np.ascontiguousarray(
            weights, np.float32 if single else np.float64
        )
        own = self._unit(source.normals_at(0)) if normals is None else normals.T
        super().__init__(
            source.shape, None, source.widths, source.ratio, own,
            facing=source.facing, tolerance=source.tolerance,
        )  # fmt: skip
        self._ray_points: Floats | None = None
        self.tints = source.tints
        self.company, self.member = source.company, source.member

    @property
    def points(self) -> Floats:
        """(n, 3) world positions of the samples."""
        if self._points is None:  # many methods ask for none
            found = self._spread(self.source.unit_points)
            self._points = found * (self.source.shape.diagonal or 1.0) + self.source.shape.centre
        return self._points

    def ray_points(self, *, turned: NDArray[np.bool_] | bool = False) -> Floats:
        """Return where rays start, (n, 3) world positions on the surface that normals pretend."""
        from meshdepict.transport.terminators import lifts_to_patches, smooth_starts

        if self._ray_points is not None and turned is False:
            return self._ray_points
        lifts = lifts_to_patches(
            self.source.unit_points, self.source.normals_at(0), self._corners, self._weights,
            turned=turned,
        )  # fmt: skip
        lifts *= self.source.shape.diagonal or 1.0
        found = smooth_starts(self.surface, self.points, lifts)
        if turned is False:
            self._ray_points = found
        return found

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
            self._unit(self.source.normals_at(scale), out)

        return fill

    def _made_from(self, scale: int) -> tuple[int, ...]:
        return ()  # but from the source's

    def _spread(self, values: NDArray[Any]) -> Floats:
        """Interpolate values (vertices, …)."""
        return np.einsum("nc,nc...->n...", self._weights, values[self._corners])

    def _unit(
        self, vectors: NDArray[Any], out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Interpolate unit vectors (vertices, 3) as planes (3, n)."""
        from meshdepict.scales.between_vertices import unit_between

        count = len(self._corners)
        found = np.empty((3, count), np.float32) if out is None else out
        each(
            lambda a, b: unit_between(vectors, self._corners, self._weights, found, a, b),
            spans(count, thread_count() if count > _MANY else 1),
        )
        return found

    def _principal(self, scale: int) -> PrincipalCurvatures:
        """Interpolate the shape operators and take their part in the tangent plane."""
        from meshdepict.scales.between_vertices import bends_between

        k1, k2, d1, d2 = self.source.curvature(scale)
        normal = self.normals_at(scale).astype(np.float64)
        a = tangents(normal)
        b = np.cross(normal, a)
        count, found = len(normal), np.empty((3, len(normal)))
        each(
            lambda start, stop: bends_between(
                k1, k2, d1, d2, self._corners, self._weights, a, b, found, start, stop
            ),
            spans(count, thread_count() if count > _MANY else 1),
        )
        return bent(a, b, *found)

    def _turns(self, scale: int) -> NDArray[np.float32]:
        return self.source.crease_cosines(scale)[self._corners].min(axis=1)

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import Openness

        values = self._spread(self.source.occlusion(rays)).astype(np.float32)
        return Openness(values, self.source.occlusion_errors[rays])


def bent(a: Floats, b: Floats, aa: Any, ab: Any, bb: Any) -> PrincipalCurvatures:
    """Return the principal curvatures of shape operators.

    Parameters
    ----------
    a, b : (n, 3) array
        Axes of the tangent planes, unit and at right angles.
    aa, ab, bb : (n,) array
        The operators' numbers in them.
    """
    mean, half = (aa + bb) / 2, (aa - bb) / 2
    radius = np.hypot(half, ab)
    cosine, sine = (v[:, None] for v in halved_angle(half, ab))
    large, small = cosine * a + sine * b, cosine * b - sine * a
    turned = mean < 0  # the smaller eigenvalue is larger in magnitude
    first, second = np.where(turned, -radius, radius) + mean, np.where(turned, radius, -radius)
    one = np.where(turned[:, None], small, large).astype(np.float32)
    two = np.where(turned[:, None], -large, small).astype(np.float32)
    return PrincipalCurvatures(first, mean + second, one, two)
