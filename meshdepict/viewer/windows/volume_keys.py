"""The keys of the window on a volume: those of every window, and its box."""

from __future__ import annotations

from meshdepict.viewer.windows.keys import Key, window_keys

__all__ = ["KEYS"]

KEYS = window_keys(
    "transfer function",
    "the shaded voxels (VTI)",
    Key("cut_x", ("x",), "x y z", "cut off a slice in front, across that axis"),
    Key("cut_y", ("y",), "", ""),
    Key("cut_z", ("z",), "", ""),
    Key("mend_x", ("X",), "X Y Z", "put the slice back"),
    Key("mend_y", ("Y",), "", ""),
    Key("mend_z", ("Z",), "", ""),
)
