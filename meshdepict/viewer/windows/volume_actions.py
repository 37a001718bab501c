"""What the keys of the window on a volume do; `volume_keys` says which key does what."""

from __future__ import annotations

from meshdepict.color.transfer import PRESETS
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.volume_picture import save_volume_picture
from meshdepict.scene.view import VIEWS
from meshdepict.viewer.windows.cycle import next_method, other
from meshdepict.viewer.windows.exports import free_path
from meshdepict.viewer.windows.key_actions import KeyActions
from meshdepict.viewer.windows.volume_keys import KEYS

__all__ = ["VolumeActions"]


class VolumeActions(KeyActions):
    """The actions of `volume_keys.KEYS` on a `VolumeWindow`."""

    keys = KEYS

    # --- the session ------------------------------------------------------------------------

    def next(self, what: str, step: int = 1) -> None:
        """Go on to the next method, preset or view."""
        window, session = self._window, self._window.session
        if what == "method":
            refusals = next_method(session, step)
            window.say(refusals[0] if refusals else "")
        elif what == "preset":
            session.show(other(PRESETS, session.transfer.name, step))
            window.draw()
        else:
            session.look(other(VIEWS, session.view.name, step))
            window.go(session.view)
            window.say(session.view.name)

    def reset(self) -> None:
        """Go back to the beginning."""
        window = self._window
        window.session.reset()
        window.lit.plain = False
        window.box.reset()
        window.lit.clip([])
        window.go(window.session.view)
        window.say("back to the beginning")

    # --- how it is seen ---------------------------------------------------------------------

    def help(self) -> None:
        """Show the keys, or hide them."""
        self._window.helping = not self._window.helping
        self._window.draw()

    def plain(self) -> None:
        """Show VTK's own shading, or the session's again."""
        self._window.lit.plain = not self._window.lit.plain
        self._window.draw()

    def cut(self, axis: str) -> None:
        """Cut a slice off the side that is seen."""
        window = self._window
        window.box.cut("xyz".index(axis), window.towards_eye)
        window.lit.clip(window.box.planes())
        window.draw()

    def mend(self, axis: str) -> None:
        """Put a slice back."""
        window = self._window
        window.box.mend("xyz".index(axis), window.towards_eye)
        window.lit.clip(window.box.planes())
        window.draw()

    # --- files ------------------------------------------------------------------------------

    def snapshot(self) -> None:
        """Save the picture."""
        window = self._window
        window.look()
        path = free_path(f"{window.name}-{window.session.method}", ".png", window.folder)
        baked = window.session.baked()
        size = tuple(window.plotter.render_window.GetSize())
        save_volume_picture(
            baked, path, Figure(size=size), plain=window.lit.plain, planes=window.box.planes()
        )
        window.say(f"saved {path}")

    def save(self) -> None:
        """Save the shaded voxels."""
        window = self._window
        path = free_path(f"{window.name}-{window.session.method}", ".vti", window.folder)
        window.say(f"saved {window.session.baked().save(path)}")
