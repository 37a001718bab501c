"""The keys of the windows, said once: what they do, the help, and the hint for any other key."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol

__all__ = [
    "KEYS", "POINTER", "WELCOME", "Key", "Pressed", "action_of",
    "help_text", "hint", "window_keys",
]  # fmt: skip

WELCOME = "h shows the keys, q closes the window"
"""What people have to know at first."""


class Key(NamedTuple):
    """One action of the window and the keys (as VTK names them) that start it.

    In the help it stands by `shown` and `words`; without them another key's line speaks for it.
    """

    action: str
    symbols: tuple[str, ...]
    shown: str
    words: str


class Pressed(Protocol):
    """What does what keys say; see `Actions`."""

    @property
    def keys(self) -> Sequence[Key]:
        """What the help lists."""

    def press(self, symbol: str) -> None:
        """Do what a key (as VTK names it) does."""


def window_keys(colors: str, saved: str, *own: Key) -> tuple[Key, ...]:
    """Return the keys of a window on one kind of shape: the same for the same things.

    Parameters
    ----------
    colors : str
        What decides the colours of such a shape.
    saved : str
        As what it is saved.
    *own : Key
        What this kind alone can do.
    """
    # The window turns VTK's and PyVista's own keys off: of theirs, q, e, r, f and v do here what
    # they do there or nearly so; w, s, p, b, c mean something of this program's.
    return (
        Key("help", ("h", "H", "question"), "h  ?", "these keys"),
        Key("next_method", ("m",), "m", "next method"),
        Key("previous_method", ("M",), "M", "method before"),
        Key("next_colors", ("c", "p"), "c", f"next {colors}"),
        Key("previous_colors", ("C", "P"), "C", f"{colors} before"),
        Key("next_page", ("Tab",), "Tab", "more options, where there are"),
        Key("choice_1", ("1", "KP_1"), "1 - 6", "next choice of that list"),
        *(Key(f"choice_{i}", (str(i), f"KP_{i}"), "", "") for i in range(2, 7)),
        Key("light_left", ("Left",), "arrows", "turn the light by 5 degrees"),
        *(Key(f"light_{name.lower()}", (name,), "", "") for name in ("Right", "Up", "Down")),
        Key("fix_light", ("l", "L"), "l", "light fixed to the eye, or to the object"),
        Key("wipe", ("w", "W"), "w", "before and after: a line parts them"),
        Key("line_left", ("bracketleft",), "[", "move the line to the left"),
        Key("line_right", ("bracketright",), "]", "move the line to the right"),
        *own,
        Key("next_view", ("v",), "v", "next view: front, back, right, ..."),
        Key("previous_view", ("V",), "V", "view before"),
        Key("fly", ("f", "F"), "f", "look at the point under the pointer"),
        Key("attend", ("g", "G"), "g", "draw attention to the point under the pointer, or to none"),
        Key("projection", ("o", "O"), "o", "parallel projection, or perspective"),
        Key("bare", ("b", "B"), "b", "the object alone, or all controls"),
        Key("reset", ("r", "R"), "r", "back to the beginning"),
        Key("snapshot", ("s", "S"), "s", "save a picture (PNG)"),
        Key("save_shape", ("a", "A"), "a", f"save {saved}"),
        Key("save_recipe", ("t", "T"), "t", "save this look as a recipe (TOML)"),
        Key("close", ("q", "Q", "e", "E", "Escape"), "q  Esc", "close the window"),
    )


KEYS = window_keys(
    "colour map",
    "the mesh with these colours (PLY; a texture: GLB)",
    Key("texture", ("u", "U"), "u", "bake this look into a texture (u, v), or leave it"),
)
"""Of the window on a mesh."""

POINTER = (
    ("drag", "turn the object"),
    ("Ctrl+drag, right drag", "turn the light"),
    ("Alt+click", "draw attention to a point"),
    ("Shift+drag, middle drag", "move the object"),
    ("wheel", "zoom"),
)
"""What the mouse does."""

# Keys that only change what others mean: pressing them says nothing.
_SILENT = ("Shift", "Control", "Alt", "Meta", "Super", "Caps_Lock", "Num_Lock", "ISO_", "None")


def action_of(symbol: str, keys: Iterable[Key] = KEYS) -> str | None:
    """Return what a key (as VTK names it) does; None where it does nothing."""
    return next((key.action for key in keys if symbol in key.symbols), None)


def hint(symbol: str) -> str:
    """Return what to say on a key that does nothing; nothing for Shift and the like."""
    if not symbol or symbol.startswith(_SILENT):
        return ""
    return f"{symbol} does nothing here: h shows the keys"


def help_text(keys: Iterable[Key] = KEYS) -> tuple[str, str]:
    """Return two columns of the same number of lines: keys, and what they do."""
    rows = [*POINTER, *((key.shown, key.words) for key in keys if key.shown)]
    return "\n".join(shown for shown, _ in rows), "\n".join(words for _, words in rows)
