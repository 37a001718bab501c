"""What keys do in every window: from a key to an action, and the light."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.viewer.windows.keys import Key, action_of, hint

__all__ = ["ARROWS", "KeyActions"]

ARROWS = {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}
_TURN = 5 / 180  # of the light for an arrow key: 5°, in heights of the picture


class KeyActions:
    """The actions of keys on a window: a method of that name for each.

    Where there is none, as of ``cut_x`` or ``light_left``, the part after the line is the argument
    of the method that is called as the part before it. An action draws what it has changed.
    """

    keys: Sequence[Key]

    def __init__(self, window: Any) -> None:
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

    def light(self, direction: str) -> None:
        """Turn the light a little."""
        right, up = ARROWS[direction]
        self._window.turn_light(_TURN * right, _TURN * up)

    def fix_light(self) -> None:
        """Fix the light to the eye, or to the object again."""
        window = self._window
        window.look()
        to = "eye" if window.session.light_fixed_to == "object" else "object"
        window.session.fix_light(to)
        goes = {"eye": "goes with the eye", "object": "stays with the object"}[to]
        window.say(f"the light {goes} now")

    def next(self, what: str, step: int = 1) -> None:
        """Go on to the next of something."""
        raise NotImplementedError

    def previous(self, what: str) -> None:
        """Go back to the one before."""
        self.next(what, -1)

    def close(self) -> None:
        """Close the window."""
        self._window.close()
