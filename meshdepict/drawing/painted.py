"""What can be drawn: anything that has a shape, its colours and a view; bakes, for instance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.names import Lighting, LightsLike
from meshdepict.scene.shape import Shape
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.scales.grid_scales import GridSpace
    from meshdepict.shapes.appearance import Appearance
    from meshdepict.shapes.gbuffer import GBuffer
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.voxels.grid import Grid

__all__ = ["Depicted", "Painted", "PaintedVolume", "TexturedMesh", "Turnable"]


class Depicted(Protocol):
    """A shape in its shading, of whatever kind."""

    @property
    def shape(self) -> Shape:
        """A `Mesh`, `GBuffer` or `Volume`."""

    @property
    def view(self) -> View:
        """What pictures show."""

    @property
    def provenance(self) -> dict[str, str]:
        """What pictures say about how they came about."""

    @property
    def ground(self) -> str:
        """What pictures lie on unless told otherwise."""

    @property
    def comments(self) -> list[str]:
        """The same as lines."""

    def to_pyvista(self) -> Any:
        """Return the shape for VTK: colours as "RGB", of voxels as "RGBA"."""


class Painted(Depicted, Protocol):
    """A mesh, a height field or an image in its colours; see `Baked`."""

    @property
    def shape(self) -> Mesh | HeightField | GBuffer:
        """What is shaded."""

    @property
    def mesh(self) -> Mesh:
        """Its surface, a vertex for each colour; an image has none."""

    @property
    def colors(self) -> NDArray[np.uint8]:
        """(n, 3) sRGB."""


class TexturedMesh(Depicted, Protocol):
    """A mesh with its shading in a texture; see `BakedTexture`."""

    @property
    def shape(self) -> Mesh:
        """What is shaded."""

    @property
    def appearance(self) -> Appearance:
        """The texture on the mesh."""


class PaintedVolume(Depicted, Protocol):
    """Voxels in their colours; see `BakedVolume`."""

    @property
    def shape(self) -> Grid:
        """Where the voxels are, and their values."""

    @property
    def rgba(self) -> NDArray[np.uint8]:
        """(nz, ny, nx, 4) sRGB and opacity."""

    @property
    def space(self) -> GridSpace | None:
        """The samples, where they are kept."""

    @property
    def intensity(self) -> NDArray[np.float32] | None:
        """What the method returned for the samples."""

    @property
    def transfer(self) -> TransferFunction | None:
        """What is shown."""

    @property
    def linear(self) -> bool:
        """Whether the intensity is linear light."""


class Turnable(Protocol):
    """A shape under a light, both of which can be turned; see `Session`."""

    light: Lighting

    @property
    def shape(self) -> Mesh | HeightField:
        """What turns."""

    @property
    def view(self) -> View:
        """Where the eye is."""

    @property
    def colors(self) -> NDArray[np.uint8]:
        """(n, 3) sRGB of now."""

    def baked(self) -> Painted:
        """Return the shape in the colours of now."""

    def shine(self, light: LightsLike) -> None:
        """Change the light."""

    def look(self, view: str | View) -> None:
        """Look from elsewhere."""
