"""The papers' own per-pixel methods: what a view sees, its pyramid, and the light."""

from __future__ import annotations

import meshdepict as md
from benchmarks import subjects

SIDES = (400, 1000)  # pixels


class GBuffers:
    """Rays through the centres of all pixels of a square picture."""

    params = (SIDES,)
    param_names = ("side",)

    def setup(self, side: int) -> None:
        self.mesh = subjects.mesh("golf ball")
        md.GBuffer.of(self.mesh, "front", size=(32, 32))

    def time_looking(self, side: int) -> None:
        md.GBuffer.of(self.mesh, "front", size=(side, side))

    def peakmem_looking(self, side: int) -> None:
        self.time_looking(side)


class LightAlignment:
    """Local Light Alignment per pixel: with its bilateral pyramid, and a new light alone."""

    params = (SIDES,)
    param_names = ("side",)

    def setup(self, side: int) -> None:
        ball = subjects.mesh("golf ball")
        self.pixels = md.GBuffer.of(ball, "front", size=(side, side))
        small = md.GBuffer.of(ball, "front", size=(32, 32))
        md.bake(small, "light_alignment", light="west")  # compiles, or loads what was compiled
        self.space = md.scale_space(self.pixels, scales=5, ratio=1.7)

    def time_baking(self, side: int) -> None:
        md.bake(self.pixels, "light_alignment", light="west")

    def peakmem_baking(self, side: int) -> None:
        self.time_baking(side)

    def time_new_light(self, side: int) -> None:
        md.shading.light_alignment(self.space, (300.0, 30.0))
