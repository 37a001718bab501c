"""Bilateral smoothing: its definition, Gaussians where depth is even, edges kept where it isn't."""

from itertools import pairwise

import numpy as np
import pytest
from conftest import angle_between
from scipy.optimize import brentq

from meshdepict.scales.bilateral import _rungs, bilateral_step, bilateral_taps

H, W = 24, 30


def cut_gaussian(squared, width):
    """A Gaussian over the distances of a whole lattice, cut at 3σ, that has its variance."""
    lattice = np.add.outer(np.arange(-40, 41) ** 2, np.arange(-40, 41) ** 2)
    lattice = lattice[lattice <= 9 * width**2]

    def excess(sigma):
        weights = np.exp(-lattice / (2 * sigma**2))
        return (weights * lattice).sum() / weights.sum() / 2 - width**2

    sigma = brentq(excess, 0.5 * width, 2 * width)
    return np.exp(-squared / (2 * sigma**2)) * (squared <= 9 * width**2)


def gaussian(squared, width):
    return np.exp(-squared / (2 * width**2))


def slow_step(normals, depth, width, *, depth_range=1.0, kernel=cut_gaussian):
    """The slow twin: every pixel with every other."""
    y, x = np.mgrid[: depth.shape[0], : depth.shape[1]]
    sums = np.zeros(normals.shape)
    for row, column in np.ndindex(depth.shape):
        across = kernel((y - row) ** 2 + (x - column) ** 2, width)
        r = depth - depth[row, column]
        share = np.maximum(1 - r**2 / (16 * (depth_range * width) ** 2), 0) ** 8
        sums[:, row, column] = (across * share * normals).sum(axis=(1, 2))
    length = np.linalg.norm(sums, axis=0)
    return np.where(length > 0, sums / np.where(length > 0, length, 1), normals)


@pytest.fixture
def relief(rng):
    """Normals and depth of gentle waves with a step, and a hole."""
    y, x = np.mgrid[:H, :W].astype(float)
    depth = 2 * np.sin(x / 4) + np.cos(y / 3) + 20 * (x > 18)
    normals = np.stack([-0.5 * np.cos(x / 4), 0.3 * np.sin(y / 3), np.ones_like(x)])
    normals += 0.1 * rng.normal(size=normals.shape)
    normals /= np.linalg.norm(normals, axis=0)
    normals[:, 5:9, 4:8] = 0
    return normals.astype(np.float32), depth.astype(np.float32)


def angles(a, b):
    return angle_between(np.moveaxis(a, 0, -1), np.moveaxis(b, 0, -1))


@pytest.mark.parametrize("depth_range", [0.5, 1.0, np.inf])
@pytest.mark.parametrize("width", [0.8, 1.375, 3.0])
def test_a_step_is_its_definition(relief, width, depth_range):
    normals, depth = relief
    there = normals.any(axis=0)
    found = bilateral_step(normals, depth, width, depth_range=depth_range)
    slow = slow_step(normals, depth, width, depth_range=depth_range)
    assert angles(found, slow)[there].max() < 1e-5  # single precision
    assert not found[:, ~there].any()


@pytest.mark.parametrize("width", [1.0, 1.375, 3.0])
def test_the_cut_at_three_sigma_costs_little(relief, width):
    normals, depth = relief
    found = bilateral_step(normals, depth, width)
    exact = slow_step(normals, depth, width, kernel=gaussian)
    error = angles(found, exact)[normals.any(axis=0)]
    # 1 % of a Gaussian's mass lies beyond; the normals' noise is 8°, the waves' slopes 27°.
    assert np.quantile(error, 0.9) < np.radians(1)
    assert error.max() < np.radians(3)


@pytest.mark.parametrize(("finer", "width"), [(0, 1), (0, 8.4), (0, 1e3), (5, 8.5), (3, 1e6)])
def test_wide_gaps_are_climbed_by_rungs(finer, width):
    rungs = _rungs(finer, width)
    assert rungs[-1] == pytest.approx(width, rel=1e-12)
    steps = np.diff([max(finer, 4.0), *rungs]) if width > 4 else []
    assert (np.asarray(steps) > 0).all()
    assert all(b / max(a, 4.0) <= 2.5 + 1e-9 for a, b in pairwise([finer, *rungs]))


def test_nothing_mixes_across_a_step_of_depth(relief):
    normals, depth = relief
    left = depth < 10
    other = np.where(left, normals, -normals)
    # The step is 14 at least; from 4ρ = 12 on the range kernel is zero.
    found, changed = (bilateral_step(n, depth, 3.0) for n in (normals, other))
    np.testing.assert_array_equal(found[:, left], changed[:, left])
    # A plain Gaussian does mix.
    plain, mixed = (bilateral_step(n, 0 * depth, 3.0) for n in (normals, other))
    assert np.abs(plain - mixed)[:, left].max() > 0.5


def test_constant_normals_stay(relief):
    _, depth = relief
    constant = np.broadcast_to(np.float32([[[0.36]], [[0.48]], [[0.8]]]), (3, H, W))
    for width in (1.0, 4.0, 50.0):
        found = bilateral_step(constant, depth, width, smooth=width / 1.4)
        np.testing.assert_allclose(found, constant, atol=1e-6)


@pytest.mark.parametrize("width", [1.0, 1.375, 2.34, 6.76, 40.0])
def test_the_taps_have_the_variance_asked_for(width):
    offsets, weights = bilateral_taps(width)
    second = (weights[:, None] * offsets**2.0).sum(axis=0) / weights.sum()
    np.testing.assert_allclose(second, width**2, rtol=1e-5)


def test_smoothed_pictures_need_few_taps():
    for width in (5.0, 50.0, 500.0):
        assert len(bilateral_taps(1.375 * width, smooth=width)[0]) < 350
    offsets, _ = bilateral_taps(11.0, smooth=8.0)
    assert (offsets % 4 == 0).all()


def test_few_taps_lose_little(relief):
    normals, _ = relief
    flat = np.zeros((H, W), np.float32)
    normals = bilateral_step(normals, flat, 5.0)
    there = normals.any(axis=0)
    few = bilateral_step(normals, flat, 6.9, smooth=5.0)
    all_taps = bilateral_step(normals, flat, 6.9)
    # Away from borders σ/2 loses nothing; at them a row of taps is in or out.
    # (this picture is all border).
    assert np.quantile(angles(few, all_taps)[there], 0.9) < np.radians(1)
    assert angles(few, all_taps)[there].max() < np.radians(3)


def test_normals_that_cancel_are_kept():
    normals = np.zeros((3, 1, 2), np.float32)
    normals[2, 0] = 1, -1
    found = bilateral_step(normals, np.zeros((1, 2), np.float32), 1e4)
    np.testing.assert_array_equal(found, normals)
