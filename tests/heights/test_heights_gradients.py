"""Gradients of heights: exact on planes up to every border and gap."""

import numpy as np
import pytest

from meshdepict.heights.gradients import gradients

STEPS = np.array([[[2.0, 0.0], [0.0, -3.0]]])


def plane(rows, columns, steps):
    row, column = np.mgrid[:rows, :columns].astype(float)
    east = steps[0, 0, 0] * column + steps[0, 0, 1] * row
    north = steps[0, 1, 0] * column + steps[0, 1, 1] * row
    return 0.3 * east - 0.7 * north + 5


@pytest.mark.parametrize("turn", [0.0, 25.0, 180.0])
def test_a_plane_has_one_gradient_up_to_its_border(turn):
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    steps = np.array([[[2 * c, 3 * s], [2 * s, -3 * c]]])
    found, known = gradients(plane(7, 9, steps), np.ones((7, 9), bool), steps)
    np.testing.assert_allclose(found[0], 0.3, rtol=1e-6)
    np.testing.assert_allclose(found[1], -0.7, rtol=1e-6)
    assert known.all()


def test_a_plane_has_its_gradient_beside_gaps_wherever_it_has_one():
    valid = np.random.default_rng(0).random((40, 50)) > 0.3
    z = np.where(valid, plane(40, 50, STEPS), 0)
    found, known = gradients(z, valid, STEPS)
    np.testing.assert_allclose(found[0][known], 0.3, rtol=1e-5)
    np.testing.assert_allclose(found[1][known], -0.7, rtol=1e-5)
    assert 0.5 < known.sum() / valid.sum() < 1
    assert not (known & ~valid).any()


def test_a_raster_of_one_row_rises_along_it():
    found, known = gradients(plane(1, 9, STEPS), np.ones((1, 9), bool), STEPS)
    np.testing.assert_allclose(found[0], 0.3, rtol=1e-6)
    assert not found[1].any()
    assert known.all()


def test_rows_in_degrees_have_steps_of_their_own():
    steps = np.repeat(STEPS, 5, axis=0)
    steps[:, 0, 0] *= [1, 2, 3, 4, 5]
    z = np.tile(np.arange(6.0), (5, 1))
    found, _ = gradients(z, np.ones((5, 6), bool), steps)
    np.testing.assert_allclose(found[0], np.repeat(1 / steps[:, :1, 0], 6, axis=1), rtol=1e-6)


def test_heights_in_single_precision_differ_in_double():
    z = (1e6 + 0.5 * np.arange(5.0))[None].astype(np.float32)
    found, _ = gradients(z, np.ones((1, 5), bool), STEPS)
    np.testing.assert_allclose(found[0], 0.25, rtol=1e-6)
