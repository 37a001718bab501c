"""Live shading on the graphics card: a new light or option costs no pass over the vertices.

Normals of every scale lie on the card as vertex attributes, light and options are uniforms, and
the vertex shader does what the functions of `meshdepict.shading` do, which are its reference: a
frame equals the picture of a bake with the same arguments. What can't be done that way is refused
with a `MeshdepictError`, upon which a viewer bakes on the CPU instead.
"""

from __future__ import annotations

from meshdepict.viewer.live.live_shading import LiveShading, live_methods

__all__ = ["LiveShading", "live_methods"]
