"""`plot` of bakes: what users of PyVista expect of ``mesh.plot``, in colours as they are."""

from __future__ import annotations

import inspect
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from meshdepict.drawing.canvas import add_drawn, only_errors
from meshdepict.drawing.display import check_display
from meshdepict.drawing.picture import plot_with
from meshdepict.drawing.volume_picture import plot_volume
from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest

if TYPE_CHECKING:
    from meshdepict.drawing.painted import Depicted, Painted, PaintedVolume, TexturedMesh
    from meshdepict.scene.shape import Shape

__all__ = ["plot_and_show"]

# Words of ``pyvista.plot``, by where they go; all others are for ``add_mesh``.
_WINDOW = (
    "off_screen", "notebook", "window_size", "theme", "border", "border_color", "border_width",
    "line_smoothing", "multi_samples", "image_scale",
)  # fmt: skip
_SHOW = (
    "auto_close", "before_close_callback", "full_screen", "interactive", "interactive_update",
    "jupyter_backend", "jupyter_kwargs", "return_cpos", "return_img", "return_viewer", "screenshot",
    "title",
)  # fmt: skip
_SCENE = (
    "anti_aliasing", "background", "cpos", "parallel_projection", "show_axes", "show_bounds",
    "show_grid", "text", "zoom",
)  # fmt: skip


def plot_and_show(baked: Depicted, **words: Any) -> Any:
    """Show a bake in a plot of PyVista's, and return what its ``show`` returns.

    Parameters
    ----------
    baked : Painted or PaintedVolume
    **words
        Those of ``pyvista.plot``: ``off_screen``, ``window_size``, ``screenshot``, ``return_img``,
        ``return_cpos``, ``jupyter_backend``, ``cpos``, ``background``, …; of a mesh also those of
        ``add_mesh``, such as ``show_edges`` or ``opacity``. Unless given, the view is the bake's.
        Positions of the camera are in the world, as for every dataset.

    Raises
    ------
    MeshdepictError
        For a word that none of them knows, and where there is no display.
    """
    window_words = {word: words.pop(word) for word in _WINDOW if words.get(word) is not None}
    show_words = {word: words.pop(word) for word in _SHOW if word in words}
    scene = {word: words.pop(word) for word in _SCENE if word in words}
    for word in _WINDOW:
        words.pop(word, None)  # as usual
    _check_words(words, volume=baked.shape.kind == "volume")
    with only_errors():
        if baked.shape.kind == "volume":
            window: Any = plot_volume(cast("PaintedVolume", baked), **window_words)
        else:
            add = partial(add_drawn, baked=cast("Painted | TexturedMesh", baked), **words)
            window = plot_with(add, baked, **window_words)
        if not (window.off_screen or window.notebook):
            check_display()
        _set_scene(window, baked.shape, **scene)
        result = window.show(**show_words)
    return _in_world(result, baked.shape) if show_words.get("return_cpos") else result


def _check_words(words: dict[str, Any], *, volume: bool) -> None:
    """Refuse what PyVista would, in a sentence."""
    import pyvista as pv

    known = {*_WINDOW, *_SHOW, *_SCENE}
    if not volume:
        known |= {*inspect.signature(pv.Plotter.add_mesh).parameters} - {"self", "mesh", "kwargs"}
    for word in words:
        if word not in known:
            about = "a volume" if volume else "a mesh"
            raise MeshdepictError(
                f"plot of {about} has no keyword {word!r}: it takes those of pyvista.plot"
                f"{nearest(word, sorted(known))}"
            )


def _set_scene(
    window: Any,
    shape: Shape,
    *,
    background: Any = None,
    cpos: Any = None,
    parallel_projection: bool | None = None,
    anti_aliasing: Any = None,
    show_axes: bool = False,
    show_bounds: bool = False,
    show_grid: bool = False,
    text: str = "",
    zoom: Any = None,
) -> None:
    """Change what is seen besides the object, as ``pyvista.plot`` does."""
    if background is not None:
        window.set_background(background)
    if cpos is not None:
        window.camera_position = _in_diagonals(cpos, shape)
        if not _is_place(cpos):  # a direction: as near as the object needs
            window.reset_camera()
    if parallel_projection is not None:
        window.camera.parallel_projection = parallel_projection
    if anti_aliasing:
        window.enable_anti_aliasing(**({} if anti_aliasing is True else {"aa_type": anti_aliasing}))
    if show_axes:
        window.add_axes()
    if show_grid or show_bounds:
        window.show_bounds(grid="front" if show_grid else None)
    if text:
        window.add_text(text)
    if zoom is not None:
        window.camera.zoom(zoom)


def _in_diagonals(cpos: Any, shape: Shape) -> Any:
    """Return a camera's position for what is drawn in diagonals about the origin."""
    if not _is_place(cpos):
        return cpos
    position, focus, up = (np.array([*vector], np.float64) for vector in cpos)
    return [tuple(shape.recentred(position)), tuple(shape.recentred(focus)), tuple(up)]


def _in_world(result: Any, shape: Shape) -> Any:
    """Return what ``show`` returned, with the camera's position in the world."""
    if _is_place(result):
        return _place_in_world(result, shape)
    if isinstance(result, tuple) and _is_place(result[0]):
        return (_place_in_world(result[0], shape), *result[1:])
    return result  # a notebook's viewer, and no place


def _is_place(value: Any) -> bool:
    """Whether this is where a camera is: position, focus and up, of whichever type."""
    try:
        return np.shape([tuple(vector) for vector in value]) == (3, 3)
    except (TypeError, ValueError):
        return False


def _place_in_world(cpos: Any, shape: Shape) -> list[tuple[float, ...]]:
    position, focus, up = (np.array([*vector], np.float64) for vector in cpos)
    there = (point * (shape.diagonal or 1.0) + shape.centre for point in (position, focus))
    return [tuple(vector.tolist()) for vector in (*there, up)]
