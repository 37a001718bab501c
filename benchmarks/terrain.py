"""Methods from maps on rasters of heights: Horn's relief, horizons, windows, balls."""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.heights.deviation import deviations
from meshdepict.heights.dominance import dominances
from meshdepict.heights.fractional_laplacian import texture
from meshdepict.heights.horizons import HORIZONS, open_angles, sky_shares
from meshdepict.heights.horn import mark_relief, relief
from meshdepict.scales.making import scale_space
from meshdepict.shapes.height_field import HeightField

STEPS = np.array([[[2.0, 0.0], [0.0, -2.0]]])
LIGHT = (-0.5, 0.5, math.sqrt(0.5))


@functools.cache
def ground(side: int) -> NDArray[np.float32]:
    """Heights of rough land, side × side: the same bits everywhere."""
    rng = np.random.default_rng(1)
    ridges = np.add.outer(*rng.normal(0, 1, (2, side)).cumsum(axis=1))
    return (ridges + 3 * rng.random((side, side), np.float32)).astype(np.float32)


class Relief:
    """One light, as gdaldem's hillshade, and Mark's four: without reading and writing files."""

    params = ((4_000, 10_000),)
    param_names = ("side",)

    def setup(self, side: int) -> None:
        self.z = ground(side)
        relief(self.z[:50], None, STEPS, LIGHT)
        mark_relief(self.z[:50], None, STEPS)

    def time_one_light(self, side: int) -> None:
        relief(self.z, None, STEPS, LIGHT)

    def time_four_lights(self, side: int) -> None:
        mark_relief(self.z, None, STEPS)


class Horizons:
    """16 directions, 10 cells far: what the Relief Visualization Toolbox does by default."""

    params = (HORIZONS, (1_000, 4_000))
    param_names = ("horizon", "side")

    def setup(self, horizon: str, side: int) -> None:
        self.z = ground(side)
        sky_shares(self.z[:50], None, STEPS, horizon=horizon)
        open_angles(self.z[:50], None, STEPS, horizon=horizon)

    def time_sky(self, horizon: str, side: int) -> None:
        sky_shares(self.z, None, STEPS, horizon=horizon)

    def time_openness(self, horizon: str, side: int) -> None:
        open_angles(self.z, None, STEPS, horizon=horizon)


class Windows:
    """What looks at squares, rings, or all of the raster."""

    params = ((2_000,),)
    param_names = ("side",)

    def setup(self, side: int) -> None:
        self.z = ground(side)
        deviations(self.z[:50], None, 5)
        dominances(self.z[:50], None)

    def time_position(self, side: int) -> None:
        for radius in (8, 67, 670):
            deviations(self.z, None, radius)

    def time_dominance(self, side: int) -> None:
        dominances(self.z, None)

    def time_texture(self, side: int) -> None:
        texture(self.z, None, (2.0, 2.0))


class Balls:
    """Three balls about every cell, the largest of 16 cells."""

    params = ((500,),)
    param_names = ("side",)

    def setup(self, side: int) -> None:
        self.space = scale_space(HeightField(ground(side)), scales=0)
        size = self.space.shape.edge_length / self.space.shape.diagonal
        self.radii = [16 * size, 8 * size, 4 * size]
        scale_space(HeightField(ground(30)), scales=0).ball_shares([0.1])

    def time_sharing(self, side: int) -> None:
        self.space.ball_shares(self.radii)
        self.space.ball_shares(self.radii[:1])  # the last ones are kept
