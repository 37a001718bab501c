"""What moves the light in a window: shading from a finished scale space."""

from __future__ import annotations

import itertools

import meshdepict as md
from benchmarks import subjects


class NewLight:
    """Exaggerated Shading of nine scales, as a function of samples."""

    params = (subjects.SUBJECTS,)
    param_names = ("subject",)

    def setup(self, subject: str) -> None:
        self.space = md.scale_space(subjects.mesh(subject), scales=9)
        self.angles = itertools.cycle(range(360))
        md.shading.exaggerated(self.space, "northwest")

    def time_shading(self, subject: str) -> None:
        md.shading.exaggerated(self.space, (next(self.angles), 30.0))


class NewBake:
    """Every method, with colours and provenance; what a method keeps is there already."""

    params = (tuple(md.shading.METHODS),)
    param_names = ("method",)

    def setup(self, method: str) -> None:
        self.space = md.scale_space(subjects.mesh("golf ball"), scales=9)
        self.angles = itertools.cycle(range(360))
        self.time_baking(method)

    def time_baking(self, method: str) -> None:
        md.bake(self.space, method, light=(next(self.angles), 30.0))
