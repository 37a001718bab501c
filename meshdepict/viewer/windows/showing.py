"""`show` of bakes: a window with the object under a light that moves, or a plain picture."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from meshdepict.baking.baked import Baked, Depiction
from meshdepict.baking.baked_texture import BakedTexture
from meshdepict.baking.volumes import BakedVolume
from meshdepict.drawing.display import check_display
from meshdepict.drawing.picture import plot
from meshdepict.drawing.volume_picture import plot_volume
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.windows.lit_window import LitWindow
from meshdepict.viewer.windows.reopened import session_of
from meshdepict.viewer.windows.volume_session import VolumeSession
from meshdepict.viewer.windows.volume_window import VolumeWindow
from meshdepict.viewer.windows.window import Window

if TYPE_CHECKING:
    from meshdepict.drawing.plotter import Plotter
    from meshdepict.viewer.session import Session

__all__ = ["show", "window_on"]


def show(baked: Depiction, **plotter: Any) -> Any:
    """Open a window on a bake; in notebooks, and with keywords for the plotter, a plain picture.

    Parameters
    ----------
    baked : Baked, BakedTexture or BakedVolume
    **plotter
        ``window_size``, or anything for ``pyvista.Plotter`` and ``jupyter_backend``.

    Raises
    ------
    MeshdepictError
        Where there is no display.
    """
    size = plotter.pop("window_size", None)
    if plotter or _in_notebook():
        return baked.plot(window_size=size, **plotter)
    check_display()
    try:
        session = session_of(baked.vertices if isinstance(baked, BakedTexture) else baked)
    except MeshdepictError:  # nothing to change: colours as they are
        return _plot(baked, window_size=size).show()
    chosen: dict[str, Any] = {} if size is None else {"size": tuple(size)}
    window = window_on(session, **chosen)
    if isinstance(baked, BakedTexture) and isinstance(window, Window):
        window.wear(baked)
    return window.run()


def window_on(session: Session, **given: Any) -> LitWindow:
    """Return a window on what a session shows; keywords as of `LitWindow`."""
    kind: type[LitWindow] = VolumeWindow if isinstance(session, VolumeSession) else Window
    return kind(session, **given)


def _plot(baked: Depiction, **plotter: Any) -> Plotter:
    """Return a plotter that shows a bake of either kind."""
    if isinstance(baked, BakedVolume):
        return plot_volume(baked, **plotter)
    assert isinstance(baked, (Baked, BakedTexture))
    return plot(baked, **plotter)


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    return shell is not None and getattr(shell.get_ipython(), "kernel", None) is not None
