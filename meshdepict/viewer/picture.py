"""Pictures of a bake: the baked colours as they are, no lighting on top, in the bake's view."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.scene import VIEWS, View

if TYPE_CHECKING:
    from meshdepict.baking import Baked
    from meshdepict.mesh import Mesh

__all__ = ["check_picture", "plot", "read_picture_provenance", "save_picture"]

_MARK = "meshdepict "  # how the keywords of this program's texts in a PNG begin
_MOST = 16384  # pixels across: what graphics cards can draw into


def plot(baked: Baked, **plotter: Any) -> Any:
    """Return a ``pyvista.Plotter`` that shows the bake; keywords go to the plotter."""
    import pyvista as pv

    shape = baked.shape
    poly = baked.to_pyvista()
    # Graphics cards compute in single precision: far from the origin a picture would crumble.
    poly.points = (poly.points - shape._centre) / (shape.diagonal or 1.0)
    window = pv.Plotter(**plotter)
    window.set_background("white")
    window.add_mesh(poly, scalars="RGB", rgb=True, lighting=False, show_scalar_bar=False)
    width, height = window.window_size
    _place(window.camera, _fitted(baked.view, shape, width / height), shape)
    window.reset_camera_clipping_range()
    return window


def save_picture(baked: Baked, path: str | Path, *, size: tuple[int, int]) -> Path:
    """Render a PNG off screen and put it in place once it is complete.

    A view given by name is fitted to the picture's proportions. The bake's provenance goes into
    the file, from where `read_picture_provenance` returns it.

    Raises
    ------
    MeshdepictError
        As `check_picture`, and where the file can't be written.
    """
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    from meshdepict.io.atomic import atomic_write

    path = Path(path)
    check_picture(path, size)
    with _only_errors():
        window = plot(baked, off_screen=True, window_size=list(size))
        try:
            image = window.screenshot(return_img=True)
        finally:
            window.close()
    texts = PngInfo()
    for key, text in baked.provenance.items():
        texts.add_text(_MARK + key, text)
    with atomic_write(path) as stream:
        Image.fromarray(image).save(stream, format="PNG", pnginfo=texts)
    return path


def check_picture(path: str | Path, size: tuple[int, int]) -> None:
    """Refuse what can't become a picture, before any work is done.

    Raises
    ------
    MeshdepictError
        For a name that doesn't end in .png and a size beyond 1 … 16384 pixels.
    """
    if Path(path).suffix.lower() != ".png":
        raise MeshdepictError(f"{path}: pictures are written as PNG; end the name with .png")
    if not all(1 <= length <= _MOST for length in size):
        raise MeshdepictError(f"a picture of {size[0]}x{size[1]} pixels: 1 to {_MOST} are possible")


def read_picture_provenance(path: str | Path) -> list[str] | None:
    """Return the lines that this program wrote into a PNG, None where there are none."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            texts = getattr(image, "text", {})
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return None  # whatever it is, this program didn't write it
    return [f"{key}: {text}" for key, text in texts.items() if key.startswith(_MARK)] or None


@contextmanager
def _only_errors() -> Iterator[None]:
    """Keep VTK's warnings off stderr, such as that there is no X server: it goes on without one."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)


def _fitted(view: View, shape: Mesh, aspect: float) -> View:
    """Return a view that was fitted to a square fitted to a picture of other proportions."""
    if view.name in VIEWS:
        for up in ("y", "z"):
            square = View.fitted(view.name, shape, up=up)
            same_eye = np.array_equal(view.position, square.position)
            if same_eye and view.parallel_scale == square.parallel_scale:
                return View.fitted(view.name, shape, up=up, aspect=aspect)
    return view


def _place(camera: Any, view: View, shape: Mesh) -> None:
    unit = shape.diagonal or 1.0
    camera.position = tuple((view.position - shape._centre) / unit)
    camera.focal_point = tuple((view.focus - shape._centre) / unit)
    camera.up = tuple(view.up)
    if view.parallel_scale is None:
        camera.parallel_projection = False
        camera.view_angle = view.field_of_view
    else:
        camera.parallel_projection = True
        camera.parallel_scale = view.parallel_scale / unit
