"""What windows on meshes and on volumes share: a session, a camera, a drag, and a loop."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from meshdepict.drawing.canvas import place
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.scene.view import View
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.camera import camera_view, same_sight
from meshdepict.viewer.windows.window_events import run_loop

__all__ = ["LitWindow"]

_REST = 0.15  # seconds without a move, after which the whole picture is due


class LitWindow:
    """A window over a session; kinds of shapes have windows of their own, which `draw`.

    Parameters
    ----------
    session : Session
    name : str
        What saved files are called.
    folder : path
        Where they go.

    Attributes
    ----------
    plotter : pyvista.Plotter
    camera : pyvista.Camera
    said : str
        The last message.
    fault : BaseException or None
        What ended the window, to be raised when it is gone.
    """

    plotter: Any
    camera: Any

    def __init__(self, session: Session, name: str, folder: str | Path) -> None:
        session.baked()  # what can't be shaded is refused before a window opens
        self.session: Any = session
        self.name, self.folder = name, folder
        self.said = ""
        self.fault: BaseException | None = None
        self._held: Any = None  # what a drag moves
        self._due: float | None = None
        self._shown: Any = session.look_now()
        self._seen: View = session.view

    @property
    def picture_size(self) -> tuple[int, int]:
        """Width and height in pixels of the part that shows the object."""
        width, height = self.plotter.render_window.GetSize()
        return width, height

    def draw(self) -> None:
        """Draw the whole picture."""
        raise NotImplementedError

    def finish(self) -> None:
        """Take away what the plotter doesn't."""

    def settle(self) -> None:
        """Take over where the camera is, and draw the whole picture."""
        self._due = None
        self.look()
        self.draw()

    def tick(self) -> None:
        """Draw the whole picture when it is due; a timer's."""
        if self._due is not None and self._held is None and time.perf_counter() >= self._due:
            self.settle()

    def say(self, words: str) -> None:
        """Show a message, until the next one."""
        self.said = words
        self.draw()

    def soon(self) -> None:
        """Have the whole picture drawn once the hand rests."""
        self._due = time.perf_counter() + _REST

    def look(self) -> None:
        """Tell the session what the camera sees, if that is another view."""
        now = camera_view(self.camera, self.session.shape, height_px=self.session.view.height_px)
        if not same_sight(now, self._seen, self.session.shape):
            self._seen = now
            self.look_from(now)

    def look_from(self, view: View | str) -> None:
        """Tell the session another view."""
        self.session.look(view)

    def go(self, view: View) -> None:
        """Put the camera where a view is; a named one is fitted to the window."""
        self._seen = frame(view, self.session.shape, Figure(size=self.picture_size)).view
        place(self.camera, self._seen, self.session.shape)
        self.plotter.renderer.ResetCameraClippingRange()

    def let_go(self) -> bool:
        """End a drag; return whether there was one."""
        held, self._held = self._held, None
        return held is not None

    def run(self, *, frames: int | None = None) -> None:
        """Stay open until it is closed; off screen, for a number of frames.

        Raises
        ------
        MeshdepictError
            Where there is no display.
        """
        run_loop(self, frames)

    def close(self) -> None:
        """Close the window."""
        self._due = None
        self.plotter.iren.interactor.TerminateApp()
