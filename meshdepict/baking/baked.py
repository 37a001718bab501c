"""What a bake gives: colours on a shape, where they came from, and ways to keep and to see them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.provenance import comment_lines, was_baked
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from meshdepict.baking.choices import Choices
    from meshdepict.baking.refinement import EdgeError
    from meshdepict.drawing.figure import Figure
    from meshdepict.scales.space import ScaleSpace

__all__ = ["Baked", "Depiction"]


class Depiction:
    """A shape in its shading, of whatever kind: how it came about, ways to keep and to see it.

    What is the same for a mesh, an image and a volume; `Baked` and `BakedVolume` are the two kinds.

    Attributes
    ----------
    shape : Mesh, GBuffer or Volume
    provenance : dict of str
        Version, method, options, light, view, widths and the shape's digest.
    view : View
        The view that names of lights referred to, and that pictures show.
    look : Choices or None
        How it was baked, with what followed from the shape; None where nobody said.
    """

    def __init__(
        self,
        shape: Any,
        provenance: Mapping[str, str],
        view: View,
        look: Choices | None = None,
    ) -> None:
        self.shape = shape
        self.provenance = dict(provenance)
        self.view = view
        self.look = look

    @property
    def comments(self) -> list[str]:
        """The provenance as lines for a file's header."""
        return comment_lines(self.provenance)

    def save(self, path: str | Path) -> Path:
        """Write the shape with its colours; the suffix decides the format."""
        raise NotImplementedError

    def to_pyvista(self) -> Any:
        """Return the shape with its colours for PyVista."""
        raise NotImplementedError

    def show(self, **plotter: Any) -> Any:
        """Open a window in which a drag turns the object, or with Ctrl its light; h shows the keys.

        In notebooks and with keyword arguments a plain PyVista plot, with the colours as they are
        in this bake's view: they go to ``pyvista.Plotter``, ``jupyter_backend`` to its ``show``.

        Raises
        ------
        MeshdepictError
            Where there is no display.
        """
        from meshdepict.viewer.windows.showing import show

        return show(self, **plotter)

    def picture(
        self,
        path: str | Path,
        *,
        size: tuple[int, int] | str | None = None,
        dpi: float | None = None,
        background: str = "white",
        scale_bar: bool = False,
        unit: str = "",
        pixels_per_unit: float | None = None,
    ) -> Path:
        """Render a PNG of this bake in its view, without needing a display.

        Parameters
        ----------
        path : path
        size, dpi, background, scale_bar, unit, pixels_per_unit
            See `drawing.figure.Figure`: ``size="12x9cm", dpi=300, background="paper"``. Without a
            unit it is the shape's own, such as the millimetres of a CT.

        Raises
        ------
        MeshdepictError
            For another suffix, sizes and scales that are impossible or leave no room for the
            object, and where the file can't be written.
        """
        from meshdepict.drawing.figure import Figure

        figure = Figure(
            size=size, dpi=dpi, background=background, scale_bar=scale_bar, unit=unit,
            pixels_per_unit=pixels_per_unit,
        )  # fmt: skip
        return self._draw(path, figure)

    def _draw(self, path: str | Path, figure: Figure) -> Path:
        raise NotImplementedError


class Baked(Depiction):
    """Colours on a shape, and how they came about.

    Attributes
    ----------
    shape : Mesh or GBuffer
    colors : (n, 3) array of uint8
        sRGB.
    intensity : (n,) or (n, 3) array of float
        What the method returned, in [0, 1], before colour map and encoding.
    provenance : dict of str
        Version, method, options, light, view, widths and the mesh's digest.
    view : View
        The view that names of lights referred to, and that pictures show.
    space : ScaleSpace or None
        What was shaded, for the next light; None of a refined bake.
    look : Choices or None
        How it was baked, with what followed from the shape; None where nobody said.
    """

    def __init__(
        self,
        shape: Any,
        intensity: NDArray[Any],
        colors: NDArray[np.uint8],
        provenance: Mapping[str, str],
        view: View,
        *,
        space: ScaleSpace | None = None,
        look: Choices | None = None,
        shade: Callable[[ScaleSpace], NDArray[Any]] | None = None,
    ) -> None:
        super().__init__(shape, provenance, view, look)
        self.intensity = intensity
        self.colors = colors
        self.space = space
        self._shade = shade

    @functools.cached_property
    def edge_error(self) -> EdgeError | None:
        """How far colours between vertices are from shading there; measured when asked for.

        None where that can't be said: of a refined bake, two lights, and methods that look at more
        than a sample's own normals and curvature.
        """
        if self.space is None or self._shade is None or self.look is None:
            return None
        from meshdepict.baking.refinement import edge_error

        return edge_error(self.space, self._shade, linear=self.look.declared.linear)

    @functools.cached_property
    def light_error(self) -> float | None:
        """Grey levels (rms) that sampling an environment leaves; measured when asked for.

        None where no environment is sampled, and of what isn't shaded sample by sample.
        """
        if self.space is None or self._shade is None or self.look is None:
            return None
        from meshdepict.baking.light_error import light_error

        return light_error(self.space, self.look, self.view)

    def __repr__(self) -> str:
        """Return method and size."""
        return f"<Baked: {self.provenance['method']} on {len(self.colors):,} samples>"

    def _require_mesh(self) -> None:
        if self.shape.kind != "mesh":
            raise MeshdepictError(f"an {self.shape.kind} is no surface: save it, or bake a mesh")

    def save(self, path: str | Path) -> Path:
        """Write the shape with its colours; the suffix decides the format.

        ``.html`` is a page of its own that turns, offline, in any browser; see `save_page`. An
        image is written as a PNG. Of other formats, everything the input file had is kept. An
        existing file is replaced, once the new one is complete.

        Raises
        ------
        MeshdepictError
            For a format that holds no colours, or where the file cannot be written.
        """
        if self.shape.kind == "image":
            return self.picture(path)
        if Path(path).suffix.lower() in (".html", ".htm"):
            from meshdepict.viewer.page import save_page

            return save_page(self, path)
        from meshdepict.io import write_mesh

        write_mesh(path, self.shape, colors=self.colors, comments=self.comments)
        return Path(path)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData``: colours as "RGB", intensity as "depict_<method>".

        Polygons and other arrays are the shape's; its own colours become "original_RGB".
        """
        self._require_mesh()
        from meshdepict.shapes.document import Saving, recolored
        from meshdepict.shapes.exchange import to_polydata

        attributes = recolored(
            self.shape.attributes["vertex"], Saving(self.colors), ours=was_baked(self.shape)
        )
        attributes[f"depict_{self.provenance['method']}"] = self.intensity
        poly = to_polydata(
            self.shape.vertices,
            self.shape.faces if self.shape.polygons is None else self.shape.polygons,
            attributes,
            self.shape.attributes["face"],
            self.comments,
        )
        poly.set_active_scalars("RGB", preference="point")
        return poly

    def to_trimesh(self) -> Any:
        """Return a ``trimesh.Trimesh`` with vertex colours, vertices in the same order."""
        self._require_mesh()
        import trimesh

        vertices, faces = self.shape.vertices.copy(), self.shape.faces.copy()
        return trimesh.Trimesh(vertices, faces, vertex_colors=self.colors, process=False)

    def show(self, **plotter: Any) -> Any:
        """As for every bake; an image has no window."""
        self._require_mesh()
        return super().show(**plotter)

    def _draw(self, path: str | Path, figure: Figure) -> Path:
        from meshdepict.drawing.picture import save_image, save_picture

        if self.shape.kind == "image":
            return save_image(self, path, background=figure.background)
        return save_picture(self, path, figure)
