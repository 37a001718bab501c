"""Small pictures of bakes and of their live counterparts, taken by the same camera."""

import numpy as np
import pyvista as pv

import meshdepict as md
from meshdepict.drawing.picture import plot
from meshdepict.viewer.live import LiveShading

SIZE = (300, 300)


def portrait(baked):
    """The picture of a bake."""
    window = plot(baked, off_screen=True, window_size=list(SIZE))
    window.render_window.SetMultiSamples(0)  # which take most of the time, and show nothing here
    try:
        return window.screenshot(return_img=True)
    finally:
        window.close()


def drawn(live, view="front"):
    """The picture of a live shading, in the view of a bake of the same shape."""
    plain = plot(
        md.bake(live._space, "lambert", view=view), off_screen=True, window_size=list(SIZE)
    )
    window = pv.Plotter(off_screen=True, window_size=list(SIZE))
    window.render_window.SetMultiSamples(0)
    try:
        window.set_background("white")
        window.add_actor(live.actor)
        window.camera = plain.camera.copy()
        window.reset_camera_clipping_range()
        live.check(window)
        return window.screenshot(return_img=True)
    finally:
        window.close()
        plain.close()


def difference(a, b):
    """Grey levels between two pictures, per pixel of the object in either."""
    there = (a < 255).any(axis=2) | (b < 255).any(axis=2)
    return np.abs(a.astype(int) - b).max(axis=2)[there]


def compare(space, method, *, options=None, light="northwest", view="front", colormap=None):
    """The difference between a live shading and the bake with the same arguments."""
    options = options or {}
    baked = md.bake(space, method, light=light, view=view, colormap=colormap, **options)
    live = LiveShading(space, method, options=options, light=light, view=view, colormap=colormap)
    return difference(drawn(live, view), portrait(baked))
