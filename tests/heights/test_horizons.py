"""Horizons: planes and cones whose skies are known, the toolbox's rule by hand, and no-data."""

from __future__ import annotations

import math

import numpy as np
import pytest
from grounds import AXES, placed, plane

from meshdepict.errors import MeshdepictError
from meshdepict.heights.horizons import (
    horizon_reach,
    horizons,
    open_angles,
    sky_shares,
)
from meshdepict.heights.map_rules import HORIZONS

SQUARES = AXES["squares"]


def toolbox(z: np.ndarray, size: float, directions: int, radius: int) -> list[np.ndarray]:
    """tan γ of every direction, by shifting whole rasters as the Relief Visualization Toolbox."""
    found = []
    padded = np.pad(z, radius, mode="reflect")
    for turn in 2 * np.pi * np.arange(directions) / directions:
        along = np.arange(1, radius + 1e-9, 1 / 3)
        cells = {(round(math.cos(turn) * t), round(math.sin(turn) * t)) for t in along}
        best = np.full(padded.shape, -1000.0)
        for cell in cells:
            rise = (np.roll(padded, cell, axis=(0, 1)) - padded) / (size * math.hypot(*cell))
            best = np.fmax(best, rise)
        found.append(best[radius:-radius, radius:-radius])
    return found


@pytest.mark.parametrize("holes", [False, True])
def test_horizons_over_cells_are_those_of_the_toolbox(
    holes: bool,
    rng: np.random.Generator,
) -> None:
    z = rng.normal(0, 1, (40, 52)).cumsum(0).cumsum(1)
    valid = rng.random(z.shape) > (0.2 if holes else -1)
    rises = toolbox(np.where(valid, z, np.nan), 2.0, 16, 10)
    sky = 1 - np.mean([np.sin(np.arctan(np.fmax(rise, 0))) for rise in rises], axis=0)
    angle = 90 - np.degrees(np.mean([np.arctan(rise) for rise in rises], axis=0))
    given = (z, valid if holes else None, SQUARES)
    ours = sky_shares(*given, directions=16, radius=10, horizon="cells")
    np.testing.assert_allclose(ours[valid], sky[valid], atol=1e-5)
    ours = open_angles(*given, directions=16, radius=10, horizon="cells")
    np.testing.assert_allclose(ours[valid], angle[valid], atol=1e-3)


@pytest.mark.parametrize("steps", AXES.values(), ids=AXES)
@pytest.mark.parametrize("horizon", HORIZONS)
def test_on_a_plane_a_horizon_is_the_plane(steps: np.ndarray, horizon: str) -> None:
    z = plane(steps, (30, 34), 0.4, -0.2) + 1e6
    inner = np.s_[10:-10, 10:-10]
    turn = 2 * np.pi * np.arange(16) / 16
    rise = 0.4 * np.cos(turn) - 0.2 * np.sin(turn)
    if horizon == "lines":
        found = horizons(z, None, steps, directions=16, radius=8)[(slice(None), *inner)]
        np.testing.assert_allclose(found, rise[:, None, None] * np.ones_like(found), atol=1e-6)
        sky = 1 - np.sin(np.arctan(np.maximum(rise, 0))).mean()
        np.testing.assert_allclose(sky_shares(z, None, steps, radius=8)[inner], sky, atol=1e-6)
    # Whatever rises on one side falls on the other. Cells beside a line are up to half a cell off
    # it, and the highest of them counts: the toolbox's rule closes a plane's sky by 3°.
    for negative in (False, True):
        angle = open_angles(z, None, steps, radius=8, horizon=horizon, negative=negative)
        np.testing.assert_allclose(angle[inner], 90, atol=2e-5 if horizon == "lines" else 3)


@pytest.mark.parametrize("steps", AXES.values(), ids=AXES)
def test_the_sky_over_a_pit_is_that_of_a_cone(steps: np.ndarray) -> None:
    """At ρ from the middle of h = kρ, the farthest point that is looked at stands highest."""
    k, radius = 0.8, 20
    east, north = placed(steps, (121, 121))
    z = k * np.hypot(east, north)
    metres = radius * np.linalg.norm(steps[0], axis=0).min()
    # Rays end at a row or column, a step before the radius at most.
    turn = 2 * np.pi * np.arange(32) / 32
    here = np.s_[40:81:5, 40:81:5]
    x, y = east[here][..., None], north[here][..., None]

    def rise(far: float) -> np.ndarray:
        ends = np.hypot(x + far * np.cos(turn), y + far * np.sin(turn))
        return k * (ends - np.hypot(x, y)) / far

    longest, shortest = (1 - np.sin(np.arctan(np.maximum(rise(f), 0))).mean(axis=2)
                         for f in (metres, metres * (1 - 1.5 / radius)))  # fmt: skip
    found = sky_shares(z, None, steps, directions=32, radius=radius)[here]
    # Between cells a cone is interpolated from above: by d²/8ρ at ρ, 0.1 steps on average.
    assert (found > longest - 4e-3).all()
    assert (found < shortest + 4e-3).all()


def test_the_sky_over_a_peak_is_that_of_its_tangent_plane() -> None:
    """From the flank of h = −kρ the ground is steepest where it begins."""
    k = 0.8
    east, north = placed(SQUARES, (121, 121))
    z = -k * np.hypot(east, north)
    turn = 2 * np.pi * np.arange(64) / 64
    sky = 1 - np.sin(np.arctan(np.maximum(k * np.cos(turn), 0))).mean()
    found = sky_shares(z, None, SQUARES, directions=64, radius=30)[10:30, 60]
    # The first place that is looked at is a step away, on a circle of 30 to 50 steps.
    np.testing.assert_allclose(found, sky, atol=5e-3)


def test_negative_openness_is_that_of_the_ground_turned_over(rng: np.random.Generator) -> None:
    z = rng.normal(0, 1, (30, 40)).cumsum(0)
    below = open_angles(z, None, SQUARES, negative=True)
    np.testing.assert_array_equal(below, open_angles(-z, None, SQUARES))
    assert np.abs(below - open_angles(z, None, SQUARES)).max() > 1


def test_angles_are_those_of_the_tangents_and_skies_their_sines(rng: np.random.Generator) -> None:
    z = 5 * rng.normal(0, 1, (30, 40))
    rise = horizons(z, None, SQUARES, radius=4)[:, 4:-4, 4:-4].astype(float)
    inner = np.s_[4:-4, 4:-4]
    angle = 90 - np.degrees(np.arctan(rise).mean(axis=0))
    np.testing.assert_allclose(open_angles(z, None, SQUARES, radius=4)[inner], angle, atol=1e-4)
    sky = 1 - np.sin(np.arctan(np.maximum(rise, 0))).mean(axis=0)
    np.testing.assert_allclose(sky_shares(z, None, SQUARES, radius=4)[inner], sky, atol=1e-6)


@pytest.mark.parametrize("horizon", HORIZONS)
def test_what_holds_no_height_is_no_horizon(horizon: str, rng: np.random.Generator) -> None:
    z = np.zeros((40, 40), np.float32)
    valid = np.ones(z.shape, bool)
    z[20:24, 10:30], valid[20:24, 10:30] = 500, False
    sky = sky_shares(z, valid, SQUARES, horizon=horizon)
    np.testing.assert_array_equal(sky, 1)
    # A wall behind them is seen over them, and hides no less than without them.
    wall = np.where(valid, np.where(np.arange(40)[:, None] < 18, 0, 30.0), 0)
    with_hole = sky_shares(wall, valid, SQUARES, horizon=horizon)
    filled = sky_shares(np.where(valid, wall, 30), None, SQUARES, horizon=horizon)
    assert (with_hole[:18] >= filled[:18]).all()
    assert (with_hole[10] < 1).all()


@pytest.mark.parametrize("shape", [(1, 12), (12, 1), (1, 1), (2, 2)])
@pytest.mark.parametrize("horizon", HORIZONS)
def test_small_rasters_have_a_sky(shape: tuple[int, int], horizon: str) -> None:
    z = np.full(shape, 7.0)
    np.testing.assert_array_equal(sky_shares(z, None, SQUARES, horizon=horizon), 1)
    if horizon == "lines":
        np.testing.assert_array_equal(open_angles(z, None, SQUARES), 90)
    assert np.isfinite(open_angles(z, None, SQUARES, horizon=horizon)).all()


def test_a_window_with_a_rim_has_the_numbers_of_the_whole(rng: np.random.Generator) -> None:
    steps = np.array([[[2 * math.cos(r / 200), 0], [0, -2.0]] for r in range(80)])
    z = rng.normal(0, 3, (80, 90)).astype(np.float32)
    rim = horizon_reach(7.5)
    for look in (sky_shares, open_angles):
        whole = look(z, None, steps, radius=7.5)
        part = look(z[20:60, 30:70], None, steps[20:60], radius=7.5)
        inner = np.s_[rim:-rim, rim:-rim]
        np.testing.assert_array_equal(part[inner], whole[20:60, 30:70][inner])


def test_steps_that_vary_count_in_their_row() -> None:
    """A wall two metres from every cell: in the east, however many cells that is."""
    steps = np.array([[[width, 0], [0, -4.0]] for width in (0.5, 1.0, 2.0)])
    z = np.zeros((3, 30))
    for row, away in enumerate((4, 2, 1)):
        z[row, 10 + away] = 2.0
    rise = horizons(z, None, steps, directions=4, radius=4)[0]
    np.testing.assert_allclose(rise[:, 10], 1)


def test_a_ray_looks_at_least_to_the_next_cell() -> None:
    z = np.zeros((9, 9))
    z[4, 5] = 2
    rise = horizons(z, None, SQUARES, directions=4, radius=0.2)[:, 4, 4]
    np.testing.assert_allclose(rise, [1, 0, 0, 0])


def test_another_horizon_is_refused() -> None:
    with pytest.raises(MeshdepictError, match="horizon='cell' is not one of lines, cells"):
        sky_shares(np.zeros((3, 3)), None, SQUARES, horizon="cell")
