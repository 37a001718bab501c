"""The window on a mesh.

Handlers never compute for longer than a frame's budget while something moves: big meshes have a
coarse stand-in then, and the whole picture comes when the hand rests.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict.scene.view import View
from meshdepict.viewer.session_texture import SessionTexture
from meshdepict.viewer.windows import exports
from meshdepict.viewer.windows.cycle import colormaps, other
from meshdepict.viewer.windows.lit_object import LitObject
from meshdepict.viewer.windows.lit_window import LitWindow
from meshdepict.viewer.windows.mesh_actions import MeshActions

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane

    from meshdepict.baking.baked_texture import BakedTexture

__all__ = ["Window"]


class Window(LitWindow):
    """A window over a `Session` on a mesh; parameters and attributes as of `LitWindow`."""

    object: LitObject

    @functools.cached_property
    def textures(self) -> SessionTexture:
        """What bakes textures of what is shown."""
        return SessionTexture(self.session)

    @property
    def texture(self) -> BakedTexture | None:
        """The one that is shown; None where colours are at vertices."""
        return self.textures.baked if self.object.is_textured else None

    def wear(self, texture: BakedTexture) -> None:
        """Show the mesh in a texture of what the session shows, but draw nothing."""
        self.textures.adopt(texture)
        self.object.wear(texture.appearance)

    def _made_actions(self) -> MeshActions:
        return MeshActions(self)

    def _made_object(self, *, live: bool, planes: dict[str, vtkPlane]) -> LitObject:
        return LitObject(self.plotter, self.session, live=live, planes=planes)

    def _refine(self, *, moving: bool) -> None:
        self.scenery.smooth_edges(on=not moving)

    def _move(self, *, recolored: bool) -> None:
        pace = self.pace
        coarse = not (pace.keeps_up if recolored else pace.draws_in_time)
        if coarse and not self.object.has_stand_in:
            self.draw(fresh=not recolored or pace.shades_in_time, moving=True)
        else:
            self.draw(coarse=coarse, fresh=not coarse or pace.coarse_keeps_up, moving=True)

    def tick(self) -> None:
        """Draw the whole picture when it is due, else be prepared; a timer's."""
        if self._due is None and not self.pace.keeps_up:
            self.object.prepare()
        super().tick()

    def look_from(self, view: View | str) -> None:
        """Tell the session another view."""
        colors = self.session._baked
        self.session.look(view)
        if self.session._baked is None or self.session._baked is not colors:
            self.object.touch()

    def next_colors(self, step: int) -> str:
        """Go on to the next colour map; return its name."""
        session = self.session
        session.paint(other(colormaps(session), session.colormap, step))
        return f"colour map: {session.colormap or 'gray'}"

    def save_picture(self) -> Path:
        """Save the picture, as large as it is here, without the controls."""
        if self.texture is not None:
            return exports.save_texture(
                self.texture, self.session, self.name, ".png", size=self.picture_size,
                folder=self.folder,
            )  # fmt: skip
        return exports.save_snapshot(self.session, self.name, self.picture_size, folder=self.folder)

    def save_shape(self) -> Path:
        """Save the mesh with its colours, or in its texture."""
        if self.texture is not None:
            return exports.save_texture(
                self.texture, self.session, self.name, ".glb", folder=self.folder
            )
        return exports.save_mesh(self.session, self.name, folder=self.folder)
