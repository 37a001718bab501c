"""What the keys of the window on a volume do; `volume_keys` says which key does what."""

from __future__ import annotations

from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.scene import VIEWS
from meshdepict.transfer import PRESETS
from meshdepict.viewer.drawing.figure import Figure
from meshdepict.viewer.drawing.volume_picture import save_volume_picture
from meshdepict.viewer.windows.cycle import next_method, other
from meshdepict.viewer.windows.exports import free_path
from meshdepict.viewer.windows.keys import hint
from meshdepict.viewer.windows.volume_keys import action_of

__all__ = ["VolumeActions"]

_TURN = 5 / 180  # of the light for an arrow key: 5°, in heights of the picture
_ARROWS = {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}


class VolumeActions:
    """The actions of `volume_keys.KEYS` on a `VolumeWindow`: a method for each.

    Of ``cut_x`` or ``light_left`` the part after the line is the method's argument.
    """

    def __init__(self, window: Any) -> None:
        self._window = window

    def press(self, symbol: str) -> None:
        """Do what a key (as VTK names it) does; say so where it does nothing or can't."""
        window, action = self._window, action_of(symbol)
        if action is None:
            if hint(symbol):
                window.say(hint(symbol))
            return
        window.said = ""
        word, _, rest = action.partition("_")
        try:
            getattr(self, word)(*[rest] if rest else [])
        except MeshdepictError as error:
            window.said = str(error)
        if action != "close":
            window.draw()

    # --- the session ------------------------------------------------------------------------

    def next(self, what: str, step: int = 1) -> None:
        """Go on to the next method, preset or view."""
        window, session = self._window, self._window.session
        if what == "method":
            refusals = next_method(session, step)
            window.said = refusals[0] if refusals else ""
        elif what == "preset":
            session.show(other(PRESETS, session.transfer.name, step))
        else:
            session.look(other(VIEWS, session.view.name, step))
            window.go(session.view)
            window.said = session.view.name

    def previous(self, what: str) -> None:
        """Go back to the one before."""
        self.next(what, -1)

    def light(self, direction: str) -> None:
        """Turn the light a little."""
        right, up = _ARROWS[direction]
        self._window.session.drag_light((_TURN * right, _TURN * up))

    def fix(self, _: str) -> None:
        """Fix the light to the eye, or to the object again."""
        window = self._window
        window.look()
        to = "eye" if window.session.light_fixed_to == "object" else "object"
        window.session.fix_light(to)

    def reset(self) -> None:
        """Go back to the beginning."""
        window = self._window
        window.session.reset()
        window.lit.plain = False
        window.box.reset()
        window.lit.clip([])
        window.go(window.session.view)

    # --- how it is seen ---------------------------------------------------------------------

    def help(self) -> None:
        """Show the keys, or hide them."""
        self._window.helping = not self._window.helping

    def plain(self) -> None:
        """Show VTK's own shading, or the session's again."""
        self._window.lit.plain = not self._window.lit.plain

    def cut(self, axis: str) -> None:
        """Cut a slice off the side that is seen."""
        window = self._window
        window.box.cut("xyz".index(axis), window.towards_eye)
        window.lit.clip(window.box.planes())

    def mend(self, axis: str) -> None:
        """Put a slice back."""
        window = self._window
        window.box.mend("xyz".index(axis), window.towards_eye)
        window.lit.clip(window.box.planes())

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
        window.said = f"saved {path}"

    def save(self) -> None:
        """Save the shaded voxels."""
        window = self._window
        path = free_path(f"{window.name}-{window.session.method}", ".vti", window.folder)
        window.said = f"saved {window.session.baked().save(path)}"

    def close(self) -> None:
        """Close the window."""
        self._window.close()
