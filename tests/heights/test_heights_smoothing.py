"""Gaussians over rasters: SciPy's at every width, and windows that give the whole's bits."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from meshdepict.heights.smoothing import alignment, blurred, halo


@pytest.mark.parametrize("width", [0.6, 1.0, 2.7, 4.4, 4.5, 6.1, 9.0, 13.0, 40.0])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_any_width_gives_the_long_sums(width, tolerance):
    block = np.random.default_rng(1).normal(size=(2, 61, 83))
    found = blurred(block, width, np.array([width]), tolerance=tolerance)
    for channel, exact in zip(found, block, strict=True):
        exact = gaussian_filter(exact, width, mode="reflect", truncate=9)
        assert np.abs(channel - exact).max() < tolerance * np.ptp(block)


@pytest.mark.parametrize("shape", [(1, 40), (40, 1), (1, 1), (3, 2)])
@pytest.mark.parametrize("width", [0.5, 3.0, 11.0])
def test_rasters_that_are_narrow_keep_a_constant(shape, width):
    found = blurred(np.full((1, *shape), 7.0), width, np.array([width]), tolerance=1e-4)
    np.testing.assert_allclose(found, 7.0, rtol=1e-5)


def test_a_width_beyond_the_raster_gives_its_mean():
    block = np.random.default_rng(2).normal(size=(1, 30, 20))
    found = blurred(block, 1e7, np.array([1e7]), tolerance=1e-6)
    np.testing.assert_allclose(found, block.mean(), atol=1e-6)


@pytest.mark.parametrize("width", [1.5, 5.0, 12.0, 23.0])
def test_a_window_gives_the_bits_of_the_whole(width):
    block = np.random.default_rng(3).normal(size=(1, 400, 420)).astype(np.float32)
    whole = blurred(block, width, np.array([width]), tolerance=1e-4)
    step = alignment(width)
    around = -(-halo(width, 1e-4) // step) * step
    top, left = 16 * step, 12 * step
    a, b = max(top - around, 0), max(left - around, 0)
    part = blurred(
        block[:, a : top + 40 + around, b : left + 50 + around], width, np.array([width]),
        tolerance=1e-4,
    )  # fmt: skip
    inside = part[:, top - a : top - a + 40, left - b : left - b + 50]
    assert np.array_equal(inside, whole[:, top : top + 40, left : left + 50])


def test_rows_may_have_widths_of_their_own():
    block = np.random.default_rng(4).normal(size=(1, 50, 60))
    across = np.linspace(1, 2, 50)
    found = blurred(block, 1.5, across, tolerance=1e-6)
    down = gaussian_filter(block[0], (1.5, 0), mode="reflect", truncate=9)
    for row in (0, 20, 49):
        exact = gaussian_filter(down[row], across[row], mode="reflect", truncate=9)
        np.testing.assert_allclose(found[0, row], exact, atol=1e-6)


@pytest.mark.parametrize("width", [1.5, 12.0])
def test_a_window_of_rows_of_their_own_widths_gives_the_bits_of_the_whole(width):
    block = np.random.default_rng(5).normal(size=(1, 300, 220)).astype(np.float32)
    across = width * np.linspace(1, 1.6, 300)
    words = {"tolerance": 1e-4, "narrowest": width}
    whole = blurred(block, width, across, **words)
    step = alignment(width)
    around = -(-halo(1.6 * width, 1e-4, width) // step) * step
    top = 25 * step
    a = max(top - around, 0)
    part = blurred(block[:, a : top + 40 + around], width, across[a : top + 40 + around], **words)
    assert np.array_equal(part[:, top - a : top - a + 40], whole[:, top : top + 40])
