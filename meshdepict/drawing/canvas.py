"""Drawing off screen: baked colours as they are, with clean edges, once or frame by frame."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.display import check_opengl
from meshdepict.drawing.textured import add_appearance, is_textured

if TYPE_CHECKING:
    from meshdepict.drawing.painted import Painted, TexturedMesh
    from meshdepict.drawing.plotter import Camera, Plotter
    from meshdepict.scene.shape import Shape
    from meshdepict.scene.view import View
    from meshdepict.shapes.data_set import PolyData

__all__ = [
    "Canvas",
    "add_drawn",
    "add_painted",
    "canvas",
    "off_screen",
    "on_ground",
    "only_errors",
    "pixels_of",
    "place",
    "unit_polydata",
]

Bytes = NDArray[np.uint8]

# Samples of a picture up to which a pixel's side has three and two of them.
_FINE, _COARSE = 40_000_000, 250_000_000
_SIDE = 16384


class Canvas:
    """An off-screen window with one shape in it; see `canvas`."""

    def __init__(self, baked: Painted | TexturedMesh, window: Plotter, finer: int) -> None:
        self.shape = baked.shape
        self._window, self._finer = window, finer
        self._poly = None if is_textured(baked) else unit_polydata(cast("Painted", baked))
        add_drawn(window, baked, poly=self._poly)

    def draw(self, view: View, colors: Bytes | None = None) -> Bytes:
        """Draw the shape, with other colours where given, but not of a texture.

        Returns
        -------
        (height, width, 4) array of uint8
            Colour times coverage, and coverage.
        """
        from PIL import Image

        if colors is not None:
            assert self._poly is not None
            self._poly.point_data["RGB"][:] = colors
            self._poly.point_data["RGB"].VTKObject.Modified()
            self._poly.Modified()
        image = pixels_of(self._window, view, self.shape)
        # As four independent channels: Pillow would divide those of an RGBA by the coverage.
        height, width = image.shape[:2]
        channels = np.ascontiguousarray(image)
        four = Image.frombuffer("CMYK", (width, height), channels, "raw", "CMYK", 0, 1)
        return np.asarray(four.reduce(self._finer))


@contextmanager
def canvas(
    baked: Painted | TexturedMesh, size: tuple[int, int], *, samples: int = 3
) -> Iterator[Canvas]:
    """Give a canvas for a bake, and close it.

    Parameters
    ----------
    baked : Painted or TexturedMesh
    size : (int, int)
        Width and height in pixels.
    samples : int
        Along a pixel's side; fewer where memory could not take them.
    """
    finer = min(samples, _samples(size))
    with off_screen((size[0] * finer, size[1] * finer)) as window:
        yield Canvas(baked, window, finer)


@contextmanager
def off_screen(size: tuple[int, int]) -> Iterator[Plotter]:
    """Give a ``pyvista.Plotter`` of a size in pixels, on black, that no screen shows; close it."""
    import pyvista as pv

    with only_errors():
        window = pv.Plotter(off_screen=True, window_size=list(size))
        try:
            check_opengl(window)
            # Where each sample either hits or misses, coverage and colour average without a fringe.
            window.disable_anti_aliasing()
            window.set_background("black")
            yield window
        finally:
            window.close()


def pixels_of(window: Plotter, view: View, shape: Shape) -> Bytes:
    """Return what a window shows in a view, (height, width, 4): colour times coverage, coverage."""
    place(window.camera, view, shape)
    window.reset_camera_clipping_range()
    window.render()
    return np.asarray(window.screenshot(return_img=True, transparent_background=True))


def add_painted(window: Plotter, poly: PolyData, **looks: Any) -> None:
    """Add a ``pyvista.PolyData`` to a plotter, its "RGB" just as it is unless told otherwise."""
    usual = {"scalars": "RGB", "rgb": True, "lighting": False, "show_scalar_bar": False}
    window.add_mesh(poly, **usual | looks)


def add_drawn(
    window: Plotter, baked: Painted | TexturedMesh, *, poly: PolyData | None = None, **looks: Any
) -> None:
    """Add a bake to a plotter, in its own diagonals about the origin, colours just as they are.

    Parameters
    ----------
    window : pyvista.Plotter
    baked : Painted or TexturedMesh
    poly : pyvista.PolyData, optional
        The `unit_polydata` of the former where it is at hand.
    **looks
        For ``add_mesh``.
    """
    if is_textured(baked):
        add_appearance(window, baked.appearance, **looks)
    else:
        add_painted(window, poly or unit_polydata(cast("Painted", baked)), **looks)


def on_ground(premultiplied: Bytes, ground: tuple[int, int, int] | None) -> Bytes:
    """Lay colours times coverage, and coverage, (h, w, 4), on a ground.

    Returns
    -------
    (h, w, 3) array of uint8; (h, w, 4) with plain colours where the ground is transparent
    """
    colors, coverage = premultiplied[..., :3], premultiplied[..., 3:]
    if ground is not None:
        # What of the ground shows through, by coverage; never more than colours leave of 255.
        through = np.rint(np.outer(np.arange(255, -1, -1), ground) / 255).astype(np.uint8)
        return colors + through[coverage[..., 0]]
    edge = (coverage > 0) & (coverage < 255)
    divided = np.minimum(colors * np.float32(255) / np.maximum(coverage, 1) + 0.5, 255)
    plain = np.where(edge, divided, colors).astype(np.uint8)
    return np.concatenate((plain, coverage), axis=2)


def unit_polydata(baked: Painted) -> PolyData:
    """Return a bake as ``pyvista.PolyData`` in its own diagonals, about the origin.

    Graphics cards compute in single precision: far from the origin a picture would crumble.
    """
    poly = baked.to_pyvista()
    poly.points = baked.shape.recentred(baked.mesh.vertices)
    return poly


def place(camera: Camera, view: View, shape: Shape) -> None:
    """Make a camera see `unit_polydata` as a view sees the shape."""
    unit = shape.diagonal or 1.0
    camera.position = tuple(shape.recentred(view.position))
    camera.focal_point = tuple(shape.recentred(view.focus))
    camera.up = tuple(view.up)
    if view.parallel_scale is None:
        assert view.field_of_view is not None
        camera.parallel_projection = False
        camera.view_angle = view.field_of_view
    else:
        camera.parallel_projection = True
        camera.parallel_scale = view.parallel_scale / unit


def _samples(size: tuple[int, int]) -> int:
    pixels, longest = size[0] * size[1], max(size)
    for finer, most in ((3, _FINE), (2, _COARSE)):
        if pixels * finer**2 <= most and longest * finer <= _SIDE:
            return finer
    return 1


@contextmanager
def only_errors() -> Iterator[None]:
    """Keep VTK's warnings off stderr, such as that there is no X server: it goes on without one."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)
