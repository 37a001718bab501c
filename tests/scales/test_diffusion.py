"""Anisotropic diffusion: a Gaussian where nothing stops it, and what stops it."""

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from meshdepict.scales.diffusion import STEP, diffuse, diffusion_width

H, W = 20, 26


@pytest.fixture
def slopes(rng):
    return rng.normal(size=(2, H, W)).astype(np.float32)


OPEN = np.ones((H, W), np.float32)


def one_step(g, c, dt):
    """The equation to the letter, pixel by pixel."""
    after = g.copy()
    for y, x in np.ndindex(c.shape):
        for v, u in ((y - 1, x), (y + 1, x), (y, x - 1), (y, x + 1)):
            if 0 <= v < H and 0 <= u < W:
                after[:, y, x] += dt * min(c[y, x], c[v, u]) * (g[:, v, u] - g[:, y, x])
    return after


def test_steps_are_the_equation(slopes, rng):
    c = rng.random((H, W)).astype(np.float32)
    expected = slopes.astype(float)
    for _ in range(3):
        expected = one_step(expected, c, STEP)
    np.testing.assert_allclose(diffuse(slopes, c, diffusion_width(3)), expected, atol=1e-6)


@pytest.mark.parametrize("iterations", [1, 7, 30])
def test_steps_and_width_say_the_same(iterations):
    assert diffusion_width(iterations) == pytest.approx(math.sqrt(0.4 * iterations))


@pytest.mark.parametrize("width", [1.5, 3.0])
def test_unstopped_it_is_a_gaussian(rng, width):
    image = gaussian_filter(rng.normal(size=(60, 60)), 2)[None].astype(np.float32)
    found = diffuse(image, np.ones((60, 60), np.float32), width)
    exact = gaussian_filter(image[0], width, mode="reflect", truncate=6)
    # Four neighbours and few steps against the continuous equation.
    assert np.abs(found[0] - exact).max() < 0.01 * np.abs(image).max()


def test_the_mean_stays(slopes, rng):
    c = rng.random((H, W)).astype(np.float32)
    np.testing.assert_allclose(
        diffuse(slopes, c, 4.0).mean(axis=(1, 2)), slopes.mean(axis=(1, 2)), atol=1e-6
    )


def test_constant_slopes_stay(rng):
    c = rng.random((H, W)).astype(np.float32)
    constant = np.full((2, H, W), 3.5, np.float32)
    np.testing.assert_array_equal(diffuse(constant, c, 5.0), constant)


def test_nothing_crosses_a_line_without_conductance(slopes):
    c = OPEN.copy()
    c[:, 12] = 0
    other = slopes.copy()
    other[:, :, 13:] = 100
    one, two = diffuse(slopes, c, 6.0), diffuse(other, c, 6.0)
    np.testing.assert_array_equal(one[:, :, :12], two[:, :, :12])
    np.testing.assert_array_equal(one[:, :, 12], slopes[:, :, 12])


def test_importance_chooses_how_far_each_pixel_goes(slopes, rng):
    whole = diffusion_width(8)
    same = diffuse(slopes, OPEN, whole, importance=np.zeros((H, W), np.float32))
    np.testing.assert_array_equal(same, diffuse(slopes, OPEN, whole))
    kept = diffuse(slopes, OPEN, whole, importance=OPEN)
    np.testing.assert_array_equal(kept, slopes)
    share = rng.choice(np.float32([0, 0.25, 0.75, 1]), (H, W))
    mixed = diffuse(slopes, OPEN, whole, importance=share)
    for value, steps in ((0, 8), (0.25, 6), (0.75, 2)):
        here = share == value
        fewer = diffuse(slopes, OPEN, diffusion_width(steps))
        np.testing.assert_allclose(mixed[:, here], fewer[:, here], atol=1e-6)
    np.testing.assert_array_equal(mixed[:, share == 1], slopes[:, share == 1])


def test_one_pixel_stays():
    pixel = np.full((2, 1, 1), 0.5, np.float32)
    np.testing.assert_array_equal(diffuse(pixel, np.ones((1, 1), np.float32), 9.0), pixel)
