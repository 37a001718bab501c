"""The window: an object under a light that moves with a drag, and everything else on keys.

What it shows is the `Session`'s; keys are in `keys`, options in `option_panel`. Handlers never
compute for longer than a frame's budget while something moves: big meshes have a coarse stand-in
then, and the whole picture comes when the hand rests.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from meshdepict.drawing.canvas import only_errors
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.actions import Actions
from meshdepict.viewer.windows.lit_object import LitObject
from meshdepict.viewer.windows.lit_window import LitWindow
from meshdepict.viewer.windows.preview import Pace
from meshdepict.viewer.windows.scenery import Scenery
from meshdepict.viewer.windows.window_events import bind

__all__ = ["Window"]

_PATIENCE = 1.0  # seconds that a frame may take which only says what comes
_GRIP = 8  # pixels round the wipe's line where it can be taken


class Window(LitWindow):
    """A PyVista window over a session.

    Parameters
    ----------
    session : Session
    name : str
        What saved files are called.
    folder : path
        Where they go.
    size : (int, int)
        Of the window in pixels.
    live : bool, optional
        Whether the graphics card may shade; unless given, where there is a real one.
    off_screen : bool

    Attributes
    ----------
    plotter : pyvista.Plotter
    pace : Pace
    actions : Actions
        What keys do.
    """

    def __init__(
        self,
        session: Session,
        *,
        name: str = "mesh",
        folder: str | Path = ".",
        size: tuple[int, int] = (1280, 860),
        live: bool | None = None,
        off_screen: bool = False,
    ) -> None:
        super().__init__(session, name, folder)
        self.pace = Pace()
        self._told = 0.0  # when progress was last shown
        self._drawn = self._took = 0.0  # when the last frame was complete, and how long it took
        with only_errors():
            self.scenery = Scenery(session, self._set, size=size, off_screen=off_screen)
        self.plotter = self.scenery.plotter
        self.camera = self.plotter.camera
        real = self.scenery.has_graphics_card
        wipe = self.scenery.wipe
        self.object = LitObject(
            self.plotter.renderer, session, live=real if live is None else live,
            planes={"now": wipe.now, "before": wipe.before},
        )  # fmt: skip
        session.progress = session.progress or self._progress
        self.go(session.view)
        self.actions = Actions(self)
        bind(self)
        self.settle()

    @property
    def picture_size(self) -> tuple[int, int]:
        """Width and height in pixels of the part that shows the object."""
        return self.scenery.picture_size

    def finish(self) -> None:
        """Take the panel's sliders away."""
        self.scenery.panel.close()

    # --- drawing ----------------------------------------------------------------------------

    def draw(self, *, coarse: bool = False, fresh: bool = True, moving: bool = False) -> None:
        """Draw a frame: the whole object, or its coarse stand-in where it has one.

        What can't be shaded is said, and the session goes back to what could be.
        """
        began = time.perf_counter()
        self.scenery.smooth_edges(on=not moving)
        try:
            shading = self.object.show(coarse=coarse, fresh=fresh)
        except MeshdepictError as error:
            self.said = str(error)
            self.session.go_back(self._shown)
            self._seen = self.session.view
            self.object.touch()
            shading = self.object.show(coarse=coarse)
        else:
            self._shown = self.session.look_now()
        self.scenery.update(self.said, self.object.why_baked)
        self.plotter.render_window.Render()
        self._drawn = time.perf_counter()
        self._took = self._drawn - began
        if coarse:
            self.pace.coarse_shading = shading
        else:
            self.pace.shading = shading if fresh else self.pace.shading
            self.pace.drawing = self._took - shading

    def tick(self) -> None:
        """Draw the whole picture when it is due, else be prepared; a timer's."""
        if self._due is None and not self.pace.keeps_up:
            self.object.prepare()
        super().tick()

    def moved(self, *, recolored: bool) -> None:
        """Draw a frame of a motion, in time.

        Events that queued up while the last frame was drawn are run through, as many seconds as it
        took: else slow frames fall ever further behind the hand.
        """
        if recolored:
            self.object.touch()
        self.soon()
        if time.perf_counter() - self._drawn < self._took:
            return
        pace = self.pace
        coarse = not (pace.keeps_up if recolored else pace.draws_in_time)
        if coarse and not self.object.has_stand_in:
            self.draw(fresh=not recolored or pace.shading <= pace.budget, moving=True)
        else:
            self.draw(coarse=coarse, fresh=not coarse or pace.coarse_keeps_up, moving=True)
        self.soon()

    def look_from(self, view: View | str) -> None:
        """Tell the session another view."""
        colors = self.session._baked
        self.session.look(view)
        if self.session._baked is None or self.session._baked is not colors:
            self.object.touch()

    # --- the pointer ------------------------------------------------------------------------

    def take(self, what: str, at: tuple[int, int]) -> None:
        """Begin to drag the "light" or the "wipe" at a place in pixels."""
        self._held = what, at

    def grip(self, at: tuple[int, int]) -> str | None:
        """Return what a plain drag takes hold of at a place; None for the object itself."""
        wipe, width = self.scenery.wipe, self.picture_size[0]
        return "wipe" if wipe.on and abs(at[0] - wipe.place * width) <= _GRIP else None

    def drag(self, at: tuple[int, int]) -> bool:
        """Move what is held; return whether anything is."""
        if self._held is None:
            return False
        what, before = self._held
        width, height = self.picture_size
        if what == "wipe":
            self.scenery.wipe.move(at[0] / width)
            self.moved(recolored=False)
        else:
            self.turn_light((at[0] - before[0]) / height, (at[1] - before[1]) / height)
        self._held = what, at
        return True

    def turn_light(self, right: float, up: float) -> None:
        """Turn the light by a drag in heights of the picture."""
        self.session.drag_light((right, up))
        self.moved(recolored=True)

    def camera_moved(self) -> None:
        """Follow the camera on its way."""
        follows = self.session.follows_view or self.session.light_fixed_to == "eye"
        if follows:
            self.look()
        self.moved(recolored=follows)

    # --- what takes a while ---------------------------------------------------------------------

    def wait(self, words: str) -> None:
        """Say what will take a while, unless saying it would, too."""
        if self.pace.drawing < _PATIENCE:
            self.scenery.update(words, self.object.why_baked)
            self.plotter.render_window.Render()

    def _progress(self, done: float, total: float) -> None:
        """Show how far the smoothing is; in a tenth of the time at most."""
        now = time.perf_counter()
        if now - self._told > max(0.5, 10 * self.pace.drawing):
            self.wait(f"smoothing normals: {done / total:.0%}")
            self._told = time.perf_counter()

    def _set(self, name: str, value: Any) -> None:
        """Take an option from the panel."""
        self.session.set(**{name: value})
        self.moved(recolored=True)
