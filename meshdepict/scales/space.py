"""Scale space: the normals of a shape smoothed by Gaussians of growing width.

The only step that knows what kind of shape it has. Everything after it works on samples.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import FACING, TOLERANCE, Progress
from meshdepict.scales.light_errors import LightErrors
from meshdepict.scales.relief_samples import ReliefSamples
from meshdepict.scales.seen_lights import SeenLights
from meshdepict.scene.shape import one_of
from meshdepict.shapes.table import html_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.curvature.view import ViewCurvature
    from meshdepict.scales.company import Company
    from meshdepict.scene.light import Light
    from meshdepict.scene.shape import Shape
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.occlusion import Openness
    from meshdepict.transport.rays import Steps
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Leaving, Transfer

__all__ = ["ScaleSpace"]


class ScaleSpace(ReliefSamples):
    """Positions and unit normals of samples at every scale, from fine to coarse.

    Made by `scale_space`. Shading functions take it and ask for nothing else. Each kind of shape
    has a class of its own (`MeshSpace`, `HeightSpace`, `GridSpace`,
    `ImageSpace`) that says how its normals are
    smoothed (`_smoother`) and bend (`_principal`, `_turns`), what rays can meet (`surface`) and how
    values are averaged (`mean`).

    A set of normals is there once `smooth` was asked for it, or as soon as it is read; see
    `NormalSets`.

    Attributes
    ----------
    shape : Mesh, HeightField, Volume or GBuffer
        What was sampled.
    points : (n, 3) array of float64
        World positions of the samples.
    ratio : float
        From one width to the next.
    widths : (scales + 1,) array of float64
        Gaussian widths in world units; ``widths[0]`` is 0, the shape's own normals.
    normals : (scales + 1, n, 3) array of float32
        Unit normals, fine to coarse.
    facing, tolerance
        What the sums were made with; see `scale_space`.
    at_vertices : bool
        Whether the samples are the vertices of the surface, in their order.
    light_errors : LightErrors
        By the number of rays, root mean square error in grey levels of the last light that was
        sampled: discs, the sky and bounces.
    tints : (v, 3) array of float32, optional
        The own colours of the surface's vertices in linear light, which tint what they send on;
        None: white.
    company, member : Company, int
        What else stands where rays go, and which of them this is of; None where it is alone.
    progress : callable, optional
        ``progress(done, total)``, whom rays tell how far they are.
    """

    at_vertices = False
    tints: NDArray[np.float32] | None = None
    company: Company | None = None
    member = 0

    def __init__(
        self,
        shape: Shape,
        points: NDArray[np.float64] | None,
        widths: NDArray[np.float64],
        ratio: float,
        own: NDArray[Any],
        *,
        planes: NDArray[np.float32] | None = None,
        facing: int = FACING,
        tolerance: float = TOLERANCE,
    ) -> None:
        super().__init__(widths, own, planes)
        self.shape = shape
        self._points = points
        self.ratio = ratio
        self.facing = facing
        self.tolerance = tolerance
        self._curvatures: dict[int, PrincipalCurvatures] = {}
        self._creases: dict[int, NDArray[np.float32]] = {}
        self._seen: dict[tuple[int, float], tuple[tuple[Any, ...], ViewCurvature]] = {}
        self._openness: dict[int, Openness] = {}
        self._transfers: dict[int, Transfer | Retraced] = {}
        self._kept: dict[str, tuple[tuple[Any, ...], Any]] = {}
        self._lights_seen: list[SeenLights] = []  # one, once it is asked for
        self._sides_seen: tuple[bytes, dict[int, Transfer | Retraced], list[SeenLights]] | None = (
            None
        )
        self.progress: Progress | None = None
        self.light_errors = LightErrors()

    @property
    def points(self) -> NDArray[np.float64]:
        """(n, 3) world positions of the samples."""
        assert self._points is not None  # or somebody else knows them
        return self._points

    @property
    def finest_width(self) -> float:
        """σ_0 = σ_1 / ratio: what formulas that need a width for the unsmoothed scale take."""
        return float(self.widths[1]) / self.ratio if len(self.widths) > 1 else 0.0

    def curvature(self, scale: int = 0) -> PrincipalCurvatures:
        """Return the principal curvatures of a scale: how its normals turn; computed once.

        Raises
        ------
        MeshdepictError
            For a scale that isn't there.
        """
        scale = self._checked_scale(scale)
        if scale not in self._curvatures:
            self._curvatures[scale] = self._principal(scale)
        return self._curvatures[scale]

    def view_curvature(
        self, view: View | str, scale: int = 1, *, foreshortening: float = 1.0
    ) -> ViewCurvature:
        """Return the curvature of a scale as an eye sees it; see `curvature.view_curvature`.

        The last view's is kept for every scale and foreshortening. Its arrays are read-only.
        """
        from meshdepict.curvature.view import view_tensor
        from meshdepict.scene.names import as_view

        scale = self._checked_scale(scale)
        eye = as_view(view, self.shape)
        sight = (
            *eye.position, *eye.focus, *eye.up,
            eye.height_px, eye.field_of_view, eye.parallel_scale,
        )  # fmt: skip
        former, seen = self._seen.get((scale, foreshortening), (None, None))
        if seen is not None and former == sight:
            return seen
        normals = self.normals_at(scale)
        seen = view_tensor(
            self.points, normals, self.curvature(scale), self.crease_cosines(scale), eye,
            foreshortening=foreshortening,
        )  # fmt: skip
        for array in seen:
            array.setflags(write=False)
        self._seen[scale, foreshortening] = sight, seen
        return seen

    def crease_cosines(self, scale: int) -> NDArray[np.float32]:
        """Return the least cosine (n,) between a sample's normal and its neighbours'; kept."""
        if scale not in self._creases:
            self._creases[scale] = self._turns(scale)
        return self._creases[scale]

    def occlusion(self, rays: int = 256) -> NDArray[np.float32]:
        """Return the share of the light from all around that reaches each sample; computed once.

        (n,) in [0, 1], 1 where nothing is in the way; `occlusion.ambient_openness` says more.

        Raises
        ------
        MeshdepictError
            For a number of rays beyond 2 … 65536.
        """
        if rays not in self._openness:
            self._openness[rays] = self._open(rays)
            self._openness[rays].values.setflags(write=False)
        return self._openness[rays].values

    @property
    def occlusion_errors(self) -> dict[int, float]:
        """Root mean square error of the occlusion computed so far, by the number of rays."""
        return {rays: openness.error for rays, openness in self._openness.items()}

    @property
    def own_surface(self) -> Mesh:
        """The surface that the samples lie on: of `surface`, what rays can meet, a part or all."""
        return self.surface

    @property
    def surface_normals(self) -> NDArray[Any]:
        """(v, 3) unit normals of the vertices of `surface`, as they are shaded."""
        if self.company is not None:
            return self.company.normals
        return self.normals_at(0) if self.at_vertices else self.surface.normals

    def of_surface(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of the vertices of `surface` (v, …) at the samples (n, …)."""
        own = values
        if self.company is not None:
            own = values[self.company.surface.parts[self.member]]
        return self.of_vertices(own)

    def on_surface(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of the vertices of `own_surface` at those of `surface`, 0 elsewhere."""
        if self.company is None:
            return values
        found = np.zeros((len(self.surface.vertices), *values.shape[1:]), values.dtype)
        found[self.company.surface.parts[self.member]] = values
        return found

    @property
    def vertex_space(self) -> ScaleSpace:
        """Samples at the vertices of the surface that these lie on; themselves if they are those.

        Raises
        ------
        MeshdepictError
            Where there is none.
        """
        if self.at_vertices:
            return self
        kind = self.surface.kind  # what has no surface says so
        raise MeshdepictError(
            f"how light from all around is enhanced is known at the vertices of a {kind}, which "
            f"the samples of this {self.shape.kind} are not: shade the mesh itself, or set "
            "bounces=0 and give lights in place of an environment"
        )

    def transport(self, rays: int = 64) -> Transfer | Retraced:
        """Return where rays from the vertices of the surface go; traced once.

        With `bounced` it tells any light that goes from surface to surface. Where the memory that
        is allowed doesn't hold them, they are traced again for every sum.

        Raises
        ------
        MeshdepictError
            For a number of rays beyond 2 … 65536, and for samples that are no part of a surface.
        """
        if self.company is not None:
            return self._told(self.company.transport(rays, self.member, progress=self.progress))
        if rays not in self._transfers:
            self._transfers[rays] = self.traced(rays)
        return self._told(self._transfers[rays])

    def traced(self, rays: int, how: Leaving | None = None) -> Transfer | Retraced:
        """Return where rays from the vertices of the surface go, traced anew; see `transport`.

        Parameters
        ----------
        rays : int
        how : Leaving, optional
            How they leave: cosine-weighted unless given.

        Raises
        ------
        MeshdepictError
            As for `transport`.
        """
        from meshdepict.transport.retraced import transfer_of
        from meshdepict.transport.transfer import USUAL

        leaving = USUAL if how is None else how
        if self.company is not None:
            return self.company.traced(rays, self.member, leaving, progress=self.progress)
        return transfer_of(
            self.surface, normals=self.surface_normals, rays=rays, how=leaving,
            progress=self.progress,
        )  # fmt: skip

    def traced_once(
        self, name: str, key: tuple[Any, ...], rays: int, how: Callable[[], Leaving]
    ) -> Transfer | Retraced:
        """Return where rays of a method's own go, kept as `kept` does."""
        found: Transfer | Retraced = self.kept(name, (rays, *key), lambda: self.traced(rays, how()))
        return self._told(found)

    def _told(self, found: Transfer | Retraced) -> Transfer | Retraced:
        """Let rays that are traced again know whom to tell how far they are."""
        if hasattr(found, "progress"):
            found.progress = self.progress
        return found

    def kept(self, name: str, key: tuple[Any, ...], find: Callable[[], Any]) -> Any:
        """Return what a method found here before, or finds anew where its key is another.

        Of every name the last is kept, and the key is all that it depends on beside the samples.
        """
        former, found = self._kept.get(name, (None, None))
        if former != key:
            found = find()
            self._kept[name] = key, found
        return found

    def seen_share(
        self,
        light: Light,
        *,
        rays: int = 64,
        at: tuple[NDArray[Any], NDArray[Any]] | None = None,
        steps: Steps | None = None,
    ) -> NDArray[np.float32]:
        """Return which share (n,) of a light reaches each sample; see `transport.shadows`.

        Parameters
        ----------
        light : Light
        rays : int
            How many directions stand for its disc, if it is one.
        at : two (k, 3) arrays, optional
            Positions in the surface's unit frame and normals, in place of the samples'.
        steps : array, optional
            Which set of directions; see `transport.rays`.

        Raises
        ------
        MeshdepictError
            As for `transport`.
        """
        from meshdepict.transport.rays import FIRST
        from meshdepict.transport.shadows import seen_share

        if at is None and self.at_vertices and not light.spread:
            return self.seen_from_vertices([light])[0]
        surface = self.surface
        places = (surface.recentred(self.ray_points()), self.normals_at(0)) if at is None else at
        return seen_share(
            surface, light.direction, at=places, spread=light.spread, rays=rays,
            steps=FIRST if steps is None else steps,
        )  # fmt: skip

    def seen_from_vertices(self, lights: Sequence[Light]) -> tuple[NDArray[np.float32], ...]:
        """Return which share (v,) of each light the vertices of the surface see: 0 or 1.

        Each light is one direction. The last ones are kept.
        """
        if not self._lights_seen:
            surface = self.surface
            points, normals = surface.unit_points, surface.normals
            if self.company is not None:
                points, normals = self.company.places(self.member)
            own = self.normals_at(0) if self.at_vertices else normals
            self._lights_seen.append(SeenLights(surface, (points, own)))
        return self._lights_seen[0].shares(lights)

    def typical(self) -> ScaleSpace:
        """Return samples from which numbers that follow the shape are found: all, mostly.

        Of a volume a part that is the same whether it is shaded at once or in pieces.
        """
        return self

    # --- what depends on the kind of shape --------------------------------------------------

    @property
    def vertical(self) -> NDArray[np.float64]:
        """(3,) unit vector that level ground faces.

        Raises
        ------
        MeshdepictError
            Where there is no ground.
        """
        raise MeshdepictError(
            f"{one_of(self.shape.kind)} has no level ground, which one light for relief needs: "
            "leave one_light out"
        )

    def mean(self, values: NDArray[Any], width: float) -> NDArray[np.float64]:
        """Return values (n,) averaged over the samples around under a Gaussian of a world width."""
        raise MeshdepictError(f"values can't be averaged over {one_of(self.shape.kind)}")

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of the vertices of the shape's mesh (v,) at the samples (n,)."""
        raise MeshdepictError(
            f"{one_of(self.shape.kind)} has no vertices whose values could be taken"
        )

    def _principal(self, scale: int) -> PrincipalCurvatures:
        raise MeshdepictError(f"{one_of(self.shape.kind)} has no curvature")

    def _turns(self, scale: int) -> NDArray[np.float32]:
        """Return the least cosine between a sample's normal and its neighbours': (n,)."""
        raise MeshdepictError(f"{one_of(self.shape.kind)} has no creases")

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import ambient_openness

        at = self.ray_points(), self.normals_at(0)
        return ambient_openness(self.surface, at=at, rays=rays)

    def __repr__(self) -> str:
        """Return the number of samples and the range of widths."""
        count = len(self.widths) - 1
        widths = f", widths {self.widths[1]:.4g} … {self.widths[-1]:.4g}" if count else ""
        return f"<ScaleSpace: {self.count:,} samples, {count} scales{widths}>"

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        rows = [
            ("of", repr(self.shape).strip("<>")),
            ("samples", f"{self.count:,}"),
            ("scales", str(len(self.widths) - 1)),
        ]
        if len(self.widths) > 1:
            rows += [
                ("widths", "  ".join(f"{width:.4g}" for width in self.widths[1:])),
                ("ratio", f"{self.ratio:.4g}"),
            ]
        return html_table(rows, "ScaleSpace")
