"""Shading by the graphics card, or by software OpenGL: a new light, drawn and finished."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import meshdepict as md
from benchmarks import subjects
from meshdepict.viewer.live import live_methods

SEVERAL = ("light_warping",)  # shown with eight lights


def lit(method: str, step: int, view: md.View) -> Any:
    """Return a light that goes once round in about 40 frames, and as many as the method wants."""
    lamp = md.Light(md.scene.as_light((9.0 * step, 40.0), view).direction)
    return replace(lamp, spread=60).disc(8) if method in SEVERAL else lamp


class NewLight:
    """A frame under a moving light.

    Parameters
    ----------
    subject : str
        Of `subjects`, or the path of a mesh.
    size : (width, height)
        In pixels.
    samples : int
        Per pixel. Several cost software OpenGL more than the shading does.
    options : mapping, optional
        Of the method.
    """

    params = (tuple(live_methods()),)
    param_names = ("method",)

    def __init__(
        self,
        subject: str = "large golf ball",
        *,
        size: tuple[int, int] = (800, 600),
        samples: int = 0,
        options: Mapping[str, Any] | None = None,
    ) -> None:
        self.subject, self.size, self.samples = subject, size, samples
        self.options = dict(options or {})

    def setup(self, method: str) -> None:
        import pyvista as pv

        from meshdepict.drawing.canvas import place
        from meshdepict.viewer.live import LiveShading

        mesh = subjects.mesh(self.subject)
        self.view = md.View.fitted("front", mesh, aspect=self.size[0] / self.size[1])
        self.space = md.scale_space(mesh, scales=9)
        self.step = itertools.count()
        self.live = LiveShading(
            self.space, method, options=self.options, light=lit(method, 0, self.view),
            view=self.view,
        )  # fmt: skip
        self.window = pv.Plotter(off_screen=True, window_size=list(self.size))
        self.window.render_window.SetMultiSamples(self.samples)
        self.window.add_actor(self.live.actor)
        place(self.window.camera, self.view, mesh)
        self.window.reset_camera_clipping_range()
        try:
            self.live.check(self.window)
        except md.MeshdepictError as error:
            raise NotImplementedError(str(error)) from None
        self.time_frame(method)

    def teardown(self, method: str) -> None:
        self.window.close()

    def time_getting_ready(self, method: str) -> None:
        from meshdepict.viewer.live import LiveShading

        light = lit(method, 0, self.view)
        LiveShading(self.space, method, options=self.options, light=light, view=self.view)

    def time_frame(self, method: str) -> None:
        self.live.set_light(lit(method, next(self.step), self.view))
        self.window.render_window.Render()
        self.window.render_window.WaitForCompletion()
