"""How surfaces bend: the estimators, and the view's curvature."""

from __future__ import annotations

import meshdepict as md
from benchmarks import subjects
from meshdepict.curvature import ESTIMATORS


class Principal:
    """An estimator on a mesh."""

    params = (tuple(ESTIMATORS), ("golf ball", "bunny"))
    param_names = ("estimator", "subject")

    def setup(self, estimator: str, subject: str) -> None:
        self.mesh = subjects.mesh(subject)
        self.time_estimating(estimator, subject)

    def time_estimating(self, estimator: str, subject: str) -> None:
        md.curvature.principal_curvatures(self.mesh, method=estimator)


class Views:
    """The curvature that an eye sees, of a scale of its own for each run."""

    params = (("golf ball", "bunny"),)
    param_names = ("subject",)

    def setup(self, subject: str) -> None:
        self.space = md.scale_space(subjects.mesh(subject), scales=1)
        self.space.curvature(1)
        self.time_seeing(subject)

    def time_seeing(self, subject: str) -> None:
        md.curvature.view_curvature(self.space, "front")
