"""What a page shows beside colours at the vertices: a baked texture, and the mesh before."""

from __future__ import annotations

import copy
from functools import cached_property
from typing import TYPE_CHECKING, Any

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.appearance import Appearance
from meshdepict.viewer.looks_before import colors_before, own_look
from meshdepict.viewer.packed_appearance import pack_appearance
from meshdepict.viewer.session_texture import SessionTexture

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from meshdepict.baking.baked_texture import BakedTexture
    from meshdepict.viewer.session import Session

__all__ = ["LOOKS", "Looks"]

LOOKS = ("before", "texture")
"""What can be fetched."""


class Looks:
    """How what a session shows looks in a texture, and how it looked before.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._textures = SessionTexture(session)
        self._colors: NDArray[np.uint8] | None = None  # of which the texture is a finer copy
        self._count = 0

    @property
    def number(self) -> int:
        """That of the texture which is shown: another one for each; 0 where there is none."""
        return 0 if self._colors is None else self._count

    @property
    def texture(self) -> BakedTexture | None:
        """The texture that is shown, in the session's view."""
        if self._colors is None or self._textures.baked is None:
            return None
        found = copy.copy(self._textures.baked)
        found.view = self._session.view
        return found

    def bake(self, *, wanted: bool) -> None:
        """Show what the session shows in a texture from now on, until that changes, or no more."""
        if wanted:
            self._textures.bake()
            self._colors = self._session.colors
            self._count += 1
        else:
            self._colors = None

    def refresh(self) -> None:
        """Show the texture no more where the session has other colours by now."""
        if self._colors is not None and self._session.colors is not self._colors:
            self._colors = None

    def described(self) -> dict[str, Any]:
        """Return what the page's controls show."""
        before = "Lambert" if self._own is None else self._own.name
        found = [{"name": "before", "words": before}]
        texture = self.texture
        words = None if self._session.shape.kind != "mesh" else ""
        if texture is not None:
            found.insert(0, {"name": "vertices", "words": "colours at the vertices"})
            words = f"texture, {len(texture.image):,} × {len(texture.image):,} texels"
        return {"comparisons": found, "own": self._own is not None, "texture": words}

    def packed(self, name: str) -> bytes:
        """Return one of `LOOKS` as pages take it.

        Raises
        ------
        MeshdepictError
            Where there is none by now.
        """
        texture = self._textures.baked
        if name == "texture":
            if self._colors is None or texture is None:
                raise MeshdepictError("there is no texture any more: something has changed")
            found = Appearance(self._session.surface, textures=texture.appearance.textures)
            return pack_appearance(found).whole
        if self._own is not None:
            return self._packed_own
        colors = colors_before(self._session)
        return pack_appearance(Appearance(self._session.surface, colors)).whole

    @cached_property
    def _own(self) -> Appearance | None:
        return own_look(self._session)

    @cached_property
    def _packed_own(self) -> bytes:
        assert self._own is not None
        return pack_appearance(self._own).whole
