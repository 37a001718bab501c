"""The keys of the window on a volume, said once; see `keys`."""

from __future__ import annotations

from meshdepict.viewer.windows.keys import LIGHT_KEYS, Key

__all__ = ["KEYS"]

KEYS = (
    Key("help", ("h", "H", "question"), "h  ?", "these keys"),
    Key("next_method", ("m",), "m", "next method"),
    Key("previous_method", ("M",), "M", "method before"),
    Key("next_preset", ("p",), "p", "next transfer function: bone, skin, ..."),
    Key("previous_preset", ("P",), "P", "transfer function before"),
    *LIGHT_KEYS,
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
