"""The window: an object under a light that moves with a drag, and everything else on keys.

What it shows is the `Session`'s; keys are in `keys`, options in `option_panel`. Kinds of shapes
have windows of their own, `Window` and `VolumeWindow`, which differ in how they follow a moving
hand, and in what their kind alone can do.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict.drawing.canvas import only_errors, place
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.camera import camera_view, same_sight
from meshdepict.viewer.windows.keys import Pressed
from meshdepict.viewer.windows.lit_shape import BEFORE, LitShape
from meshdepict.viewer.windows.preview import Pace
from meshdepict.viewer.windows.scenery import Scenery
from meshdepict.viewer.windows.window_events import bind, run_loop

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane

__all__ = ["SIZE", "LitWindow"]

SIZE = (1280, 860)
"""Of a window in pixels, unless said otherwise."""

_REST = 0.15  # seconds without a move, after which the whole picture is due
_PATIENCE = 1.0  # seconds that a frame may take which only says what comes
_GRIP = 8  # pixels round the wipe's line where it can be taken


class LitWindow:
    """A PyVista window over a session.

    Parameters
    ----------
    session : Session
    name : str, optional
        In the title, and what saved files are called; its kind unless given.
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
    camera : pyvista.Camera
    scenery : Scenery
        What stands round the object.
    object : LitShape
        What is lit.
    pace : Pace
    actions : Actions
        What keys do.
    said : str
        The last message.
    fault : BaseException or None
        What ended the window, to be raised when it is gone.
    """

    object: LitShape
    actions: Pressed

    def __init__(
        self,
        session: Session,
        *,
        name: str | None = None,
        folder: str | Path = ".",
        size: tuple[int, int] = SIZE,
        live: bool | None = None,
        off_screen: bool = False,
    ) -> None:
        session.baked()  # what can't be shaded is refused before a window opens
        self.session = session
        self.name, self.folder = name or session.shape.kind.replace(" ", "-"), folder
        self.said = ""
        self.fault: BaseException | None = None
        self.pace = Pace()
        self._held: tuple[str, tuple[int, int]] | None = None  # what a drag moves
        self._due: float | None = None
        self._shown = session.look_now()
        self._shape = session.shape  # that is drawn: terrain may be raised
        self._seen: View = session.view
        self._told = 0.0  # when progress was last shown
        self._drawn = self._took = 0.0  # when the last frame was complete, and how long it took
        self.actions = self._made_actions()
        with only_errors():
            self.scenery = Scenery(
                session, self._set, name=self.name, keys=self.actions.keys, size=size,
                off_screen=off_screen,
            )  # fmt: skip
            real = self.scenery.has_graphics_card
        self.plotter = self.scenery.plotter
        self.camera = self.plotter.camera
        wipe = self.scenery.wipe
        self.object = self._made_object(
            live=real if live is None else live, planes={"now": wipe.now, "before": wipe.before}
        )
        session.progress = session.progress or self._progress
        self.go(session.view)
        bind(self)
        self.settle()

    # --- what kinds of shapes have of their own ---------------------------------------------

    def _made_actions(self) -> Pressed:
        raise NotImplementedError

    def _made_object(self, *, live: bool, planes: dict[str, vtkPlane]) -> LitShape:
        raise NotImplementedError

    def _refine(self, *, moving: bool) -> None:
        """Make the frame that comes fine, or coarse while something moves."""
        raise NotImplementedError

    def _move(self, *, recolored: bool) -> None:
        """Draw a frame of a motion."""
        raise NotImplementedError

    def next_colors(self, step: int) -> str:
        """Go on to the next of what decides the colours; return what to say."""
        raise NotImplementedError

    def save_picture(self) -> Path:
        """Save the picture, as large as it is here, without the controls."""
        raise NotImplementedError

    def save_shape(self) -> Path:
        """Save the shape with its colours."""
        raise NotImplementedError

    def reset(self) -> None:
        """Go back to the beginning, but draw nothing."""
        self.session.reset()
        self._reshape()
        self.compare(on=False)
        self.go(self.session.view)
        self.object.touch()

    # --- drawing ----------------------------------------------------------------------------

    @property
    def picture_size(self) -> tuple[int, int]:
        """Width and height in pixels of the part that shows the object."""
        return self.scenery.picture_size

    def draw(self, *, coarse: bool = False, fresh: bool = True, moving: bool = False) -> None:
        """Draw a frame: the whole object, or its coarse stand-in where it has one.

        What can't be shaded is said, and the session goes back to what could be.
        """
        began = time.perf_counter()
        self._refine(moving=moving)
        try:
            shading = self.object.show(coarse=coarse, fresh=fresh)
        except MeshdepictError as error:
            self.said = str(error)
            self.session.go_back(self._shown)
            self._reshape()
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

    def moved(self, *, recolored: bool) -> None:
        """Draw a frame of a motion, in time.

        Events that queued up while the last frame was drawn are run through, as many seconds as it
        took: else slow frames fall ever further behind the hand.
        """
        if recolored:
            self.object.touch()
        self.soon()
        if not self._late:
            self._move(recolored=recolored)
            self.soon()

    @property
    def _late(self) -> bool:
        """Whether events of now were waiting while the last frame was drawn."""
        return time.perf_counter() - self._drawn < self._took

    def settle(self) -> None:
        """Take over where the camera is, and draw the whole picture."""
        self._due = None
        self.look()
        self.draw()

    def tick(self) -> None:
        """Draw the whole picture when it is due; a timer's."""
        if self._due is not None and self._held is None and time.perf_counter() >= self._due:
            self.settle()

    def soon(self) -> None:
        """Have the whole picture drawn once the hand rests."""
        self._due = time.perf_counter() + _REST

    def compare(self, *, on: bool, what: str = BEFORE) -> None:
        """Part before and after by a line, or show after alone; draw nothing."""
        self.scenery.wipe.on = on
        self.object.compare(on=on, what=what)

    # --- the eye ----------------------------------------------------------------------------

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

    def camera_moved(self) -> None:
        """Follow the camera on its way."""
        follows = self.session.follows_view or self.session.light_fixed_to == "eye"
        if follows:
            self.look()
        self.moved(recolored=follows)

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

    def let_go(self) -> bool:
        """End a drag; return whether there was one."""
        held, self._held = self._held, None
        return held is not None

    def turn_light(self, right: float, up: float) -> None:
        """Turn the light by a drag in heights of the picture."""
        self.session.drag_light((right, up))
        self.moved(recolored=True)

    def attend(self, at: tuple[int, int]) -> None:
        """Draw attention to the point that is seen at a place in pixels, or to none any more.

        Raises
        ------
        MeshdepictError
            Where the method draws none.
        """
        shape, point = self.session.shape, self.object.point_at(at)
        if point is not None:  # of the scene: in diagonals from the centre
            point = point * (shape.diagonal or 1.0) + shape.centre
        name = self.session.attend(point)
        self.object.touch()
        where = "nowhere in particular" if point is None else "the point under the pointer"
        self.say(f"{name.replace('_', ' ')}: {where}")

    # --- what is said -------------------------------------------------------------------------

    def say(self, words: str) -> None:
        """Show a message, until the next one."""
        self.said = words
        self.draw()

    def wait(self, words: str) -> None:
        """Say what will take a while, unless saying it would, too."""
        if self.pace.drawing < _PATIENCE:
            self.scenery.update(words, self.object.why_baked)
            self.plotter.render_window.Render()

    def _progress(self, done: float, total: float) -> None:
        """Show how far the smoothing is, or the rays; in a tenth of the time at most."""
        now = time.perf_counter()
        if now - self._told > max(0.5, 10 * self.pace.drawing):
            self.wait(f"{self.session.doing}: {done / total:.0%}")
            self._told = time.perf_counter()

    def _set(self, name: str, value: float | str) -> None:
        """Take an option from the panel."""
        self.session.set(**{name: value})
        self._reshape()
        self.moved(recolored=True)

    def _reshape(self) -> None:
        """Draw another shape where the session has one: terrain with other heights."""
        if self.session.shape is not self._shape:
            self._shape = self.session.shape
            self.object.remake()
            self.go(self.session.view)

    # --- its end ------------------------------------------------------------------------------

    def run(self, *, frames: int | None = None) -> None:
        """Stay open until it is closed; off screen, for a number of frames.

        Raises
        ------
        MeshdepictError
            Where there is no display.
        """
        run_loop(self, frames)

    def finish(self) -> None:
        """Take the panel's sliders away."""
        self.scenery.panel.close()

    def close(self) -> None:
        """Close the window."""
        self._due = None
        self.plotter.iren.interactor.TerminateApp()
