"""The samples of a texture, band by band: all of them at once would take gigabytes."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.gutters import fill_gutters, put_texels
from meshdepict.scales.mapped_normals import NormalMaps
from meshdepict.scales.space import ScaleSpace
from meshdepict.scales.texel_scales import TexelSpace
from meshdepict.threads import each

if TYPE_CHECKING:
    from meshdepict.baking.atlases import Atlas
    from meshdepict.baking.finer_surface import FinerSurface
    from meshdepict.scales.ladder import Progress
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["Ladder", "Paint", "Places", "TexelSampling", "usable_normal_maps"]

_SPREAD = 30_000  # samples that stand for all
# Multiples of these fill the unit square evenly: powers of the root of x³ = x + 1.
_STEPS = (0.7548776662466927, 0.5698402909980532)

Ladder = tuple[int, float]
Bytes = NDArray[np.uint8]


class Places(NamedTuple):
    """Where some texels lie: on the mesh that has the texture, and on the one that is shaded.

    Attributes
    ----------
    triangle, weights : (n,) and (n, 3) arrays
        Of the mesh with the texture.
    shaded_triangle, shaded_weights : (n,) and (n, 3) arrays
        The same, unless detail comes from a finer mesh.
    corners : (n, 3) array of int32
        Vertices of that triangle.
    """

    triangle: NDArray[np.int32]
    weights: NDArray[np.float32]
    shaded_triangle: NDArray[np.int32]
    shaded_weights: NDArray[np.float32]
    corners: NDArray[np.int32]


Paint = Callable[[Places, Mapping[Ladder, ScaleSpace]], Bytes]


@dataclass(frozen=True, eq=False)
class TexelSampling:
    """Where the texels of a texture lie, and the scale spaces that they are samples of.

    Attributes
    ----------
    mesh : Mesh
        That has the texture.
    atlas : Atlas
    spaces : {(scales, ratio): ScaleSpace}
        Of the mesh that is shaded.
    mapped : NormalMaps, optional
        Its normal maps.
    finer : FinerSurface, optional
        What finds places on a finer mesh, which then is the one that is shaded.
    albedo : callable (places) → (n, 3) array, optional
        The mesh's own colours, sRGB in [0, 1].
    """

    mesh: Mesh
    atlas: Atlas
    spaces: Mapping[Ladder, ScaleSpace]
    mapped: NormalMaps | None = None
    finer: FinerSurface | None = None
    albedo: Callable[[Places], NDArray[Any]] | None = None

    @property
    def described(self) -> str:
        """In words for provenance."""
        size = self.atlas.size
        said = f"{size} x {size} texels, atlas {self.atlas.kind}"
        if self.mapped is not None:
            said += ", normals of its normal map"
        return said if self.finer is None else f"{said}, detail {self.finer.described}"

    def image(self, paint: Paint, *, progress: Progress | None = None) -> Bytes:
        """Return the picture (size, size, 3) whose texels get the colours that `paint` returns.

        Those outside every triangle get the nearest colour; see `fill_gutters`.

        Parameters
        ----------
        paint : callable (places, spaces) → (n, 3) array of uint8
            Called by several threads.
        progress : callable, optional
            ``progress(done, total)``.
        """
        size, bands = self.atlas.size, self.atlas.bands
        image, inside = np.zeros((size, size, 3), np.uint8), np.zeros((size, size), bool)
        finished = 0
        if self.finer is not None:
            self.finer.begin()

        def work(begin: int, end: int) -> None:
            texels = self.atlas.grid.texels(begin, end)
            if len(texels.place):
                places = self._places(texels.triangle, texels.weights)
                colors = paint(places, self._samples(places))
                put_texels(image[begin:end], inside[begin:end], texels.place, colors)

        def done(_: int) -> None:
            nonlocal finished
            finished += 1
            if progress:
                progress(finished, len(bands))

        each(work, bands, done)
        if self.finer is not None:
            self.finer.tell()
        fill_gutters(image, inside, self.atlas.gutter)
        return image

    def spread(self) -> Mapping[Ladder, ScaleSpace]:
        """Return samples for numbers that follow the shape: the vertices, or with maps some texels.

        These are as dense everywhere.
        """
        if self.mapped is None:
            return self.spaces
        a, b, c = (self.mesh.unit_points[corner] for corner in self.mesh.faces.T)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        upto = np.cumsum(areas)
        number = np.arange(_SPREAD) + 0.5
        place = np.searchsorted(upto, number / _SPREAD * upto[-1])
        triangle = np.minimum(place, len(areas) - 1).astype(np.int32)
        one, other = (np.float32(number * step % 1) for step in _STEPS)
        root = np.sqrt(one)
        weights = np.stack([1 - root, root * (1 - other), root * other], axis=1)
        return self._samples(self._places(triangle, weights))

    def _places(self, triangle: NDArray[np.int32], weights: NDArray[np.float32]) -> Places:
        shaded = triangle, weights
        if self.finer is not None:
            shaded = self.finer.places(triangle, weights)
        return Places(triangle, weights, *shaded, np.take(self._faces, shaded[0], axis=0))

    @cached_property
    def _faces(self) -> NDArray[np.int32]:
        """Of the mesh that is shaded."""
        return next(iter(self.spaces.values())).surface.faces.astype(np.int32)

    def _samples(self, places: Places) -> dict[Ladder, ScaleSpace]:
        return {
            ladder: TexelSpace(
                space, places.corners, places.shaded_weights,
                maps=self.mapped, triangle=places.shaded_triangle,
            )
            for ladder, space in self.spaces.items()
        }  # fmt: skip


def usable_normal_maps(
    textures: Textures | None, mesh: Mesh, spaces: Mapping[Ladder, ScaleSpace]
) -> NormalMaps | None:
    """Return the normal maps of a mesh, if it has any that can be had."""
    if textures is None or not any(each is not None for each in textures.normal_maps):
        return None
    kept = []
    for texture in textures.normal_maps:
        try:
            if texture is not None:
                _ = texture.pixels
            kept.append(texture)
        except MeshdepictError as error:
            warnings.warn(f"{error}: shaded without it", MeshdepictWarning, stacklevel=3)
            kept.append(None)
    if not any(each is not None for each in kept):
        return None
    textures = replace(textures, normal_maps=tuple(kept))
    return NormalMaps(mesh, next(iter(spaces.values())).normals_at(0), textures)
