"""Pictures of a bake: the baked colours as they are, no lighting on top, in the bake's view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.canvas import add_painted, canvas, on_ground, place, unit_polydata
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import Framing, frame
from meshdepict.drawing.scale_bar import draw_scale_bar
from meshdepict.errors import MeshdepictError
from meshdepict.files.mark import MARK
from meshdepict.shapes.gbuffer import GBuffer

if TYPE_CHECKING:
    from PIL.Image import Image

    from meshdepict.drawing.painted import Depicted, Painted
    from meshdepict.drawing.plotter import Plotter

__all__ = [
    "check_picture",
    "finished",
    "plot",
    "plot_with",
    "read_picture_provenance",
    "save_image",
    "save_picture",
    "write_picture",
]


def plot(baked: Painted, **plotter: Any) -> Plotter:
    """Return a ``pyvista.Plotter`` that shows the bake; keywords go to the plotter."""
    return plot_with(lambda window: add_painted(window, unit_polydata(baked)), baked, **plotter)


def plot_with(add: Callable[[Plotter], object], baked: Depicted, **plotter: Any) -> Plotter:
    """Return a plotter with what is added to it, in the bake's view."""
    import pyvista as pv

    window: Plotter = pv.Plotter(**plotter)
    window.set_background("white")
    add(window)
    width, height = window.window_size
    framing = frame(baked.view, baked.shape, Figure(size=(width, height)))
    place(window.camera, framing.view, baked.shape)
    window.reset_camera_clipping_range()
    return window


def save_picture(
    baked: Painted, path: str | Path, figure: Figure | None = None, **layout: Any
) -> Path:
    """Render a PNG off screen and put it in place once it is complete.

    The figure may also be given in words, those of `Figure`: ``size="12x9cm", dpi=300``.

    The bake's provenance goes into the file, from where `read_picture_provenance` returns it, and
    so do the dots per inch where the figure has them.

    Raises
    ------
    MeshdepictError
        As `check_picture` and `frame`, and where the file can't be written.
    """
    path, figure = Path(path), (figure or Figure(**layout)).on(baked.ground)
    check_picture(path)
    framing = frame(baked.view, baked.shape, figure)
    with canvas(baked, framing.drawn) as drawing:
        image = finished(drawing.draw(framing.view), framing, figure)
    return write_picture(image, path, baked.provenance, figure.dpi)


def save_image(baked: Painted, path: str | Path, *, background: str | None = None) -> Path:
    """Write the pixels of a baked image as a PNG, just as they are.

    Raises
    ------
    MeshdepictError
        As `check_picture`, for an unknown background, and where the file can't be written.
    """
    from PIL import Image

    check_picture(path)
    ground = Figure(background=background).on(baked.ground).ground
    covered = np.column_stack((baked.colors, np.full(len(baked.colors), 255, np.uint8)))
    assert isinstance(baked.shape, GBuffer)
    pixels = on_ground(baked.shape.image(covered), ground)
    return write_picture(Image.fromarray(pixels), path, baked.provenance)


def write_picture(
    image: Image, path: str | Path, facts: Mapping[str, str], dpi: float | None = None
) -> Path:
    """Write a ``PIL.Image`` as a PNG with facts about it, from where they can be read back.

    Raises
    ------
    OSError
        Where the file can't be written; an earlier one is left as it was.
    """
    from PIL.PngImagePlugin import PngInfo

    from meshdepict.files.atomic import atomic_write

    texts = PngInfo()
    for key, text in facts.items():
        texts.add_text(MARK + key, text)
    with atomic_write(Path(path)) as stream:
        image.save(stream, format="PNG", pnginfo=texts, **({"dpi": (dpi, dpi)} if dpi else {}))
    return Path(path)


def finished(drawn: NDArray[np.uint8], framing: Framing, figure: Figure) -> Image:
    """Return what a canvas drew as a ``PIL.Image`` on its ground, with the scale bar."""
    from PIL import Image

    if framing.strip:
        drawn = np.pad(drawn, ((0, framing.strip), (0, 0), (0, 0)))
    image = Image.fromarray(on_ground(drawn, figure.ground))
    if figure.scale_bar:
        draw_scale_bar(image, framing, figure)
    return image


def check_picture(path: str | Path) -> None:
    """Refuse a name that doesn't end in .png, before any work is done."""
    if Path(path).suffix.lower() != ".png":
        raise MeshdepictError(f"{path}: pictures are written as PNG; end the name with .png")


def read_picture_provenance(path: str | Path) -> list[str] | None:
    """Return the lines that this program wrote into a PNG, None where there are none."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            texts = getattr(image, "text", {})
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return None  # whatever it is, this program didn't write it
    return [f"{key}: {text}" for key, text in texts.items() if key.startswith(MARK)] or None
