"""Terrain raised by a factor, and which of its cells lies at a place."""

import numpy as np
import pytest
from grounds import AXES

import meshdepict as md

NORTH = (0.5, 0, 100, 0, -0.25, 50)  # in degrees


def field(**given):
    z = np.arange(24.0).reshape(4, 6)
    z[1, 2] = np.nan
    return md.HeightField(z, **given)


def test_a_raised_field_knows_its_factor_and_the_ground_before():
    ground = field()
    assert (ground.z_factor, ground.before) == (1, None)
    raised = ground.raised(2).raised(1.5)
    assert raised.z_factor == 3
    assert raised.before is ground
    np.testing.assert_array_equal(raised.z, 3 * ground.z)
    np.testing.assert_array_equal(raised.valid, ground.valid)
    assert ground.raised(1) is ground


def test_a_window_of_a_raised_field_is_the_raised_window():
    part = (slice(1, 4), slice(2, 5))
    window = field().raised(4).window(*part)
    assert window.z_factor == 4
    np.testing.assert_array_equal(window.points, field().window(*part).raised(4).points)
    np.testing.assert_array_equal(window.before.points, field().window(*part).points)


@pytest.mark.parametrize("name", [*AXES, "degrees", "feet"])
def test_the_cell_at_a_sample_is_its_own(name):
    if name == "degrees":
        given = {"transform": NORTH, "degrees": True}
    elif name == "feet":
        given = {"transform": (10, 0, 1e6, 0, -10, 2e6), "unit": 0.3048}
    else:
        (a, b), (d, e) = AXES[name][0]
        given = {"transform": (a, b, 7, d, e, -3)}
    shape = field(**given)
    rows, columns = shape.cells_at(*shape.points.T[:2])
    expected = np.stack(np.nonzero(shape.valid)) + 0.5
    np.testing.assert_allclose(np.stack([rows, columns]), expected, rtol=0, atol=1e-6)


def test_cells_of_degrees_are_as_wide_as_their_row():
    shape = field(transform=NORTH, degrees=True)
    east = shape.points[:, 0].reshape(-1)
    inside = 0.49 * shape.steps[:, 0, 0]  # metres from a centre to nearly the side
    row = np.nonzero(shape.valid)[0]
    rows, columns = shape.cells_at(east + inside[row], shape.points[:, 1])
    assert (np.floor(columns) == np.nonzero(shape.valid)[1]).all()
    assert (np.floor(rows) == row).all()
