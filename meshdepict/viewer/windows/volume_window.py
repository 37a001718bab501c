"""The window on a volume: the light moves with a drag, everything else is on keys (`volume_keys`).

While anything moves, rays go through a few pixels only, so that the hand is followed; when it
rests, through all of them.
"""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any

from meshdepict.drawing.canvas import only_errors
from meshdepict.drawing.display import check_display, check_opengl, has_graphics_card
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.windows.camera import camera_view
from meshdepict.viewer.windows.clipping_box import ClippingBox
from meshdepict.viewer.windows.keys import help_text
from meshdepict.viewer.windows.labels import label
from meshdepict.viewer.windows.light_gizmo import LightGizmo
from meshdepict.viewer.windows.lit_object import NO_CARD
from meshdepict.viewer.windows.lit_volume import LitVolume
from meshdepict.viewer.windows.lit_window import LitWindow
from meshdepict.viewer.windows.status import light_line
from meshdepict.viewer.windows.volume_actions import VolumeActions
from meshdepict.viewer.windows.volume_keys import KEYS
from meshdepict.viewer.windows.volume_session import VolumeSession
from meshdepict.viewer.windows.window_events import bind

__all__ = ["VolumeWindow", "show_volume"]

_BUDGET = 0.08  # seconds that a frame may take while something moves
_COARSEST = 6.0  # pixels between rays: more and nothing can be made out


def show_volume(
    volume: Any,
    method: str = "exaggerated",
    *,
    name: str = "volume",
    size: tuple[int, int] = (900, 800),
    frames: int | None = None,
    **settings: Any,
) -> VolumeWindow:
    """Open a window on a volume, and return it once it is closed.

    Parameters
    ----------
    volume : path, Volume, pyvista.ImageData or BakedVolume
    method : str
    name : str
        What saved files are called.
    size : (int, int)
        Of the window in pixels.
    frames : int, optional
        Draw so many off screen, and end.
    **settings
        As for `VolumeSession`: transfer, light, view, up, scales, …, and the method's options.

    Raises
    ------
    MeshdepictError
        As `bake_volume`, and where there is no display.
    """
    if frames is None:
        check_display()
    session = VolumeSession(volume, method, **settings)
    window = VolumeWindow(session, name=name, size=size, off_screen=frames is not None)
    window.run(frames=frames)
    return window


class VolumeWindow(LitWindow):
    """A PyVista window over a session of a volume.

    Parameters
    ----------
    session : VolumeSession
    name : str
        What saved files are called.
    folder : path
        Where they go.
    size : (int, int)
        In pixels.
    live : bool, optional
        Whether the graphics card may shade; unless given, where there is a real one.
    off_screen : bool

    Attributes
    ----------
    plotter : pyvista.Plotter
    lit : LitVolume
    box : ClippingBox
    helping : bool
    actions : VolumeActions
        What keys do.
    """

    def __init__(
        self,
        session: VolumeSession,
        *,
        name: str = "volume",
        folder: str | Path = ".",
        size: tuple[int, int] = (900, 800),
        live: bool | None = None,
        off_screen: bool = False,
    ) -> None:
        import pyvista as pv

        super().__init__(session, name, folder)
        self.helping = False
        self.actions = VolumeActions(self)
        self._took = _BUDGET  # seconds of the last whole frame
        with only_errors():
            self.plotter = pv.Plotter(
                window_size=list(size), off_screen=off_screen, notebook=False, title="meshdepict"
            )
            check_opengl(self.plotter)
            self.plotter.set_background("white")
            self.plotter.disable_anti_aliasing()  # of edges of triangles, which are but the arrow's
            self.plotter.render_window.SetMultiSamples(0)
            self.plotter.iren.initialize()
            self._gizmo = self._add_gizmo()
            self._message = label(self.plotter.renderer, "", (0.015, 0.965), size=14)
            self._lines = label(self.plotter.renderer, "", (0.015, 0.015), size=11)
            self._help = self._add_help()
            if live is None:
                live = has_graphics_card(self.plotter.render_window)
        self.camera = self.plotter.camera
        self.lit = LitVolume(self.plotter, session, live=live)
        self.box = ClippingBox(session.shape)
        self.go(session.view)
        bind(self)
        self.settle()

    # --- drawing ----------------------------------------------------------------------------

    def draw(self, *, moving: bool = False) -> None:
        """Draw a frame; what can't be shaded is said, and the session goes back."""
        session = self.session
        try:
            self.lit.show()
        except MeshdepictError as error:
            self.said = str(error)
            session.go_back(self._shown)
            self.lit.show()
        self._shown = session.look_now()
        pixels = math.sqrt(self._took / _BUDGET) if moving else 1.0
        self.lit.coarsen(min(max(pixels, 1.0), _COARSEST))
        self._gizmo.update(session.light, self._seen)
        self._message.SetInput(self.said)
        self._lines.SetInput(self._status())
        for column in self._help:
            column.SetVisibility(self.helping)
        began = time.perf_counter()
        self.plotter.render_window.Render()
        if not moving:
            self._took = time.perf_counter() - began

    @property
    def towards_eye(self) -> Any:
        """Unit vector from the volume to the eye."""
        return self._seen.towards_eye

    # --- the pointer, as `bind` leads it here -----------------------------------------------

    def grip(self, at: tuple[int, int]) -> None:
        """Say that a plain drag takes hold of nothing but the camera."""

    def take(self, what: str, at: tuple[int, int]) -> None:
        """Begin to drag the light, from a place in pixels."""
        self._held = at

    def drag(self, at: tuple[int, int]) -> bool:
        """Move the light if it is held; return whether it is."""
        if self._held is None:
            return False
        height = self.picture_size[1]
        before, self._held = self._held, at
        self.turn_light((at[0] - before[0]) / height, (at[1] - before[1]) / height)
        return True

    def turn_light(self, right: float, up: float) -> None:
        """Turn the light by a drag in heights of the picture."""
        self.session.drag_light((right, up))
        self.draw(moving=True)
        self.soon()

    def camera_moved(self) -> None:
        """Follow the camera on its way."""
        if self.session.light_fixed_to == "eye":
            self.look()
        else:
            self._seen = camera_view(self.camera, self.session.shape)
        self.draw(moving=True)
        self.soon()

    # --- what stands round the volume ---------------------------------------------------------

    def _add_gizmo(self) -> LightGizmo:
        window = self.plotter.render_window
        gizmo = LightGizmo((0.84, 0.01, 0.99, 0.17))
        window.SetNumberOfLayers(max(2, window.GetNumberOfLayers()))
        gizmo.renderer.SetLayer(window.GetNumberOfLayers() - 1)
        window.AddRenderer(gizmo.renderer)
        return gizmo

    def _add_help(self) -> list[Any]:
        columns = [
            label(self.plotter.renderer, text, (x, 0.5), size=14)
            for text, x in zip(help_text(KEYS), (0.06, 0.34), strict=True)
        ]
        for column in columns:
            letters = column.GetTextProperty()
            letters.SetVerticalJustificationToCentered()
            letters.SetLineSpacing(1.15)
            letters.SetBackgroundColor(1, 1, 1)
            letters.SetBackgroundOpacity(0.9)
        return columns

    def _status(self) -> str:
        session = self.session
        where = "VTK's own shading" if self.lit.plain else session.method.replace("_", " ")
        by = "processor" if self.lit.why_baked else "graphics card"
        reason = f": {self.lit.why_baked:.100}" if self.lit.why_baked not in ("", NO_CARD) else ""
        first = where if self.lit.plain else f"{where}, by the {by}{reason}"
        return f"{first}\n{session.transfer.name}\n{light_line(session)}"
