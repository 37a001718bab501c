"""Local dominance: level and sloping planes, towers, the toolbox's rule by hand, and no-data."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meshdepict.heights.dominance import dominances


def by_shifts(z: np.ndarray, nearest: int, farthest: int, observer: float) -> np.ndarray:
    """As the Relief Visualization Toolbox: whole rasters moved along every direction."""
    total, norm = np.zeros(z.shape), 0.0
    for degrees in range(0, 360, 15):
        for far in range(nearest, farthest + 1):
            by = (
                round(math.sin(math.radians(degrees)) * far),
                round(math.cos(math.radians(degrees)) * far),
            )
            below = np.maximum(z + observer - np.roll(z, by, axis=(0, 1)), 0)
            total += below / far * (2 * far + 1)
            norm += observer / far * (2 * far + 1)
    return total / norm


def test_dominance_is_that_of_the_toolbox(rng: np.random.Generator) -> None:
    z = rng.normal(0, 1, (50, 60)).cumsum(0).cumsum(1)
    expected = by_shifts(z, 3, 8, 1.7)
    found = dominances(z, None, nearest=3, farthest=8)
    np.testing.assert_allclose(found[8:-8, 8:-8], expected[8:-8, 8:-8], rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_level_land_is_one_everywhere(offset: float) -> None:
    np.testing.assert_allclose(dominances(np.full((30, 40), offset), None), 1, atol=1e-5)


def test_a_tower_looks_down_in_proportion_to_its_height() -> None:
    z = np.zeros((60, 60))
    z[30, 30] = 5.1  # three observers high
    found = dominances(z, None)
    np.testing.assert_allclose(found[30, 30], 4, rtol=1e-5)
    # Others look up to it, if at all, and see all the rest.
    np.testing.assert_allclose(found[0, 0], 1, atol=1e-5)
    assert 0.9 < found[30, 15] < 0.999


def test_what_holds_no_height_counts_for_nothing() -> None:
    z = np.zeros((60, 60), np.float32)
    valid = np.ones(z.shape, bool)
    z[:, 35:], valid[:, 35:] = -1000, False
    np.testing.assert_allclose(dominances(z, valid), 1, atol=1e-5)
    alone = np.zeros(z.shape, bool)
    alone[30, 30] = True
    np.testing.assert_array_equal(dominances(z, alone), 1)


@pytest.mark.parametrize("shape", [(1, 50), (50, 1), (1, 1)])
def test_a_row_dominates_along_itself(shape: tuple[int, int]) -> None:
    np.testing.assert_allclose(dominances(np.zeros(shape), None), 1, atol=1e-5)
