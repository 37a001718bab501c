"""Cells of a raster: steps in metres from six numbers, and what they can't be."""

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.heights.cells import METRES_PER_DEGREE, checked_transform, metric_steps

NORTH_UP = (2.0, 0.0, 10.0, 0.0, -3.0, 50.0)


def test_steps_of_a_raster_in_metres_are_those_of_its_transform():
    (steps,) = metric_steps(NORTH_UP, 4, degrees=False, unit=1.0)
    assert steps.tolist() == [[2, 0], [0, -3]]


def test_feet_become_metres():
    (steps,) = metric_steps(NORTH_UP, 4, degrees=False, unit=0.3048)
    np.testing.assert_allclose(steps, np.array([[2, 0], [0, -3]]) * 0.3048)


def test_a_degree_of_longitude_shrinks_with_the_cosine_of_the_latitude_of_its_row():
    steps = metric_steps((0.5, 0, 8, 0, -0.5, 60.25), 2, degrees=True, unit=1.0)
    along = np.hypot(steps[:, 0, 0], steps[:, 1, 0])
    np.testing.assert_allclose(along, 0.5 * METRES_PER_DEGREE * np.cos(np.radians([60, 59.5])))
    np.testing.assert_allclose(steps[:, 1, 1], -0.5 * METRES_PER_DEGREE)


@pytest.mark.parametrize(
    ("transform", "said"),
    [
        ((1, 2, 3), "not six finite numbers"),
        ((1, 0, 0, 0, np.nan, 0), "not six finite numbers"),
        ("north", "not six finite numbers"),
        ((0, 0, 0, 0, -1, 0), "no area"),
        ((1, 0.5, 0, 0, -1, 0), "sheared"),
    ],
)
def test_transforms_that_place_no_cells_are_refused(transform, said):
    with pytest.raises(MeshdepictError, match=said):
        checked_transform(transform)


def test_a_turned_raster_is_not_sheared():
    turn = np.radians(30)
    c, s = np.cos(turn), np.sin(turn)
    assert checked_transform((2 * c, 3 * s, 0, 2 * s, -3 * c, 0))


@pytest.mark.parametrize(
    ("transform", "said"),
    [
        ((0.1, 0.1, 0, 0.1, -0.1, 0), "turned against north"),
        ((30.0, 0, 500_000, 0, -30.0, 5_000_000), "latitudes"),
    ],
)
def test_degrees_that_are_none_are_refused(transform, said):
    with pytest.raises(MeshdepictError, match=said):
        metric_steps(transform, 3, degrees=True, unit=1.0)


def test_rows_at_the_poles_have_steps():
    steps = metric_steps((1, 0, -0.5, 0, -1, 90.5), 181, degrees=True, unit=1.0)
    along = steps[:, 0, 0]
    assert (along > 0).all()
    assert along[0] == pytest.approx(along[-1])
    assert along.max() == pytest.approx(METRES_PER_DEGREE)
