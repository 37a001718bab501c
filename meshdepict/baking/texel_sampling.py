"""The samples of a texture, band by band: all of them at once would take gigabytes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.images.gutters import fill_gutters
from meshdepict.scales.mapped_normals import mapped_normals
from meshdepict.scales.space import ScaleSpace
from meshdepict.scales.texel_scales import TexelSpace
from meshdepict.threads import each

if TYPE_CHECKING:
    from meshdepict.baking.atlases import Atlas
    from meshdepict.baking.finer_surface import FinerSurface
    from meshdepict.scales.ladder import Progress
    from meshdepict.scales.mapped_normals import TangentFrames
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["Places", "TexelSampling"]

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
    mapped : (TangentFrames, Textures), optional
        Its normal maps.
    finer : FinerSurface, optional
        What finds places on a finer mesh, which then is the one that is shaded.
    """

    mesh: Mesh
    atlas: Atlas
    spaces: Mapping[Ladder, ScaleSpace]
    mapped: tuple[TangentFrames, Textures] | None = None
    finer: FinerSurface | None = None

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

        def work(begin: int, end: int) -> None:
            texels = self.atlas.grid.texels(begin, end)
            if len(texels.place):
                places = self._places(texels.triangle, texels.weights)
                colors = paint(places, self._samples(places))
                image[begin:end].reshape(-1, 3)[texels.place] = colors
                inside[begin:end].reshape(-1)[texels.place] = True

        def done(_: int) -> None:
            nonlocal finished
            finished += 1
            if progress:
                progress(finished, len(bands))

        each(work, bands, done)
        fill_gutters(image, inside, self.atlas.gutter)
        return image

    def _places(self, triangle: NDArray[np.int32], weights: NDArray[np.float32]) -> Places:
        shaded = triangle, weights
        if self.finer is not None:
            shaded = self.finer.places(triangle, weights)
        faces = next(iter(self.spaces.values())).surface.faces
        return Places(triangle, weights, *shaded, faces[shaded[0]].astype(np.int32))

    def _samples(self, places: Places) -> dict[Ladder, ScaleSpace]:
        normals = None
        if self.mapped is not None:
            normals = mapped_normals(*self.mapped, places.triangle, places.weights)
        return {
            ladder: TexelSpace(space, places.corners, places.shaded_weights, normals=normals)
            for ladder, space in self.spaces.items()
        }
