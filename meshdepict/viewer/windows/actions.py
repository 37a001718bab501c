"""What the windows' keys do; `keys` says which key does what."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import VIEWS
from meshdepict.viewer.windows import exports
from meshdepict.viewer.windows.camera import project_in_parallel, project_in_perspective
from meshdepict.viewer.windows.cycle import next_method, other
from meshdepict.viewer.windows.keys import KEYS, Key, action_of, hint

if TYPE_CHECKING:
    from meshdepict.viewer.windows.lit_window import LitWindow

__all__ = ["Actions"]

_ARROWS = {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}
_TURN = 5 / 180  # of the light for an arrow key: 5°, in heights of the picture
_SHIFT = 0.02  # of the line for a key, in widths of the picture


class Actions:
    """The actions of keys on a window: a method of that name for each.

    Where there is none, as of ``light_left`` or ``choice_1``, the part after the line is the
    argument of the method that is called as the part before it. An action draws what it changes.

    Attributes
    ----------
    keys : sequence of Key
    """

    keys: Sequence[Key] = KEYS

    def __init__(self, window: LitWindow) -> None:
        self._window = window

    def press(self, symbol: str) -> None:
        """Do what a key (as VTK names it) does; say so where it does nothing or can't."""
        window, action = self._window, action_of(symbol, self.keys)
        if action is None:
            if hint(symbol):
                window.say(hint(symbol))
            return
        window.said = ""
        word, _, rest = action.partition("_")
        try:
            if hasattr(self, action):
                getattr(self, action)()
            else:
                getattr(self, word)(rest)
        except MeshdepictError as error:
            window.say(str(error))

    # --- the session ------------------------------------------------------------------------

    def next(self, what: str, step: int = 1) -> None:
        """Go on to the next method, colours, view or page of options."""
        {"method": self._method, "colors": self._colors, "view": self._view,
         "page": self._page}[what](step)  # fmt: skip

    def previous(self, what: str) -> None:
        """Go back to the one before."""
        self.next(what, -1)

    def choice(self, number: str) -> None:
        """Go on to the next choice of a list of the panel."""
        window = self._window
        if window.scenery.panel.choose(int(number)) is None:
            window.say(f"{window.session.method} has no list {number}")

    def reset(self) -> None:
        """Go back to the beginning."""
        self._window.reset()
        self._window.say("back to the beginning")

    def _method(self, step: int) -> None:
        from meshdepict.shading.registry import METHODS

        window = self._window
        wanted = other(list(METHODS), window.session.method, step)
        window.wait(f"computing {wanted.replace('_', ' ')} ...")
        refusals = next_method(window.session, step)
        window.object.touch()
        window.say(refusals[0] if refusals else "")

    def _colors(self, step: int) -> None:
        window = self._window
        said = window.next_colors(step)
        window.object.touch()
        window.say(said)

    def _view(self, step: int) -> None:
        window = self._window
        window.look_from(other(VIEWS, window.session.view.name, step))
        window.go(window.session.view)
        window.say(window.session.view.name)

    def _page(self, _: int) -> None:
        self._window.scenery.panel.turn_page()
        self._window.draw()

    # --- the light --------------------------------------------------------------------------

    def light(self, direction: str) -> None:
        """Turn the light a little."""
        right, up = _ARROWS[direction]
        self._window.turn_light(_TURN * right, _TURN * up)

    def fix_light(self) -> None:
        """Fix the light to the eye, or to the object again."""
        window = self._window
        window.look()
        to = "eye" if window.session.light_fixed_to == "object" else "object"
        window.session.fix_light(to)
        goes = {"eye": "goes with the eye", "object": "stays with the object"}[to]
        window.say(f"the light {goes} now")

    # --- how it is seen ---------------------------------------------------------------------

    def help(self) -> None:
        """Show the keys, or hide them."""
        scenery = self._window.scenery
        scenery.helping = not scenery.helping
        self._window.draw()

    def bare(self) -> None:
        """Show the object alone, or all controls again."""
        scenery = self._window.scenery
        scenery.bare = not scenery.bare
        self._window.draw()

    def wipe(self) -> None:
        """Show before and after, parted by a line, or after alone; what else was before first."""
        window = self._window
        known, shown = window.object.comparisons, window.object.compared
        number = known.index(shown) + 1 if window.scenery.wipe.on and shown in known else 0
        if window.scenery.wipe.on and number == len(known):
            window.compare(on=False)
            window.draw()
        else:
            window.compare(on=True, what=known[number])
            window.say(f"left of the line: {known[number]}" if len(known) > 1 else "")

    def line(self, direction: str) -> None:
        """Move the line to the left or right."""
        wipe = self._window.scenery.wipe
        wipe.move(wipe.place + _SHIFT * _ARROWS[direction][0])
        self._window.moved(recolored=False)

    def fly(self) -> None:
        """Look at the point under the pointer, from the same side."""
        window = self._window
        point = window.object.point_at(window.plotter.iren.interactor.GetEventPosition())
        if point is None:
            window.say("f looks at the point under the pointer: there is none")
            return
        camera = window.camera
        shift = point - np.array(camera.focal_point)
        camera.position = tuple(np.array(camera.position) + shift)
        camera.focal_point = tuple(point)
        window.plotter.renderer.ResetCameraClippingRange()
        window.settle()

    def attend(self) -> None:
        """Draw attention to the point under the pointer."""
        self._window.attend(self._window.plotter.iren.interactor.GetEventPosition())

    def projection(self) -> None:
        """Change between parallel projection and perspective."""
        window, camera = self._window, self._window.camera
        parallel = not camera.parallel_projection
        (project_in_parallel if parallel else project_in_perspective)(camera)
        window.plotter.renderer.ResetCameraClippingRange()
        window.look()
        window.say("parallel projection" if parallel else "perspective")

    # --- what is taken away -----------------------------------------------------------------

    def snapshot(self) -> None:
        """Save the picture, as large as it is here, without the controls."""
        self._save(self._window.save_picture)

    def save_shape(self) -> None:
        """Save the shape with its colours."""
        self._save(self._window.save_shape)

    def save_recipe(self) -> None:
        """Save the look."""
        window = self._window
        self._save(lambda: exports.save_look(window.session, window.name, folder=window.folder))

    def _save(self, save: Callable[[], Path]) -> None:
        window = self._window
        window.look()
        try:
            path = save()
        except OSError as error:
            window.say(f"it can't be saved in {window.folder}: {error.strerror or error}")
        else:
            window.say(f"saved {path.name}")

    def close(self) -> None:
        """Close the window."""
        self._window.close()
