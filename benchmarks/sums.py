"""All ways of Gaussian sums, taken apart as their cost model takes them; one core.

`scripts/cost_constants.py` makes the model's constants of these.
"""

from __future__ import annotations

import math

import numpy as np

import meshdepict as md
from meshdepict import threads
from meshdepict.sums import direct_sums as direct
from meshdepict.sums import grid_sums as blocks
from meshdepict.sums import spectral_sums as spectral
from meshdepict.sums.ordered_points import OrderedPoints

ERROR = 1e-4  # about what the default tolerance asks of sums
CELLS = (1_000_000, 2_000_000, 4_000_000, 8_000_000, 16_000_000, 32_000_000, 64_000_000)


class _OneCore:
    """Constants are seconds of one core."""

    def teardown(self, *_: object) -> None:
        threads.limit(None)


class Direct(_OneCore):
    """Neighbours of a surface within the radius; so many edges wide, so many channels."""

    params = ((5, 10),)
    param_names = ("channels",)
    vertices, edges = 36_000, 6

    def setup(self, channels: int) -> None:
        threads.limit(1)
        ball = md.samples.golf_ball(self.vertices)
        self.width = self.edges * ball.edge_length
        self.radius = math.sqrt(2 * math.log(1 / ERROR))
        rows = np.ones((channels, len(ball.vertices)))
        self.points = ball.vertices
        self.groups = direct.PointGroups(OrderedPoints(self.points, rows))
        self.time_summing(channels)

    def time_summing(self, channels: int) -> None:
        self.groups.sums(self.width, self.radius, np.float32)


class Points(_OneCore):
    """Many points and a grid that counts for nothing: what spreading and reading off cost."""

    params = (("float32", "float64"),)
    param_names = ("kind",)
    count = 400_000

    def setup(self, kind: str) -> None:
        threads.limit(1)
        rng = np.random.default_rng(1)
        self.xyz = rng.uniform(-1, 1, (3, self.count))
        self._plan(kind)

    def _plan(self, kind: str) -> None:
        every = np.arange(self.xyz.shape[1])
        self.tiles = [spectral.Tile(every, every)]
        self.channels = np.ones((2, len(every)), kind)
        few = np.arange(9)
        spectral.spectral_sums(self.xyz, self.channels, ERROR, [spectral.Tile(few, few)])

    def time_summing(self, kind: str) -> None:
        spectral.spectral_sums(self.xyz, self.channels, ERROR, self.tiles)


class Grid(Points):
    """Few points far apart: what the transforms of a grid of about so many cells cost."""

    params = (("float32",), CELLS)
    param_names = ("kind", "cells")

    def setup(self, kind: str, cells: int) -> None:
        threads.limit(1)
        # The torus has a margin of the radius r, and r/π frequencies for each unit; twice finer,
        # or 1.25 times where that is the cheaper way.
        radius = math.sqrt(2 * math.log(2 / ERROR))
        half = (cells ** (1 / 3) / 2 * math.pi / radius - radius) / 2
        self.xyz = np.random.default_rng(1).uniform(-half, half, (3, 64))
        self.xyz[:, 0], self.xyz[:, 1] = -half, half
        self._plan(kind)

    def time_summing(self, kind: str, cells: int) -> None:
        super().time_summing(kind)


class Blocks(_OneCore):
    """A surface on a sparse grid, where blurs cost much and little; spread anew or not."""

    params = ((4, 9), (3, 24), ("anew", "kept"))
    param_names = ("channels", "edges", "spread")
    vertices = 72_000

    def setup(self, channels: int, edges: int, spread: str) -> None:
        threads.limit(1)
        ball = md.samples.golf_ball(self.vertices)
        rule = blocks.rule_for(1e-5)
        assert rule is not None
        self.rule, self.width = rule, edges * ball.edge_length
        points = OrderedPoints(ball.vertices, np.ones((channels, len(ball.vertices))))
        self.grid = blocks.PointGrid(points)
        self.grid.sums(self.width, self.rule)

    def time_summing(self, channels: int, edges: int, spread: str) -> None:
        if spread == "anew":
            self.grid.forget()
        self.grid.sums(self.width, self.rule)
