"""The keys of the window on a volume, said once: what they do, and the help."""

from __future__ import annotations

from meshdepict.viewer.windows.keys import POINTER, Key

__all__ = ["KEYS", "action_of", "help_text"]

KEYS = (
    Key("help", ("h", "H", "question"), "h  ?", "these keys"),
    Key("next_method", ("m",), "m", "next method"),
    Key("previous_method", ("M",), "M", "method before"),
    Key("next_preset", ("p",), "p", "next transfer function: bone, skin, ..."),
    Key("previous_preset", ("P",), "P", "transfer function before"),
    Key("light_left", ("Left",), "arrows", "turn the light by 5 degrees"),
    Key("light_right", ("Right",), "", ""),
    Key("light_up", ("Up",), "", ""),
    Key("light_down", ("Down",), "", ""),
    Key("fix_light", ("l", "L"), "l", "light fixed to the eye, or to the object"),
    Key("cut_x", ("x",), "x y z", "cut off a slice on the side that you see, across that axis"),
    Key("cut_y", ("y",), "", ""),
    Key("cut_z", ("z",), "", ""),
    Key("mend_x", ("X",), "X Y Z", "put the slice back"),
    Key("mend_y", ("Y",), "", ""),
    Key("mend_z", ("Z",), "", ""),
    Key("plain", ("w", "W"), "w", "before: VTK's own shading; or after"),
    Key("next_view", ("v",), "v", "next view: front, back, right, ..."),
    Key("previous_view", ("V",), "V", "view before"),
    Key("reset", ("r", "R"), "r", "back to the beginning"),
    Key("snapshot", ("s", "S"), "s", "save a picture (PNG)"),
    Key("save", ("a", "A"), "a", "save the shaded voxels (VTI)"),
    Key("close", ("q", "Q", "e", "E", "Escape"), "q  Esc", "close the window"),
)

_ACTIONS = {symbol: key.action for key in KEYS for symbol in key.symbols}


def action_of(symbol: str) -> str | None:
    """Return what a key (as VTK names it) does; None where it does nothing."""
    return _ACTIONS.get(symbol)


def help_text() -> tuple[str, str]:
    """Return two columns of the same number of lines: keys, and what they do."""
    rows = [*POINTER, *((key.shown, key.words) for key in KEYS if key.shown)]
    return "\n".join(keys for keys, _ in rows), "\n".join(words for _, words in rows)
