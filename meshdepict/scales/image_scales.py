"""The scale space of a G-buffer: its pixels' normals smoothed in the picture, as the papers do."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.scales.ladder import Progress, check_ladder, ladder
from meshdepict.scales.normal_sets import Fill
from meshdepict.scales.space import ScaleSpace
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.lengths import resolve_width

if TYPE_CHECKING:
    from meshdepict.curvature.principal import PrincipalCurvatures
    from meshdepict.curvature.view import ViewCurvature
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.occlusion import Openness

__all__ = ["FILTERS", "ImageSpace", "image_space"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

Step = Callable[[int, Singles], Singles]
"""Makes a scale's normals (3, n) of the next finer ones."""

FILTERS = ("bilateral", "diffusion", "none")

_STEEPEST = 0.1  # cosine to the eye of a pixel whose area is told by it

# |Δ ln depth| between neighbouring pixels at which a silhouette begins, and at which it is one.
_SILHOUETTE = (0.03, 0.04)


class ImageSpace(ScaleSpace):
    """Samples at the pixels of a G-buffer; ``filter`` says how they were smoothed."""

    shape: GBuffer
    _means_of_smoothing = ("_step",)

    def __init__(
        self,
        gbuffer: GBuffer,
        widths: NDArray[np.float64],
        ratio: float,
        filter: str,  # noqa: A002 - the word of the field
        step: Step,
    ) -> None:
        super().__init__(gbuffer, gbuffer.points, widths, ratio, gbuffer.normals.T)
        self.filter, self._step = filter, step

    def _smoother(self) -> Fill:
        def fill(scale: int, out: Singles, done: Callable[[float], None] | None) -> None:
            out[:] = self._step(scale, self.planes_at(scale - 1))

        return fill

    @property
    def surface(self) -> Mesh:
        """The mesh that the buffer shows."""
        if self.shape.mesh is None:
            raise MeshdepictError(
                "rays need a surface to meet, and images have none: give from_images an occlusion "
                "image, use another method, or shade a mesh"
            )
        return self.shape.mesh

    def ray_points(self, *, turned: NDArray[np.bool_] | bool = False) -> Floats:
        """Return where rays start, (n, 3) world positions: on the surface that normals pretend."""
        from meshdepict.transport.terminators import lifts_to_patches, smooth_starts

        mesh, triangle, shares = self.shape.mesh, self.shape.triangle, self.shape.barycentric
        if mesh is None or triangle is None or shares is None:
            return self.points
        lifts = lifts_to_patches(
            mesh.unit_points, mesh.normals, mesh.faces[triangle], shares, turned=turned
        )
        return smooth_starts(mesh, self.points, lifts * (mesh.diagonal or 1.0))

    @property
    def unit_areas(self) -> Floats:
        """(n,) areas of the surface in the pixels, of those at contours ten pixels'."""
        from meshdepict.curvature.view import eye_frames

        (_, _, z), _ = eye_frames(self.points, self.shape.view)
        cosine = (z * self.normals_at(0)).sum(axis=1)
        sizes = self.shape.pixel_sizes / (self.shape.diagonal or 1.0)
        found: Floats = sizes**2 / np.maximum(cosine, _STEEPEST)
        return found

    def of_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Interpolate values of the vertices of the mesh that is seen."""
        return self.shape.sample(values)

    def mean(self, values: NDArray[Any], width: float) -> Floats:
        """Return values averaged under a Gaussian in the picture, over the pixels of the mask."""
        from scipy.ndimage import gaussian_filter

        pixels = width / self.shape.edge_length
        radius = max(1, min(math.ceil(4 * pixels), max(self.shape.size)))
        mass, sums = (
            gaussian_filter(self.shape.image(v), pixels, mode="constant", radius=radius)
            for v in (np.ones(len(values)), np.asarray(values, np.float64))
        )
        return (sums / np.where(self.shape.mask, mass, 1))[self.shape.mask]

    def view_curvature(
        self, view: View | str, scale: int = 1, *, foreshortening: float = 1.0
    ) -> ViewCurvature:
        """Return the Sobel Hessian of a scale's slopes (Light Warping, alg. 1), per pixel.

        The weight fades out where |Δ ln depth| to one of the eight neighbours rises from 0.03 to
        0.04 (of a parallel view's, see `GBuffer.depth_ratio`), or with the buffer's occlusion map
        where `GBuffer.silhouettes` says so, at the mask's border, and where a normal turns by 30°
        to 60°.

        Parameters
        ----------
        view : View or str
            The buffer's own, by name also "front", which everything has as its default. Another
            picture would need another buffer; the number of pixels doesn't matter.
        scale : int
        foreshortening : float

        Raises
        ------
        MeshdepictError
            For another view, a scale that isn't there, and f out of 0 … 10.
        """
        from meshdepict.curvature.image import sobel_hessian
        from meshdepict.curvature.view import ViewCurvature, eigenvalues, eye_frames

        scale = self._checked_scale(scale)
        if not 0 <= foreshortening <= 10:
            raise MeshdepictError(f"foreshortening={foreshortening!r} is not a number from 0 to 10")
        if not _same(view, self.shape.view):
            raise MeshdepictError(
                f"the G-buffer was made for the view {str(self.shape.view).strip()}: pixels know "
                "no other; make a buffer for this view, or take curvature='object'"
            )
        _, seen = self._seen.get((scale, foreshortening), (None, None))
        if seen is not None:
            return seen
        (x, y, z), _ = eye_frames(self.points, self.shape.view)
        hessian = sobel_hessian(
            self.shape.index, self.planes_at(scale), self.shape.depth_steps,
            np.stack([x, y, z], axis=1), steepest=self._steepest, foreshortening=foreshortening,
        )  # fmt: skip
        (ku, kv), (cosine, sine) = eigenvalues(*hessian)
        seen = ViewCurvature(
            ku,
            kv,
            (cosine[:, None] * x + sine[:, None] * y).astype(np.float32),
            (cosine[:, None] * y - sine[:, None] * x).astype(np.float32),
            _conductance(self.shape, self.planes_at(scale)),
        )
        for array in seen:
            array.setflags(write=False)
        self._seen[scale, foreshortening] = (), seen
        return seen

    @property
    def _steepest(self) -> float:
        """Steps of depth, in pixels, beyond which neighbours aren't of one surface."""
        return sum(_SILHOUETTE) / 2 / float(self.shape.depth_ratio(1.0))

    def _principal(self, scale: int) -> PrincipalCurvatures:
        from meshdepict.curvature.image import sobel_principal
        from meshdepict.curvature.principal import PrincipalCurvatures
        from meshdepict.curvature.view import eye_frames

        (_, _, z), _ = eye_frames(self.points, self.shape.view)
        right, up, _ = self.shape.view.frame
        k, d = sobel_principal(
            self.shape.index, self.planes_at(scale), self.shape.depth_steps,
            np.ascontiguousarray(z), right, up, steepest=self._steepest,
        )  # fmt: skip
        return PrincipalCurvatures(*(k / self.shape.pixel_sizes), *d)

    def _turns(self, scale: int) -> Singles:
        from meshdepict.curvature.image import least_cosines

        return least_cosines(self.shape.index, self.planes_at(scale))

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import Openness

        if self.shape.openness is None:
            return super()._open(rays)
        return Openness(np.clip(self.shape.openness, 0, 1).astype(np.float32), 0.0)


def image_space(
    gbuffer: GBuffer,
    *,
    scales: int = 5,
    width: float | str | None = None,
    ratio: float = 1.7,
    filter: str = "bilateral",  # noqa: A002 - the word of the field
    depth_range: float = 1.0,
    iterations: int | None = None,
    importance: ArrayLike | None = None,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> ImageSpace:
    """Smooth the normals of a G-buffer at a geometric series of widths.

    Parameters
    ----------
    gbuffer : GBuffer
    scales, width, ratio
        As for `scale_space`. The first width is a pixel unless given; in a perspective view, where
        pixels are smaller in front, widths are numbers of pixels times ``gbuffer.edge_length``.
    filter : {"bilateral", "diffusion", "none"}
        "bilateral": the pyramid of Local Light Alignment, each scale from the next finer one, so
        wide that both together make the width asked for; see `bilateral.bilateral_step`.
        "diffusion": the anisotropic diffusion of Light Warping; see `diffusion.diffuse`.
        "none": the original normals alone.
    depth_range : float
        Of "bilateral": the kernel's width in depth, in widths across. Larger values smooth over
        smaller steps; "inf" over all.
    iterations : int, optional
        Of "diffusion": one scale of so many steps of 0.2, in place of scales and width.
    importance : (n,) or (height, width) array_like in [0, 1], optional
        Of "diffusion": 1 keeps a pixel as it is, 0 diffuses it all the way.
    at_once
        As for `scale_space`.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    MeshdepictError
        For a parameter out of its range, or one that the filter has no use for.
    """
    if not isinstance(gbuffer, GBuffer):
        raise MeshdepictError(
            f"image_space smooths a GBuffer, not a {type(gbuffer).__name__}: take scale_space"
        )
    if filter not in FILTERS:
        raise MeshdepictError(
            f"filter={filter!r} is not one of {', '.join(FILTERS)}{nearest(str(filter), FILTERS)}"
        )
    if filter != "diffusion" and (iterations is not None or importance is not None):
        raise MeshdepictError(
            f"iterations and importance belong to filter='diffusion', not {filter!r}"
        )
    if isinstance(depth_range, (str, bool)) or not depth_range > 0:
        raise MeshdepictError(f"depth_range={depth_range!r} is not a positive number")
    check_ladder(scales, ratio, 1, 1e-4)
    first = resolve_width(width, gbuffer)
    if iterations is not None:
        from meshdepict.scales.diffusion import diffusion_width

        if isinstance(iterations, bool) or int(iterations) != iterations or iterations < 1:
            raise MeshdepictError(f"iterations={iterations!r} is not a whole number from 1 on")
        scales, first = 1, diffusion_width(int(iterations)) * gbuffer.edge_length
    widths = ladder(0 if filter == "none" else scales, ratio, first)
    pixels = widths / gbuffer.edge_length
    if filter == "diffusion":
        from meshdepict.scales.diffusion import MOST_STEPS, diffusion_steps, step_count

        count = step_count(float(pixels[-1]))
        if count > MOST_STEPS:
            raise MeshdepictError(
                f"a width of {pixels[-1]:.4g} pixels would take {count:.3g} steps of diffusion, at "
                f"most {MOST_STEPS:,} are possible: make width, scales or the picture smaller"
            )
        own = np.ascontiguousarray(gbuffer.normals.T, np.float32)
        share = _per_sample(importance, gbuffer)
        step = diffusion_steps(gbuffer, own, pixels, _conductance(gbuffer, own), importance=share)
    else:
        from meshdepict.scales.bilateral import bilateral_steps

        step = bilateral_steps(gbuffer, pixels, depth_range=depth_range)
    space = ImageSpace(gbuffer, widths, float(ratio), filter, step)
    space.smooth(at_once, progress=progress)
    return space


def _conductance(gbuffer: GBuffer, normals: Singles) -> Singles:
    """Return c = 1 − max(w_s, w_c) of the samples (n,), for normals (3, n)."""
    from meshdepict.curvature.image import largest_steps, least_cosines
    from meshdepict.curvature.view import conductance, smoothstep

    begin, end = _SILHOUETTE
    steps = largest_steps(gbuffer.index, gbuffer.depth_steps)
    creases = conductance(1.0, least_cosines(gbuffer.index, normals))
    if gbuffer.silhouettes == "occlusion":
        assert gbuffer.openness is not None  # or the buffer would have been refused
        open_ = np.where(np.isinf(steps), 0.0, np.clip(gbuffer.openness, 0, 1))
        return np.minimum(open_, creases).astype(np.float32)
    ratio = gbuffer.depth_ratio(steps)
    return np.minimum(1 - smoothstep((ratio - begin) / (end - begin)), creases).astype(np.float32)


def _per_sample(importance: ArrayLike | None, gbuffer: GBuffer) -> Singles | None:
    if importance is None:
        return None
    share = np.asarray(importance, np.float64)
    if share.shape == gbuffer.mask.shape:
        share = share[gbuffer.mask]
    if share.shape != gbuffer.depths.shape or not ((share >= 0) & (share <= 1)).all():
        raise MeshdepictError(
            "importance must be numbers from 0 to 1, one per pixel of the picture or of the mask"
        )
    return share.astype(np.float32)


def _same(view: View | str, own: View) -> bool:
    """Whether two views show one picture, of however many pixels."""
    if isinstance(view, str):
        return view in ("front", own.name)
    numbers = all(
        np.array_equal(getattr(view, name), getattr(own, name))
        for name in ("position", "focus", "up")
    )
    field = (view.parallel_scale, view.field_of_view) == (own.parallel_scale, own.field_of_view)
    return numbers and field
