"""What this program asks of PyVista's plotter and camera, for the type checker."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
    from vtkmodules.vtkRenderingCore import (
        vtkProp,
        vtkRenderer,
        vtkRenderWindow,
        vtkRenderWindowInteractor,
    )

    from meshdepict.shapes.data_set import PolyData

__all__ = ["Camera", "Plotter"]


class Camera(Protocol):
    """A ``pyvista.Camera``."""

    position: tuple[float, ...]
    focal_point: tuple[float, ...]
    up: tuple[float, ...]
    parallel_projection: bool
    parallel_scale: float
    view_angle: float


class Interactor(Protocol):
    """What a plotter has as ``iren``."""

    @property
    def interactor(self) -> vtkRenderWindowInteractor:
        """VTK's own."""

    @property
    def style(self) -> vtkInteractorStyleTrackballCamera:
        """What moves the camera."""

    def initialize(self) -> None:
        """Be ready for widgets."""

    def start(self) -> None:
        """Run the loop until the window is closed."""


class Plotter(Protocol):
    """A ``pyvista.Plotter``."""

    @property
    def camera(self) -> Camera:
        """The eye."""

    @property
    def renderer(self) -> vtkRenderer:
        """The one renderer that there is."""

    @property
    def render_window(self) -> vtkRenderWindow:
        """VTK's window."""

    @property
    def iren(self) -> Interactor:
        """What leads events to handlers."""

    @property
    def window_size(self) -> Sequence[int]:
        """Width and height in pixels."""

    def add_actor(self, actor: vtkProp) -> object:
        """Add an actor as it is."""

    def add_axes(self, **looks: Any) -> object:
        """Add a small cross of axes."""

    def add_mesh(self, mesh: PolyData, **looks: Any) -> object:
        """Add an actor of a mesh."""

    def set_background(self, color: str) -> None:
        """Change the ground's colour."""

    def disable_anti_aliasing(self) -> None:
        """Let samples hit or miss."""

    def enable_trackball_style(self) -> None:
        """Let drags roll the camera round."""

    def reset_camera_clipping_range(self) -> None:
        """Let everything be between the near plane and the far one."""

    def render(self) -> None:
        """Draw a frame."""

    def screenshot(self, *, return_img: bool, transparent_background: bool) -> NDArray[np.uint8]:
        """Return what is shown, (height, width, 4)."""

    def show(self, **how: Any) -> object:
        """Open the window."""

    def close(self) -> None:
        """Close the window."""
