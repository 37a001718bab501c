"""The expensive step of meshes: normals at every width."""

from __future__ import annotations

import os

import meshdepict as md
from benchmarks import subjects

SCALES = 9
EDGES = (1, 2, 4, 8, 16, 32, 64, 128, 300)
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)


class Making:
    """Nine scales, facing 1, at the default tolerance."""

    params = (subjects.SUBJECTS,)
    param_names = ("subject",)

    def setup(self, subject: str) -> None:
        self.mesh = subjects.mesh(subject)
        md.scale_space(self.mesh, scales=1)  # compiles, or loads what was compiled

    def time_making(self, subject: str) -> None:
        md.scale_space(self.mesh, scales=SCALES)

    def peakmem_making(self, subject: str) -> None:
        md.scale_space(self.mesh, scales=SCALES)


class OneWidth:
    """A single width, so many median edges wide."""

    params = (("large golf ball", "bunny_144k"), EDGES)
    param_names = ("subject", "edges")

    def setup(self, subject: str, edges: int) -> None:
        self.mesh = subjects.mesh(subject)
        self.width = edges * self.mesh.edge_length
        md.scale_space(self.mesh, scales=1, width=self.width)

    def time_making(self, subject: str, edges: int) -> None:
        md.scale_space(self.mesh, scales=1, width=self.width)


class Tolerance:
    """What accuracy costs."""

    params = (("golf ball", "bunny"), TOLERANCES, (1, 0))
    param_names = ("subject", "tolerance", "facing")

    def setup(self, subject: str, tolerance: float, facing: int) -> None:
        self.mesh = subjects.mesh(subject)
        md.scale_space(self.mesh, scales=1)

    def time_making(self, subject: str, tolerance: float, facing: int) -> None:
        md.scale_space(self.mesh, scales=SCALES, tolerance=tolerance, facing=facing)


class Huge:
    """3.5 million faces at 13 scales: minutes, and only where MESHDEPICT_HUGE is set."""

    number, repeat, rounds, warmup_time, timeout = 1, 1, 1, 0.0, 1_800

    def setup(self) -> None:
        if "MESHDEPICT_HUGE" not in os.environ:
            raise NotImplementedError("MESHDEPICT_HUGE is not set")
        self.path = subjects.path("arma_3500k")
        self.mesh = subjects.mesh("arma_3500k")

    def time_reading(self) -> None:
        subjects.ready(md.read_mesh(self.path))

    def time_making(self) -> None:
        md.scale_space(self.mesh, scales=13, tolerance=1e-3)

    def peakmem_making(self) -> None:
        md.scale_space(self.mesh, scales=13, tolerance=1e-3)
