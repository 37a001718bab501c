"""Pictures of volumes: shaded voxels, or VTK's own shading beside them, without a display."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.canvas import off_screen, pixels_of
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import Framing, frame
from meshdepict.drawing.page import Page, paint
from meshdepict.drawing.picture import laid_out, plot_with
from meshdepict.drawing.picture_files import check_picture, write_page
from meshdepict.drawing.shader import caught_errors
from meshdepict.drawing.volume_scene import add_baked, add_plain, add_rgba
from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from PIL.Image import Image
    from vtkmodules.vtkCommonDataModel import vtkPlane
    from vtkmodules.vtkRenderingCore import vtkVolume

    from meshdepict.drawing.painted import PaintedVolume
    from meshdepict.drawing.plotter import Plotter

__all__ = [
    "draw_volume",
    "draw_volume_page",
    "draw_voxels",
    "plot_volume",
    "save_volume_picture",
]

_TRIAL = (16, 16)  # pixels, to see whether the card takes this program's shader


def plot_volume(baked: PaintedVolume, **plotter: Any) -> Plotter:
    """Return a ``pyvista.Plotter`` that shows the bake; keywords go to the plotter."""
    add = add_baked
    try:
        with caught_errors("the volume"):
            tried = frame(baked.view, baked.shape, Figure(size=_TRIAL))
            _drawn(partial(add_baked, baked=baked), baked, tried, ())
    except MeshdepictError:  # no such shaders here: colours of voxels, interpolated
        add = add_rgba
    return plot_with(partial(add, baked=baked), baked, **plotter)


def draw_volume(
    baked: PaintedVolume,
    figure: Figure | None = None,
    *,
    plain: bool = False,
    planes: Sequence[vtkPlane] = (),
) -> Image:
    """Return a ``PIL.Image`` of a bake in its view; see `draw_volume_page`."""
    return paint(draw_volume_page(baked, figure or Figure(), plain=plain, planes=planes))


def draw_volume_page(
    baked: PaintedVolume,
    figure: Figure,
    *,
    plain: bool = False,
    planes: Sequence[vtkPlane] = (),
) -> Page:
    """Return a page with a picture of a bake in its view.

    Parameters
    ----------
    baked : PaintedVolume
    figure : Figure
    plain : bool
        Draw the CT numbers with VTK's own shading instead, through the same transfer function.
    planes : sequence of vtkPlane
        Show what is on their positive sides, in the volume's diagonals about its centre.

    Raises
    ------
    MeshdepictError
        As `frame`, and for a plain picture of a bake without a transfer function.
    """
    figure = figure.on(baked.ground).captioned(_facts(baked, plain=plain), baked.shape.length_unit)
    framing = frame(baked.view, baked.shape, figure)
    if plain:
        transfer = baked.transfer
        if transfer is None:
            raise MeshdepictError(
                "a plain picture of a volume needs a transfer function, and this bake has none: "
                "bake the volume with transfer='bone' or another"
            )

        def before(window: Plotter) -> vtkVolume:
            return add_plain(window, baked.shape, transfer)

        drawn = _drawn(before, baked, framing, planes)
    else:
        drawn = draw_voxels(baked, framing, planes)
    return laid_out(drawn, framing, figure)


def draw_voxels(
    baked: PaintedVolume, framing: Framing, planes: Sequence[vtkPlane] = ()
) -> NDArray[np.uint8]:
    """Draw shaded voxels where a framing has them: colour times coverage, and coverage."""
    try:
        with caught_errors("the volume"):
            return _drawn(partial(add_baked, baked=baked), baked, framing, planes)
    except MeshdepictError:  # no such shaders here: colours of voxels, interpolated
        return _drawn(partial(add_rgba, baked=baked), baked, framing, planes)


def save_volume_picture(
    baked: PaintedVolume,
    path: str | Path,
    figure: Figure | None = None,
    *,
    plain: bool = False,
    planes: Sequence[vtkPlane] = (),
    **layout: Any,
) -> Path:
    """Render `draw_volume`, and put it in place once it is complete; the suffix says the format.

    The figure may also be given in words, and the bake's provenance goes into the file, as by
    `save_picture`.

    Raises
    ------
    MeshdepictError
        As `draw_volume`, for another suffix, and where the file can't be written.
    """
    path, figure = Path(path), figure or Figure(**layout)
    check_picture(path, figure)
    page = draw_volume_page(baked, figure, plain=plain, planes=planes)
    return write_page(page, path, _facts(baked, plain=plain))


def _facts(baked: PaintedVolume, *, plain: bool) -> dict[str, str]:
    """Return what a picture says of how it came about."""
    return baked.provenance | ({"method": "plain volume rendering"} if plain else {})


def _drawn(
    add: Callable[[Plotter], vtkVolume],
    baked: PaintedVolume,
    framing: Framing,
    planes: Sequence[vtkPlane],
) -> NDArray[np.uint8]:
    """Draw what is added to a window, in a view: colour times coverage, and coverage."""
    with off_screen(framing.drawn) as window:
        mapper = add(window).GetMapper()
        for plane in planes:
            mapper.AddClippingPlane(plane)
        return pixels_of(window, framing.view, baked.shape)
