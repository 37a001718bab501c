"""The window on a volume.

While anything moves, rays go through a few pixels only, so that the hand is followed; when it
rests, through all of them.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.display import check_display
from meshdepict.io.volumes import volume_stem
from meshdepict.viewer.windows import exports
from meshdepict.viewer.windows.camera import camera_view
from meshdepict.viewer.windows.clipping_box import ClippingBox
from meshdepict.viewer.windows.cycle import other
from meshdepict.viewer.windows.lit_volume import LitVolume
from meshdepict.viewer.windows.lit_window import SIZE, LitWindow
from meshdepict.viewer.windows.volume_actions import VolumeActions
from meshdepict.viewer.windows.volume_session import VolumeSession

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane

__all__ = ["VolumeWindow", "show_volume"]

_BUDGET = 0.08  # seconds that drawing may take while something moves
_COARSEST = 6.0  # pixels between rays: more and nothing can be made out
_PATIENCE = 1.0  # seconds of shading that a motion waits for


def show_volume(
    volume: object,
    method: str = "exaggerated",
    *,
    name: str | None = None,
    size: tuple[int, int] = SIZE,
    frames: int | None = None,
    **settings: Any,
) -> VolumeWindow:
    """Open a window on a volume, and return it once it is closed.

    Parameters
    ----------
    volume : path, Volume, pyvista.ImageData or BakedVolume
    method : str
    name : str, optional
        In the title, and what saved files are called; the file's unless given.
    size : (int, int)
        Of the window in pixels.
    frames : int, optional
        Draw so many off screen, and end.
    **settings
        As for `VolumeSession`: transfer, light, view, up, scales, …, and the method's options.

    Raises
    ------
    MeshdepictError
        As `bake_volume`, and where there is no display.
    """
    if frames is None:
        check_display()
    if name is None and isinstance(volume, (str, os.PathLike)):
        name = volume_stem(volume)
    session = VolumeSession(volume, method, **settings)
    window = VolumeWindow(session, name=name, size=size, off_screen=frames is not None)
    window.run(frames=frames)
    return window


class VolumeWindow(LitWindow):
    """A window over a `VolumeSession`; parameters and attributes as of `LitWindow`.

    Attributes
    ----------
    box : ClippingBox
        What is shown of the volume.
    """

    session: VolumeSession
    object: LitVolume

    def _made_actions(self) -> VolumeActions:
        return VolumeActions(self)

    def _made_object(self, *, live: bool, planes: dict[str, vtkPlane]) -> LitVolume:
        self.box = ClippingBox(self.session.shape)
        self._moving = False
        return LitVolume(self.plotter, self.session, live=live, planes=planes)

    @property
    def lit(self) -> LitVolume:
        """The volume that is lit."""
        return self.object

    @property
    def towards_eye(self) -> NDArray[np.float64]:
        """Unit vector from the volume to the eye."""
        return camera_view(self.camera, self.session.shape).towards_eye

    def _refine(self, *, moving: bool) -> None:
        """Send as many rays as there was time for, by the last frame's."""
        drawing = max(self._took - self.pace.shading, 0.0)
        pixels = self.object.pixels * math.sqrt(drawing / _BUDGET) if moving else 1.0
        self.object.coarsen(min(max(pixels, 1.0), _COARSEST))
        self._moving = moving

    @property
    def _late(self) -> bool:
        """Whether events of now were waiting; the first move after a rest is always shown."""
        return self._moving and super()._late

    def _move(self, *, recolored: bool) -> None:
        self.draw(fresh=not recolored or self.pace.shading <= _PATIENCE, moving=True)

    def next_colors(self, step: int) -> str:
        """Go on to the next transfer function; return its name."""
        session = self.session
        session.show(other(session.transfers, session.transfer.name, step))
        return f"transfer function: {session.transfer.name}"

    def reset(self) -> None:
        """Go back to the beginning, the whole box too, but draw nothing."""
        super().reset()
        self.box.reset()
        self.object.clip([])

    def save_picture(self) -> Path:
        """Save the picture, as large as it is here, without the controls."""
        return exports.save_snapshot(
            self.session, self.name, self.picture_size, planes=self.box.planes(),
            folder=self.folder,
        )  # fmt: skip

    def save_shape(self) -> Path:
        """Save the shaded voxels."""
        return exports.save_voxels(self.session, self.name, folder=self.folder)
