"""A texture of what a session shows: baked once asked for, and quickly again for another light."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meshdepict.baking.texture_choices import MOST_TEXELS, SIZE
from meshdepict.baking.textures import texture_of
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.parted import PartedMesh
from meshdepict.surface.triangle_pairs import least_size

if TYPE_CHECKING:
    from meshdepict.baking.baked_texture import BakedTexture
    from meshdepict.baking.look import Look
    from meshdepict.viewer.session import Session

__all__ = ["SessionTexture"]


class SessionTexture:
    """Bakes textures of a session.

    Parameters
    ----------
    session : Session
    size : int
        Texels along the side, or more where that has no room for all triangles.

    Attributes
    ----------
    baked : BakedTexture or None
        The last one.
    """

    def __init__(self, session: Session, *, size: int = SIZE) -> None:
        self._session, self._size = session, size
        self.baked: BakedTexture | None = None
        self._look: Look | None = None  # of the last one

    def bake(self) -> BakedTexture:
        """Bake the texture of what the session shows now, in its own texture coordinates.

        In new ones where it has none, or such as can't be baked in. Where only the light, the view
        or options have changed since the last one, nothing is smoothed again.

        Raises
        ------
        MeshdepictError
            Of terrain, whose cells are its texels, and as `bake_texture`.
        """
        session, look = self._session, self._session.look_now()
        if isinstance(session.shape, HeightField):
            raise MeshdepictError("textures are of meshes, and this is terrain: it has its cells")
        if self.baked is not None and self._only_relit(look):
            chosen = {name: getattr(look, name) for name in ("light", "view", "colormap")}
            self.baked = self.baked.with_look(**chosen, **look.options)
        else:
            self.baked = self._sampled(look)
        self._look = look
        return self.baked

    def adopt(self, baked: BakedTexture) -> None:
        """Begin with a texture of what the session shows."""
        self.baked, self._look = baked, self._session.look_now()

    def _only_relit(self, look: Look) -> bool:
        last = self._look
        return (
            last is not None
            and last.function is look.function
            and set(last.options) <= set(look.options)
        )

    def _sampled(self, look: Look) -> BakedTexture:
        session = self._session
        shape = session.surface
        mesh = shape.before if isinstance(shape, PartedMesh) else shape
        size = max(self._size, min(least_size(len(mesh.faces)), MOST_TEXELS))
        doing, session.doing = session.doing, "baking the texture"
        try:
            return texture_of(mesh, look, size=size, progress=session.progress)
        except MeshdepictError:
            if mesh.texcoords is None:
                raise
            return texture_of(mesh, look, size=size, atlas="new", progress=session.progress)
        finally:
            session.doing = doing
