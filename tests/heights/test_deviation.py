"""Topographic position: windows by their definition, far from zero, in parts, and where level."""

from __future__ import annotations

import numpy as np
import pytest
from grounds import AXES, plane

from meshdepict.heights.deviation import deviations


def by_definition(z: np.ndarray, valid: np.ndarray, radius: int) -> np.ndarray:
    found = np.zeros(z.shape)
    for r, c in zip(*np.nonzero(valid), strict=True):
        window = np.s_[max(r - radius, 0) : r + radius + 1, max(c - radius, 0) : c + radius + 1]
        near = z[window][valid[window]]
        if near.std() > 0:
            found[r, c] = (z[r, c] - near.mean()) / near.std()
    return found


@pytest.mark.parametrize("radius", [1, 2, 3, 7, 20, 60, 10**9])
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_deviations_are_those_of_the_window(
    radius: int, offset: float, rng: np.random.Generator
) -> None:
    z = rng.normal(0, 1, (37, 53)).cumsum(0) + offset
    for valid in (rng.random(z.shape) > 0.3, np.ones(z.shape, bool)):
        # A variance of 1 among squares of 100: rounding of 1e-14, and of single precision.
        expected = by_definition(z - offset, valid, min(radius, 99))
        np.testing.assert_allclose(deviations(z, valid, radius), expected, atol=1e-6)
    np.testing.assert_array_equal(
        deviations(z, None, radius), deviations(z, np.ones(z.shape, bool), radius)
    )


@pytest.mark.parametrize("radius", [1, 4, 9])
def test_a_part_with_a_rim_has_the_numbers_of_the_whole(
    radius: int, rng: np.random.Generator
) -> None:
    z = rng.normal(0, 1, (60, 50)).cumsum(0)
    valid = rng.random(z.shape) > 0.2
    whole = deviations(z, valid, radius)
    for top, left in ((0, 0), (7, 5), (11, 20)):
        part = np.s_[top : top + 40, left : left + 30]
        found = deviations(z[part], valid[part], radius)
        inner = np.s_[radius:-radius, radius:-radius]
        np.testing.assert_array_equal(found[inner], whole[part][inner])


def test_level_ground_deviates_from_nothing_and_a_plane_in_its_middle_neither() -> None:
    assert not deviations(np.full((20, 30), 1234.567), None, 4).any()
    z = plane(AXES["turned"], (30, 30), 0.3, 0.2)
    np.testing.assert_allclose(deviations(z, None, 4)[4:-4, 4:-4], 0, atol=1e-6)


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1)])
def test_a_row_has_windows_along_itself(shape: tuple[int, int], rng: np.random.Generator) -> None:
    z = rng.normal(0, 1, shape)
    expected = by_definition(z, np.ones(shape, bool), 2)
    np.testing.assert_allclose(deviations(z, None, 2), expected, atol=1e-6)


def test_single_and_double_heights_agree_and_taller_ones_deviate_as_much(
    rng: np.random.Generator,
) -> None:
    z = rng.normal(0, 1, (40, 40)).astype(np.float32)
    found = deviations(z, None, 3)
    np.testing.assert_allclose(found, deviations(z.astype(float), None, 3), atol=1e-6)
    np.testing.assert_allclose(deviations(7 * z, None, 3), found, atol=1e-5)
