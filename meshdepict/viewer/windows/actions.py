"""What the window's keys do; `keys` says which key does what."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshdepict.scene.view import VIEWS
from meshdepict.viewer.windows import exports
from meshdepict.viewer.windows.camera import project_in_parallel, project_in_perspective
from meshdepict.viewer.windows.cycle import colormaps, next_method, other
from meshdepict.viewer.windows.key_actions import ARROWS, KeyActions
from meshdepict.viewer.windows.keys import KEYS

__all__ = ["Actions"]

_SHIFT = 0.02  # of the line for a key, in widths of the picture


class Actions(KeyActions):
    """The actions of `keys.KEYS` on a `Window`."""

    keys = KEYS

    # --- the session ------------------------------------------------------------------------

    def next(self, what: str, step: int = 1) -> None:
        """Go on to the next method, colour map, view or page of options."""
        {"method": self._method, "colormap": self._colormap, "view": self._view,
         "page": self._page}[what](step)  # fmt: skip

    def choice(self, number: str) -> None:
        """Go on to the next choice of a list of the panel."""
        window = self._window
        if window.scenery.panel.choose(int(number)) is None:
            window.say(f"{window.session.method} has no list {number}")

    def reset(self) -> None:
        """Go back to the beginning."""
        window = self._window
        window.session.reset()
        window.scenery.wipe.on = False
        window.object.compare(on=False)
        window.go(window.session.view)
        window.object.touch()
        window.say("back to the beginning")

    def _method(self, step: int) -> None:
        from meshdepict.shading.registry import METHODS

        window = self._window
        wanted = other(list(METHODS), window.session.method, step)
        window.wait(f"computing {wanted.replace('_', ' ')} ...")
        refusals = next_method(window.session, step)
        window.object.touch()
        window.say(refusals[0] if refusals else "")

    def _colormap(self, step: int) -> None:
        session = self._window.session
        session.paint(other(colormaps(session), session.colormap, step))
        self._window.object.touch()
        self._window.say(f"colour map: {session.colormap or 'gray'}")

    def _view(self, step: int) -> None:
        window = self._window
        window.look_from(other(VIEWS, window.session.view.name, step))
        window.go(window.session.view)
        window.say(window.session.view.name)

    def _page(self, _: int) -> None:
        self._window.scenery.panel.turn_page()
        self._window.draw()

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
        """Show before and after, parted by a line, or after alone."""
        window = self._window
        window.scenery.wipe.on = not window.scenery.wipe.on
        window.object.compare(on=window.scenery.wipe.on)
        window.draw()

    def line(self, direction: str) -> None:
        """Move the line to the left or right."""
        wipe = self._window.scenery.wipe
        wipe.move(wipe.place + _SHIFT * ARROWS[direction][0])
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
        self._window.look()
        self._save(exports.save_snapshot, self._window.scenery.picture_size)

    def save_mesh(self) -> None:
        """Save the mesh with its colours."""
        self._window.look()
        self._save(exports.save_mesh)

    def save_recipe(self) -> None:
        """Save the look."""
        self._window.look()
        self._save(exports.save_look)

    def _save(self, save: Any, *more: Any) -> None:
        window = self._window
        try:
            path: Path = save(window.session, window.name, *more, folder=window.folder)
        except OSError as error:
            window.say(f"it can't be saved in {window.folder}: {error.strerror or error}")
        else:
            window.say(f"saved {path.name}")
