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
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh

if TYPE_CHECKING:
    from meshdepict.baking.choices import Choices
    from meshdepict.baking.refinement import EdgeError
    from meshdepict.drawing.figure import Figure
    from meshdepict.drawing.page import Page
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.scene.shape import Shape
    from meshdepict.shapes.appearance import Appearance

__all__ = ["PAGES", "Baked", "Depiction"]

PAGES = (".html", ".htm")
"""Suffixes of pages that turn."""

_IN_NOTEBOOKS = (480, 480)  # pixels: beside a cell, and drawn at once


class Depiction:
    """A shape in its shading, of whatever kind: how it came about, ways to keep and to see it.

    What is the same for a mesh, an image and a volume; `Baked` and `BakedVolume` are the two kinds.

    Attributes
    ----------
    shape : Mesh, HeightField, GBuffer or Volume
    provenance : dict of str
        Version, method, options, light, view, widths and the shape's digest.
    view : View
        The view that names of lights referred to, and that pictures show.
    look : Choices or None
        How it was baked, with what followed from the shape; None where nobody said.
    """

    def __init__(
        self,
        shape: Shape,
        provenance: Mapping[str, str],
        view: View,
        look: Choices | None = None,
    ) -> None:
        self.shape = shape
        self.provenance = dict(provenance)
        self.view = view
        self.look = look

    @property
    def ground(self) -> str:
        """What pictures lie on unless told otherwise: as the method declares."""
        return "white" if self.look is None else self.look.declared.ground

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

    def plot(self, **words: Any) -> Any:
        """Show this bake as PyVista's ``mesh.plot`` shows a mesh, in the colours that it has.

        Parameters
        ----------
        **words
            As for ``pyvista.plot``: ``off_screen``, ``window_size``, ``screenshot``,
            ``return_img``, ``return_cpos``, ``jupyter_backend``, ``cpos``, and of meshes those of
            ``add_mesh``. Without ``cpos`` the view is this bake's.

        Raises
        ------
        MeshdepictError
            For other words, and where there is no display.
        """
        from meshdepict.drawing.plotting import plot_and_show

        return plot_and_show(self, **words)

    def picture(
        self,
        path: str | Path,
        *,
        size: tuple[int, int] | str | None = None,
        dpi: float | None = None,
        background: str | None = None,
        scale_bar: bool = False,
        unit: str = "",
        pixels_per_unit: float | None = None,
        caption: str = "",
    ) -> Path:
        """Render a picture of this bake in its view, without needing a display.

        Parameters
        ----------
        path : path
            Ends in .png, .jpg, .svg or .pdf. In the last two scale bar and caption are vectors.
        size, dpi, background, scale_bar, unit, pixels_per_unit, caption
            See `drawing.figure.Figure`: ``size="12x9cm", dpi=300, background="paper"``. Without a
            unit it is the shape's own, such as the millimetres of a CT.

        Raises
        ------
        MeshdepictError
            For another suffix, sizes and scales that are impossible or leave no room for the
            object, and where the file can't be written.
        """
        from meshdepict.drawing.figure import Figure
        from meshdepict.drawing.picture_files import check_picture, write_page

        figure = Figure(
            size=size, dpi=dpi, background=background, scale_bar=scale_bar, unit=unit,
            pixels_per_unit=pixels_per_unit, caption=caption,
        )  # fmt: skip
        figure = figure.on(self.ground)
        check_picture(path, figure)
        return write_page(self._page(figure), path, self.provenance)

    def _page(self, figure: Figure) -> Page:
        """Return what `picture` writes, laid out in a figure."""
        raise NotImplementedError

    def _save_page(
        self, path: str | Path, mesh: Mesh, appearances: Mapping[str, Appearance]
    ) -> Path:
        """Write a page of a mesh that turns; see `viewer.page`."""
        from meshdepict.viewer.page import save_page

        return save_page(path, mesh, self.view, self.provenance, appearances)

    def _repr_png_(self) -> bytes | None:
        """Return a small picture, which notebooks show; None where nothing can be drawn."""
        from meshdepict.drawing.figure import Figure
        from meshdepict.drawing.picture_files import encoded

        try:
            return encoded(self._page(Figure(size=_IN_NOTEBOOKS)), ".png")
        except (MeshdepictError, ImportError, OSError, RuntimeError):
            return None  # then they show the repr


class Baked(Depiction):
    """Colours on a shape, and how they came about.

    Attributes
    ----------
    shape : Mesh, HeightField or GBuffer
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
    scene : Baked or None
        What pictures show: it with all that it was baked together with, and their ground. None:
        itself.
    """

    shape: Mesh | HeightField | GBuffer
    scene: Baked | None = None

    def __init__(
        self,
        shape: Mesh | HeightField | GBuffer,
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

    @property
    def mesh(self) -> Mesh:
        """The shape, where it is a mesh; of a height field the ground as one.

        Raises
        ------
        MeshdepictError
            Of an image.
        """
        if isinstance(self.shape, GBuffer):
            raise MeshdepictError(f"an {self.shape.kind} is no surface: save it, or bake a mesh")
        return self.shape.mesh if isinstance(self.shape, HeightField) else self.shape

    @property
    def appearances(self) -> dict[str, Appearance]:
        """How the mesh looks, and how it looks in its file where that has colours, by names."""
        from meshdepict.baking.own_colors import own_appearance
        from meshdepict.shapes.appearance import Appearance

        mesh = self.mesh
        found = {self.provenance["method"].replace("_", " "): Appearance(mesh, self.colors)}
        own = own_appearance(mesh) if isinstance(self.shape, Mesh) else None
        return found if own is None else {**found, own.name: own}

    def save(self, path: str | Path) -> Path:
        """Write the shape with its colours; the suffix decides the format.

        ``.html`` is a page of its own that turns, offline, in any browser, beside the file's own
        colours or texture, if there are any; see `save_page`. An
        image is written as a picture, and so is a height field as ``.png``, ``.jpg`` or ``.tif``:
        on its raster, at its place on the map. Of other formats, everything the input file had is
        kept, and the materials and pictures that it names are copied along. An existing file is
        replaced, once the new one is complete.

        Raises
        ------
        MeshdepictError
            For a format that holds no colours, or where the file cannot be written.
        """
        if isinstance(self.shape, GBuffer):
            return self.picture(path)
        if isinstance(self.shape, HeightField):
            from meshdepict.io.relief_files import RELIEFS

            if Path(path).suffix.lower() in RELIEFS:
                return self._save_relief(self.shape, Path(path))
        if Path(path).suffix.lower() in PAGES:
            return self._save_page(path, self.mesh, self.appearances)
        from meshdepict.io import write_mesh

        write_mesh(path, self.mesh, colors=self.colors, comments=self.comments)
        return Path(path)

    def _save_relief(self, field: HeightField, path: Path) -> Path:
        from meshdepict.io.relief_files import relief_writer

        gray = bool((self.colors == self.colors[:, :1]).all())
        raster = field.image(self.colors[:, 0] if gray else self.colors)
        with relief_writer(
            path, like=field, kind="gray" if gray else "color", provenance=self.provenance
        ) as file:
            file.write(slice(None), slice(None), raster, field.valid)
        return path

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData``: colours as "RGB", intensity as "depict_<method>".

        Polygons and other arrays are the shape's; its own colours become "original_RGB".
        """
        mesh = self.mesh
        from meshdepict.shapes.document import Saving, recolored
        from meshdepict.shapes.exchange import to_polydata

        attributes = recolored(mesh.attributes["vertex"], Saving(self.colors), ours=was_baked(mesh))
        attributes[f"depict_{self.provenance['method']}"] = self.intensity
        poly = to_polydata(
            mesh.vertices,
            mesh.faces if mesh.polygons is None else mesh.polygons,
            attributes,
            mesh.attributes["face"],
            self.comments,
        )
        poly.set_active_scalars("RGB", preference="point")
        return poly

    def to_trimesh(self) -> Any:
        """Return a ``trimesh.Trimesh`` with vertex colours, vertices in the same order."""
        mesh = self.mesh
        import trimesh

        vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
        return trimesh.Trimesh(vertices, faces, vertex_colors=self.colors, process=False)

    def show(self, **plotter: Any) -> Any:
        """As for every bake; an image has no window."""
        _ = self.mesh  # refuses an image
        return super().show(**plotter)

    def plot(self, **words: Any) -> Any:
        """As for every bake; an image has no surface."""
        _ = self.mesh
        return super().plot(**words)

    def _page(self, figure: Figure) -> Page:
        """Return what `picture` writes: of an image its pixels, just as they are."""
        from meshdepict.drawing.picture import draw_page, image_page

        if isinstance(self.shape, GBuffer):
            return image_page(self, figure)
        return draw_page(self.scene or self, figure)
