"""What the keys of the window on a volume do beside those of every window: its box."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from meshdepict.viewer.windows.actions import Actions
from meshdepict.viewer.windows.volume_keys import KEYS

__all__ = ["VolumeActions"]


class VolumeActions(Actions):
    """The actions of `volume_keys.KEYS` on a `VolumeWindow`."""

    keys = KEYS
    _window: Any  # a VolumeWindow

    def cut(self, axis: str) -> None:
        """Cut a slice off the side that is seen."""
        self._change(self._window.box.cut, axis)

    def mend(self, axis: str) -> None:
        """Put a slice back."""
        self._change(self._window.box.mend, axis)

    def _change(self, change: Callable[[int, Any], None], axis: str) -> None:
        window = self._window
        change("xyz".index(axis), window.towards_eye)
        window.object.clip(window.box.planes())
        window.draw()
