"""Pictures of a bake: the baked colours as they are, no lighting on top, in the bake's view."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.canvas import add_drawn, canvas, on_ground, place
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import Framing, caption_lines, frame
from meshdepict.drawing.letters import LEADING
from meshdepict.drawing.map_picture import cell_pixels, draw_cells, draw_map, is_map
from meshdepict.drawing.page import Page, Part, Picture, Words, paint
from meshdepict.drawing.picture_files import check_picture, write_page
from meshdepict.drawing.scale_bar import BAR_SHARE, bar_parts
from meshdepict.drawing.textured import is_textured
from meshdepict.shapes.gbuffer import GBuffer

if TYPE_CHECKING:
    from PIL.Image import Image

    from meshdepict.drawing.painted import Depicted, Painted, TexturedMesh
    from meshdepict.drawing.plotter import Plotter
    from meshdepict.scene.view import View

__all__ = [
    "caption_words",
    "draw_page",
    "drawn",
    "finished",
    "image_page",
    "laid_out",
    "plot",
    "plot_with",
    "save_picture",
]


def plot(baked: Painted | TexturedMesh, **plotter: Any) -> Plotter:
    """Return a ``pyvista.Plotter`` that shows the bake; keywords go to the plotter."""
    return plot_with(partial(add_drawn, baked=baked), baked, **plotter)


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
    """Render a picture off screen and put it in place once it is complete.

    The suffix decides the format: PNG, JPEG, SVG or PDF. In the last two scale bar and caption are
    vectors and text, and the object is an image of as many pixels as the figure says.

    The figure may also be given in words, those of `Figure`: ``size="12x9cm", dpi=300``.

    The bake's provenance goes into the file, from where `read_picture_provenance` returns it, and
    so do the dots per inch where the figure has them.

    Raises
    ------
    MeshdepictError
        As `check_picture` and `frame`, and where the file can't be written.
    """
    path, figure = Path(path), figure or Figure(**layout)
    check_picture(path, figure)
    return write_page(draw_page(baked, figure), path, baked.provenance)


def draw_page(baked: Painted | TexturedMesh, figure: Figure) -> Page:
    """Return the page that `save_picture` writes."""
    unit = getattr(baked.shape, "length_unit", "")
    figure = figure.on(baked.ground).captioned(baked.provenance, unit)
    side = cell_pixels(baked.shape, baked.view, figure)
    if side:
        return _pixel_page(draw_cells(cast("Painted", baked), side), figure)
    framing = frame(baked.view, baked.shape, figure)
    return laid_out(drawn(baked, framing.view, framing.drawn), framing, figure)


def drawn(baked: Painted | TexturedMesh, view: View, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Draw a bake once, in a view and a size: colour times coverage, and coverage."""
    if is_textured(baked):
        with canvas(baked, size) as drawing:
            return drawing.draw(view)
    baked = cast("Painted", baked)
    if is_map(baked.shape, view):
        return draw_map(baked, view, size)
    coverage = getattr(baked.shape, "coverage", None)
    with canvas(baked, size) as drawing:
        if coverage is None:
            return drawing.draw(view)
        # What fades out, as a ground does: once in colours times coverage, once as coverage alone.
        share = coverage[:, None]
        covered = np.rint(np.repeat(255 * share, 3, axis=1)).astype(np.uint8)
        image = drawing.draw(view, np.rint(baked.colors * share).astype(np.uint8))
        alone = drawing.draw(view, covered)
    return np.concatenate([image[..., :3], alone[..., :1]], axis=2)


def image_page(baked: Painted, figure: Figure) -> Page:
    """Return a page with the pixels of a baked image, just as they are, and the caption below."""
    covered = np.column_stack((baked.colors, np.full(len(baked.colors), 255, np.uint8)))
    assert isinstance(baked.shape, GBuffer)
    figure = figure.on(baked.ground).captioned(baked.provenance)
    return _pixel_page(baked.shape.image(covered), figure)


def _pixel_page(pixels: NDArray[np.uint8], figure: Figure) -> Page:
    """Return a page with pixels just as they are, (h, w, 4), and the figure's caption below."""
    from PIL import Image

    image = Image.fromarray(on_ground(pixels, figure.ground))
    width, height = image.size
    letters = figure.letters(image.size)
    lines = caption_lines(figure, width, letters)
    words = caption_words(lines, round(letters * 1.2), height, letters, figure)
    size = width, height + math.ceil((len(lines) + 0.5) * LEADING * letters) * bool(lines)
    return Page(size, figure.ground, (Picture(image, 0, 0), *words), figure.dpi)


def finished(drawn: NDArray[np.uint8], framing: Framing, figure: Figure) -> Image:
    """Return what a canvas drew as a ``PIL.Image`` on its ground, with scale bar and caption."""
    return paint(laid_out(drawn, framing, figure))


def laid_out(drawn: NDArray[np.uint8], framing: Framing, figure: Figure) -> Page:
    """Return what a canvas drew on a page, with scale bar and caption."""
    from PIL import Image

    width, height = framing.size
    letters = figure.letters(framing.size)
    parts: list[Part] = [Picture(Image.fromarray(on_ground(drawn, figure.ground)), 0, 0)]
    left = round(letters * 1.2)
    above = height - framing.caption
    if figure.scale_bar:
        assert framing.pixels_per_unit is not None  # `frame` sees to that
        strip = framing.strip - framing.caption or min(3 * letters, above // 3)
        parts += bar_parts(
            BAR_SHARE * width / framing.pixels_per_unit, framing.unit, framing.pixels_per_unit,
            left=left, middle=above - strip // 2, letters=letters, figure=figure,
        )  # fmt: skip
    lines = caption_lines(figure, width, letters)
    parts += caption_words(lines, left, above, letters, figure)
    return Page(framing.size, figure.ground, tuple(parts), figure.dpi)


def caption_words(
    lines: list[str], x: float, top: float, letters: int, figure: Figure, *, anchor: str = "l"
) -> list[Words]:
    """Return lines of text below one another, from their top."""
    ink, around = figure.inks
    rim = max(1, round(letters / 7)) if figure.ground is None else 0
    return [
        Words(line, x, top + (i + 0.5) * LEADING * letters, letters, ink, anchor, rim, around)
        for i, line in enumerate(lines)
    ]
