"""The volume in the window: shaded by the card, or baked and repainted, or VTK's own shading."""

from __future__ import annotations

from typing import Any

from meshdepict.drawing.shader import caught_errors
from meshdepict.drawing.volume_scene import add_baked, add_plain, add_rgba, repaint
from meshdepict.errors import MeshdepictError
from meshdepict.options import options_of
from meshdepict.viewer.live.volume_shading import LiveVolume
from meshdepict.viewer.windows.lit_object import NO_CARD
from meshdepict.viewer.windows.volume_session import VolumeSession

__all__ = ["LitVolume"]


class LitVolume:
    """What a session shows, in a plotter; one ``vtkVolume`` at a time.

    Parameters
    ----------
    plotter : pyvista.Plotter
    session : VolumeSession
    live : bool
        Whether the card may shade.

    Attributes
    ----------
    plain : bool
        Whether VTK's own shading is shown instead, for comparison.
    why_baked : str
        Why the card does not shade; empty where it does.
    """

    def __init__(self, plotter: Any, session: VolumeSession, *, live: bool) -> None:
        self._plotter, self._session, self._may_live = plotter, session, live
        self.plain = False
        self.why_baked = "" if live else NO_CARD
        self._actor: Any = None
        self._live: LiveVolume | None = None
        self._shown_for: tuple[Any, ...] = ()  # what the actor was made for
        self._painted: Any = None  # the bake that it has
        self._planes: list[Any] = []
        self._pixels = 1.0
        self._own_rays = True
        self._refused: tuple[Any, ...] = ()  # what the card could not shade, not to be tried again

    def show(self) -> None:
        """Bring what is shown up to date, but don't draw it.

        Raises
        ------
        MeshdepictError
            Where the method can't shade this.
        """
        session = self._session
        if self.plain:
            self._become(("plain", session.transfer), self._add_plain)
        elif not self._show_live():
            baked = session.baked()
            self._become(("baked", session.transfer, id(baked.space)), self._add_baked)
            if self._painted is not baked:
                self._paint(baked)

    def coarsen(self, pixels: float) -> None:
        """Send a ray through every so many pixels alone, along both sides."""
        self._pixels = pixels
        self._actor.GetMapper().SetImageSampleDistance(pixels)

    def clip(self, planes: list[Any]) -> None:
        """Show what is on the positive side of planes (vtkPlane)."""
        self._planes = planes
        mapper = self._actor.GetMapper()
        mapper.RemoveAllClippingPlanes()
        for plane in planes:
            mapper.AddClippingPlane(plane)

    def _become(self, key: tuple[Any, ...], add: Any) -> None:
        """Put another actor in the place of the one there, unless it is the same."""
        if key == self._shown_for:
            return
        former = self._actor
        self._live, self._painted = None, None
        self._actor = add()
        if former is not None:
            self._plotter.renderer.RemoveVolume(former)
            former.ReleaseGraphicsResources(self._plotter.render_window)
        self._shown_for = key
        self.coarsen(self._pixels)
        self.clip(self._planes)

    def _add_plain(self) -> Any:
        return add_plain(self._plotter, self._session.shape, self._session.transfer)

    def _add_baked(self) -> Any:
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

    def _paint(self, baked: Any) -> None:
        if self._own_rays:
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
        options = {name: o.default for name, o in options_of(session.function).items()}
        options |= session.options
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

    def _added(self, live: LiveVolume) -> Any:
        self._plotter.renderer.AddVolume(live.actor)
        return live.actor
