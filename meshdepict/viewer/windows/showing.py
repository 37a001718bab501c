"""`Baked.show`: a window with the object under a light that moves, or a plain picture."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from meshdepict.drawing.display import check_display
from meshdepict.drawing.picture import plot
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.windows.reopened import session_of
from meshdepict.viewer.windows.window import Window

if TYPE_CHECKING:
    from meshdepict.baking.baked import Baked

__all__ = ["show"]


def show(baked: Baked, **plotter: Any) -> Any:
    """Open a window on a bake; in notebooks, and with keywords for the plotter, a plain picture.

    Parameters
    ----------
    baked : Baked
    **plotter
        ``window_size``, or anything for ``pyvista.Plotter`` and ``jupyter_backend``.

    Raises
    ------
    MeshdepictError
        Where there is no display.
    """
    size = plotter.pop("window_size", None)
    if plotter or _in_notebook():
        backend = {key: plotter.pop(key) for key in ("jupyter_backend",) if key in plotter}
        if size is not None:
            plotter["window_size"] = size
        return plot(baked, **plotter).show(**backend)
    check_display()
    try:
        session = session_of(baked)
    except MeshdepictError:  # nothing to change: colours as they are
        return plot(baked, window_size=size).show()
    chosen: dict[str, Any] = {} if size is None else {"size": tuple(size)}
    return Window(session, **chosen).run()


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    return shell is not None and getattr(shell.get_ipython(), "kernel", None) is not None
