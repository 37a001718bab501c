"""What a level mirror shows, as a mesh: objects turned over below it, and a sky behind them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.seen_side import towards_eye
from meshdepict.scene.view import View
from meshdepict.shapes.ground_plane import GroundPlane
from meshdepict.shapes.joined import JoinedMesh
from meshdepict.shapes.mesh import Mesh

__all__ = ["MirrorImage"]

Floats = NDArray[np.float64]

_BEHIND = 4.0  # diagonals of the objects: farther from the eye than all that is turned over


class MirrorImage(Mesh):
    """Meshes as a ground that is a mirror shows them to an eye above it.

    Behind them is the ground itself, moved away from the eye: where nothing stands in the way it
    shows the sky.

    Parameters
    ----------
    ground : GroundPlane
    meshes : sequence of Mesh
        What stands on it.
    view : View
        From where it is seen.

    Attributes
    ----------
    coverage : (n,) array of float32
        How much of each vertex pictures show: of the meshes', then of the ground's.
    """

    def __init__(self, ground: GroundPlane, meshes: Sequence[Mesh], view: View) -> None:
        objects = JoinedMesh(meshes)
        up = ground.up
        height = (objects.vertices - ground.middle) @ up
        below = objects.vertices - 2 * height[:, None] * up
        to_eye = np.broadcast_to(towards_eye(below, view), below.shape)
        rise = to_eye @ up
        seen = below + (height / np.where(rise > 0, rise, 1))[:, None] * to_eye
        shown = np.where(rise > 0, ground.share_at(seen), 0)
        away = np.broadcast_to(towards_eye(ground.vertices, view), ground.vertices.shape)
        sky = ground.vertices - _BEHIND * ground.unit * away
        # Turned over, what was counter-clockwise is clockwise.
        faces = objects.faces[:, ::-1], ground.faces + len(below)
        super().__init__(np.concatenate([below, sky]), np.concatenate(faces), winding="keep")
        above = np.where(away @ up > 0, ground.coverage, 0)
        self.coverage = np.concatenate([shown, above]).astype(np.float32)
        self._ground = ground

    @property
    def outline(self) -> Floats:
        """The part (k, 3) of the mirror that pictures show."""
        return self._ground.outline
