"""GBuffer: what every pixel of a view sees of a surface: normal, depth, position and mask."""

from __future__ import annotations

import dataclasses
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers
from meshdepict.images.pixel_samples import PixelSamples, check_size, finite
from meshdepict.scene.vectors import frozen
from meshdepict.shapes.fingerprint import fingerprint
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.summary import image_rows
from meshdepict.shapes.table import html_table

if TYPE_CHECKING:
    from pathlib import Path

    from meshdepict.scene.view import View

__all__ = ["GBuffer"]

Floats = NDArray[np.float64]

SILHOUETTES = ("depth", "occlusion")
_UNIT = 1e-3  # how far a unit normal's length may be off: single precision and more


class GBuffer(PixelSamples):
    """Samples at the pixels of a picture, each with normal and depth; a shape like others.

    Made by `of` from a mesh and a view, or by `from_images`. The samples are the pixels of the
    mask alone, row by row from the top left; `image` puts values of samples back into a picture.

    Attributes
    ----------
    view : View
        Its ``height_px`` is the picture's.
    mask : (height, width) array of bool
        Where there is a surface.
    normals : (n, 3) array
        Unit, in world space, of the samples.
    depths : (n,) array
        Distances of the samples from the eye along the view's axis, in world units.
    mesh : Mesh or None
        What was seen, with for each sample ``triangle``, the number of its triangle (n,), and
        ``barycentric``, its coordinates there (n, 3).
    openness : (n,) array or None
        Ambient occlusion that came with images: 1 where open.
    colors : (n, 3) array of uint8 or None
        Display colours that came with images: those of the surface itself.
    silhouettes : {"depth", "occlusion"}
        What Light Warping's silhouettes are told by; see `from_images`.

    Raises
    ------
    MeshdepictError
        For an empty mask, no pixel or more than 16384 across, arrays of other lengths, numbers
        that are not finite, normals that are not unit, and depths ≤ 0 in a perspective view.
    """

    kind = "image"

    def __init__(
        self,
        view: View,
        mask: ArrayLike,
        normals: ArrayLike,
        depths: ArrayLike,
        *,
        openness: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        silhouettes: str = "depth",
    ) -> None:
        super().__init__(view, mask, depths)
        count = len(self.depths)
        self.normals = finite(normals, (count, 3), "normals")
        with any_numbers():
            length = np.linalg.norm(self.normals, axis=1)
        off = int(np.count_nonzero(~(np.abs(length - 1) <= _UNIT)))
        if off:
            raise MeshdepictError(
                f"normals of {off:,} pixels are not of unit length: normalise them"
            )
        self.openness = None if openness is None else finite(openness, (count,), "openness")
        self.colors: NDArray[np.uint8] | None = None
        if colors is not None:
            levels = finite(colors, (count, 3), "colors")
            if ((levels < 0) | (levels > 255) | (levels % 1 != 0)).any():
                raise MeshdepictError("colors must be whole numbers from 0 to 255")
            self.colors = frozen(levels.astype(np.uint8))
        if not isinstance(silhouettes, str) or silhouettes not in SILHOUETTES:
            raise MeshdepictError(
                f"silhouettes={silhouettes!r} is not one of {', '.join(SILHOUETTES)}"
            )
        if silhouettes == "occlusion" and openness is None:
            raise MeshdepictError(
                "silhouettes='occlusion' needs an occlusion image: give one, or leave it out"
            )
        self.silhouettes = silhouettes
        self.mesh: Mesh | None = None
        self.triangle: NDArray[np.int32] | None = None
        self.barycentric: Floats | None = None

    @classmethod
    def of(
        cls,
        shape: Mesh | HeightField,
        view: View | str = "front",
        *,
        size: tuple[int, int] | None = None,
    ) -> GBuffer:
        """Look at a mesh: cast a ray through the centre of every pixel.

        Parameters
        ----------
        shape : Mesh or HeightField
            Of terrain its ground as a mesh.
        view : View or str
            A named one is fitted to the shape and the picture. The picture shows the height that
            the view says, whatever its number of pixels.
        size : (width, height), optional
            In pixels; the view's height, and a square, unless given.

        Raises
        ------
        MeshdepictError
            Where the view shows nothing of the shape, and for a size beyond 1 … 16384.
        """
        from meshdepict.scene.view import View
        from meshdepict.shapes.visibility import visible_surface

        if isinstance(shape, HeightField):
            shape = shape.mesh
        if not isinstance(shape, Mesh):
            raise MeshdepictError(f"a {type(shape).__name__} can't be looked at: give a Mesh")
        if size is None:
            side = view.height_px if isinstance(view, View) else 1000
            size = side, side
        width, height = check_size(size)
        if not isinstance(view, View):
            view = View.fitted(view, shape, aspect=width / height, height_px=height)
        view = dataclasses.replace(view, height_px=height)
        mask, triangle, shares, depths = visible_surface(shape, view, width)
        if not mask.any():
            raise MeshdepictError(
                f"the view {str(view).strip()} shows nothing of the shape: turn or move it, or "
                "make the picture larger"
            )
        vertices = shape.faces[triangle]
        normals = _interpolated(shape.normals, vertices, shares)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        # Where the corners' normals cancel: that of the nearest one.
        corner = np.take_along_axis(vertices, shares.argmax(axis=1)[:, None], axis=1)[:, 0]
        firm = length > 1e-9
        normals = np.where(firm, normals / np.where(firm, length, 1), shape.normals[corner])
        buffer = cls(view, mask, normals, depths)
        buffer.mesh, buffer.triangle, buffer.barycentric = shape, frozen(triangle), frozen(shares)
        return buffer

    @classmethod
    def from_images(
        cls,
        normals: ArrayLike | str | Path,
        depth: ArrayLike | str | Path | None = None,
        mask: ArrayLike | str | Path | None = None,
        occlusion: ArrayLike | str | Path | None = None,
        *,
        view: View | None = None,
        green: str = "up",
        depth_scale: float | str = 1.0,
        colors: ArrayLike | str | Path | None = None,
        silhouettes: str = "depth",
    ) -> GBuffer:
        """Take a normal map, and what else there is: arrays, or image files.

        Parameters
        ----------
        normals : (h, w, 3 or 4) array_like or path
            In view space: x right, y up, z to the eye. Unsigned numbers, which images hold, stand
            for −1 … 1 from 0 to the largest of their type, others for themselves. Normalised, with
            a warning where lengths are off by more than 1 %.
        depth : (h, w) array_like or path, optional
            Distance from the eye along the view's axis. Without one, all lies in one plane.
        mask : (h, w) array_like or path, optional
            Nonzero where there is a surface. Unless given, where the normal map is opaque (alpha)
            and says something: neither black nor nearly zero.
        occlusion : (h, w) array_like or path, optional
            1 (or the largest unsigned number) where all light arrives.
        view : View, optional
            From the front, parallel, one world unit a pixel, unless given.
        green : {"up", "down"}
            Where the normal map's second channel points.
        depth_scale : float or "fit"
            World units per unit of the depth image; negative where near is bright. "fit" takes
            what makes the slopes of the depth those of the normals.
        colors : (h, w, 3 or 4) array_like or path, optional
            Display colours of the surface, as an RGBN image has them: unsigned numbers, or
            fractions. ``albedo="keep"`` multiplies them.
        silhouettes : {"depth", "occlusion"}
            What curvature as the view sees it, and diffusion, stop at, beside creases: where the
            depth jumps, or, of RGBN images, which have none, where the occlusion map is dark (Light
            Warping, §4.4): w_s = 1 − occlusion. The mask's border is a silhouette either way.

        Raises
        ------
        MeshdepictError
            For files that can't be read, images of different sizes, an empty mask, and values that
            make no sense.
        """
        from meshdepict.images.image_files import depth_unit, image_colors, surface_images
        from meshdepict.scene.view import View

        if view is not None and not isinstance(view, View):
            raise MeshdepictError(f"view={view!r} is no View")
        found = surface_images(normals, depth, mask, occlusion, green=green)
        height, width = found.mask.shape
        check_size((width, height))
        if view is None:
            view = View(
                (0, 0, height), (0, 0, 0), (0, 1, 0), parallel_scale=height / 2, height_px=height
            )
        here = found.mask
        away = np.full(here.shape, float(np.linalg.norm(view.position - view.focus)))
        if found.depth is not None:
            away = found.depth * depth_unit(depth_scale, found, view)
        openness = None if found.occlusion is None else found.occlusion[here]
        shown = None if colors is None else image_colors(colors, here.shape)[here]
        return cls(
            view, here, found.normals[here] @ view.frame, away[here],
            openness=openness, colors=shown, silhouettes=silhouettes,
        )  # fmt: skip

    def __repr__(self) -> str:
        """Return size and number of samples."""
        width, height = self.size
        return f"<GBuffer: {width} x {height} pixels, {len(self.normals):,} samples>"

    def _repr_html_(self) -> str:
        """Return a table for notebooks."""
        return html_table([*image_rows(self)], "GBuffer")

    # --- what every kind of shape has -------------------------------------------------------

    @cached_property
    def centre(self) -> Floats:
        """(3,) middle of the bounding box."""
        if self.mesh is not None:
            return self.mesh.centre
        return frozen(self.points.min(axis=0) / 2 + self.points.max(axis=0) / 2)

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the bounding box, the mesh's where there is one, in world units."""
        if self.mesh is not None:
            return self.mesh.diagonal
        extent = self.points.max(axis=0) - self.points.min(axis=0)
        largest = float(extent.max())
        return largest and largest * float(np.linalg.norm(extent / largest))

    @property
    def length_unit(self) -> str:
        """What world units are, the mesh's where there is one; empty where unknown."""
        return "" if self.mesh is None else self.mesh.length_unit

    def recentred(self, points: Floats) -> Floats:
        """Return world positions (…, 3) relative to the centre, in diagonals."""
        moved: Floats = (points - self.centre) / (self.diagonal or 1.0)
        return moved

    @property
    def identity(self) -> str:
        """Size, number of samples, and the fingerprint of mask, normals and depths."""
        width, height = self.size
        digest = fingerprint(self.mask, self.normals, self.depths)
        return f"{width} x {height} pixels {len(self.normals)} samples sha256 {digest}"

    def sample(self, values: ArrayLike) -> NDArray[Any]:
        """Return values of the mesh's vertices, (v,) or (v, k), interpolated at the samples.

        Raises
        ------
        MeshdepictError
            For another number of values, and where the buffer came from images.
        """
        if self.mesh is None or self.triangle is None or self.barycentric is None:
            raise MeshdepictError("there are no vertices to interpolate: this came from images")
        values, count = np.asarray(values), len(self.mesh.vertices)
        if values.ndim not in (1, 2) or len(values) != count:
            raise MeshdepictError(
                f"values of shape {values.shape} are not one for each of {count:,} vertices"
            )
        return _interpolated(values, self.mesh.faces[self.triangle], self.barycentric)


def _interpolated(values: NDArray[Any], vertices: NDArray[Any], shares: Floats) -> NDArray[Any]:
    """Return values at places in triangles: vertices (n, 3), shares (n, 3)."""
    parts = (
        values[v] * (s if values.ndim == 1 else s[:, None])
        for v, s in zip(vertices.T, shares.T, strict=True)
    )
    return next(parts) + next(parts) + next(parts)
