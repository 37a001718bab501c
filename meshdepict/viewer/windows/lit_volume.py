"""The volume in the window: shaded by the card or baked and repainted, beside VTK's own shading."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.shader import caught_errors
from meshdepict.drawing.volume_rays import ray_caster
from meshdepict.drawing.volume_scene import add_baked, add_plain, add_rgba, repaint
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.live.volume_shading import LiveVolume
from meshdepict.viewer.windows.lit_shape import BEFORE, LitShape
from meshdepict.viewer.windows.volume_pick import first_seen
from meshdepict.viewer.windows.volume_session import VolumeSession

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane
    from vtkmodules.vtkRenderingCore import vtkVolume

    from meshdepict.baking.volumes import BakedVolume
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.drawing.plotter import Plotter

__all__ = ["LitVolume"]


class LitVolume(LitShape):
    """A volume that a session shows, in a plotter; parameters as of `LitShape`.

    One ``vtkVolume`` at a time, and VTK's own shading beside it while the two are compared.
    """

    _session: VolumeSession

    def __init__(
        self, plotter: Plotter, session: VolumeSession, *, live: bool, planes: dict[str, vtkPlane]
    ) -> None:
        super().__init__(plotter, session, live=live, planes=planes)
        self._actor: vtkVolume | None = None
        self._live: LiveVolume | None = None
        self._shown_for: tuple[Any, ...] = ()  # what the actor was made for
        self._painted: BakedVolume | None = None  # the bake that it has
        self._before: vtkVolume | None = None  # VTK's own shading
        self._before_for: TransferFunction | None = None  # the transfer function that it has
        self._box: list[vtkPlane] = []
        self._pixels = 1.0
        self._own_rays = True
        self._refused: tuple[Any, ...] = ()  # what the card could not shade, not to be tried again

    @property
    def pixels(self) -> float:
        """Pixels between rays."""
        return self._pixels

    def show(self, *, coarse: bool = False, fresh: bool = True) -> float:
        """Bring what is shown up to date; see `LitShape.show`. There is no stand-in."""
        took = self._show_now() if fresh or self._actor is None else 0.0
        if self.comparing and self._before_for is not self._session.transfer:
            self._drop_before()
            self._before = add_plain(self._plotter, self._session.shape, self._session.transfer)
            self._before_for = self._session.transfer
            self.coarsen(self._pixels)
            self._clip()
        return took

    def point_at(self, place: tuple[int, int]) -> NDArray[np.float64] | None:
        """Return the point (3,) of the scene where a ray's light is half used up, if any."""
        renderer, ends = self._plotter.renderer, []
        for depth in (0.0, 1.0):
            renderer.SetDisplayPoint(*place, depth)
            renderer.DisplayToWorld()
            end = np.array(renderer.GetWorldPoint())
            ends.append(end[:3] / end[3])
        session = self._session
        return first_seen(session.shape, session.transfer, ends[0], ends[1], self._box)

    def compare(self, *, on: bool, what: str = BEFORE) -> None:
        """Show VTK's own shading, too, or no longer: its copy of a volume takes memory."""
        super().compare(on=on, what=what)
        if not on:
            self._drop_before()
        self._clip()

    def coarsen(self, pixels: float) -> None:
        """Send a ray through every so many pixels alone, along both sides."""
        self._pixels = pixels
        for actor in self._actors():
            ray_caster(actor).SetImageSampleDistance(pixels)

    def clip(self, planes: list[vtkPlane]) -> None:
        """Show what is on the positive side of planes (vtkPlane)."""
        self._box = planes
        self._clip()

    def _clip(self) -> None:
        for when, actor in (("now", self._actor), ("before", self._before)):
            if actor is not None:
                mapper = actor.GetMapper()
                mapper.RemoveAllClippingPlanes()
                for plane in (*self._box, *([self._planes[when]] if self.comparing else ())):
                    mapper.AddClippingPlane(plane)

    def _actors(self) -> list[vtkVolume]:
        return [actor for actor in (self._actor, self._before) if actor is not None]

    def _drop_before(self) -> None:
        self._remove(self._before)
        self._before = self._before_for = None

    def _remove(self, actor: vtkVolume | None) -> None:
        if actor is not None:
            self._plotter.renderer.RemoveVolume(actor)
            actor.ReleaseGraphicsResources(self._plotter.render_window)

    def _show_now(self) -> float:
        """Bring the session's shading up to date; return the seconds that it took."""
        began = time.perf_counter()
        if self._show_live():
            return time.perf_counter() - began
        session = self._session
        baked = session.baked()
        took = time.perf_counter() - began
        self._become(("baked", session.transfer, id(baked.space)), self._add_baked)
        if self._painted is not baked:
            began = time.perf_counter()
            self._paint(baked)
            took += time.perf_counter() - began
        return took

    def _become(self, key: tuple[Any, ...], add: Callable[[], vtkVolume]) -> None:
        """Put another actor in the place of the one there, unless it is the same."""
        if key == self._shown_for:
            return
        former = self._actor
        self._live, self._painted = None, None
        self._actor = add()
        self._remove(former)
        self._shown_for = key
        self.coarsen(self._pixels)
        self._clip()

    def _add_baked(self) -> vtkVolume:
        baked = self._session.baked()
        self._painted = baked
        if self._own_rays:
            actor = add_baked(self._plotter, baked)
            try:
                with caught_errors("the volume"):
                    self._plotter.render_window.Render()
                return actor
            except MeshdepictError:
                self._own_rays = False
                self._plotter.renderer.RemoveVolume(actor)
        return add_rgba(self._plotter, baked)

    def _paint(self, baked: BakedVolume) -> None:
        if self._own_rays:
            assert self._actor is not None
            repaint(self._actor, baked)
            self._painted = baked
        else:
            self._shown_for = ()
            self._become(("baked", self._session.transfer, id(baked.space)), self._add_baked)

    def _show_live(self) -> bool:
        """Have the card shade; return whether it can."""
        session = self._session
        key = ("live", session.transfer, session.function)
        if not self._may_live or key == self._refused:
            return False
        options = self._options()
        try:
            if key != self._shown_for or self._live is None:
                made = LiveVolume(
                    session.space, session.function, options=options, light=session.light,
                    view=session.view,
                )  # fmt: skip
                made.check()
                self._become(key, lambda: self._added(made))
                self._live = made
            else:
                self._live.set_view(session.view)
                self._live.set_light(session.light)
                self._live.set_options(**options)
        except MeshdepictError as error:
            self.why_baked, self._refused = str(error), key
            return False
        self.why_baked, self._refused = "", ()
        return True

    def _added(self, live: LiveVolume) -> vtkVolume:
        self._plotter.renderer.AddVolume(live.actor)
        return live.actor
