"""Whether there is a display for a window, and OpenGL to draw with at all."""

from __future__ import annotations

import ctypes
import os
import sys
from typing import TYPE_CHECKING

from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    from meshdepict.drawing.plotter import Plotter

__all__ = ["check_display", "check_opengl", "has_graphics_card"]

_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")
_OSMESA = ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so")


def check_display(plotter: Plotter | None = None) -> None:
    """Refuse to open a window where none can be seen.

    Parameters
    ----------
    plotter : pyvista.Plotter, optional
        One that has drawn: its window has to have come up.

    Raises
    ------
    MeshdepictError
        On Linux without a display.
    """
    if not sys.platform.startswith("linux"):
        return
    display = os.environ.get("DISPLAY")
    if not display or (plotter is not None and not plotter.render_window.GetMapped()):
        why = f"{display} can't be reached" if display else "DISPLAY is not set"
        raise MeshdepictError(
            f"there is no display for a window ({why}): give --browser, or bake with --picture, or "
            "run it under xvfb-run (Debian: apt install xvfb libgl1-mesa-dri)"
        )


def check_opengl(plotter: Plotter) -> None:
    """Refuse to draw where VTK found no OpenGL; it would end the program.

    Parameters
    ----------
    plotter : pyvista.Plotter
        One that hasn't drawn yet.

    Raises
    ------
    MeshdepictError
        Where there is neither a display nor EGL nor OSMesa.
    """
    if plotter.render_window.GetClassName() != "vtkOSOpenGLRenderWindow":
        return  # the last one that VTK tries
    for name in _OSMESA:
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        return
    plotter.close()
    raise MeshdepictError(
        "there is no OpenGL to draw with, neither on a display nor without one (EGL): install it "
        "(Debian: apt install libegl1 libgl1-mesa-dri)"
    )


def has_graphics_card(window: vtkRenderWindow) -> bool:
    """Whether the OpenGL of a render window, which draws for it, is more than software."""
    window.Render()
    return not any(name in window.ReportCapabilities().lower() for name in _SOFTWARE)
