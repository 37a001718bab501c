"""What the keys of the window on a mesh do beside those of every window: its texture."""

from __future__ import annotations

from typing import Any

from meshdepict.viewer.windows.actions import Actions

__all__ = ["MeshActions"]


class MeshActions(Actions):
    """The actions of `keys.KEYS` on a `Window`."""

    _window: Any  # a Window

    def texture(self) -> None:
        """Bake what is seen into a texture and show it, or show the vertices again."""
        window = self._window
        if window.texture is not None:
            window.object.touch()
            window.say("colours at the vertices")
            return
        window.wait("baking a texture ...")
        window.look()
        texture = window.textures.bake()
        window.wear(texture)
        size = len(texture.image)
        window.say(f"texture, {size:,} x {size:,} texels: w compares")
