"""Which pixels count: occluding contours in depth images of known surfaces."""

import numpy as np
import pytest

from meshdepict.congruence.contours import connected, mean_slopes, whole_windows


def parted(depth, mask=None):
    """How many pairs are parted, along x and along y."""
    depth = np.asarray(depth, float)
    mask = np.ones(depth.shape, bool) if mask is None else mask
    across, down = connected(depth, mask, 1), connected(depth, mask, 0)
    pairs = mask[:, 1:] & mask[:, :-1], mask[1:] & mask[:-1]
    return (pairs[0] & ~across).sum(), (pairs[1] & ~down).sum()


def grid(height=120, width=140):
    y, x = np.mgrid[:height, :width].astype(float)
    return x, y


def ball(radius, x, y):
    """A sphere's depth, NaN beside it."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(radius**2 - (x - 70.3) ** 2 - (y - 60.1) ** 2)


@pytest.mark.parametrize("scale", [1, 1e-6, -1e9])
def test_the_rim_of_a_ball_before_a_wall_is_found_and_nothing_else(scale):
    x, y = grid()
    seen = ball(40, x, y)
    inside = np.isfinite(seen)
    depth = scale * np.where(inside, seen, -200 + 0.3 * x)
    everywhere = np.ones_like(inside)
    np.testing.assert_array_equal(connected(depth, everywhere, 1), inside[:, 1:] == inside[:, :-1])
    np.testing.assert_array_equal(connected(depth, everywhere, 0), inside[1:] == inside[:-1])


@pytest.mark.parametrize("radius", [20, 45.5, 59])
def test_a_ball_is_one_surface_up_to_its_rim(radius):
    seen = ball(radius, *grid())
    assert parted(np.nan_to_num(seen), np.isfinite(seen)) == (0, 0)


def test_smooth_rough_and_folded_surfaces_have_no_contour(rng):
    x, y = grid()
    assert parted(5 * np.sin(x / 2) + np.cos(y)) == (0, 0)
    assert parted(100 * np.exp(-((x - 70) ** 2 + (y - 60) ** 2) / 18)) == (0, 0)  # one steep bump
    assert parted(np.where(x < 70, 0, 20 * (x - 70)) + 0.1 * y) == (0, 0)  # a crease
    assert parted((x + y) % 2) == (0, 0)
    assert sum(parted(rng.normal(size=x.shape))) <= 0.001 * x.size
    assert parted(np.full(x.shape, 3.0)) == (0, 0)


def test_a_hair_before_a_wall_has_two_contours():
    x, y = grid()
    assert parted(0.2 * x + 0.1 * y + 50 * (x == 20)) == (240, 0)


def test_a_step_beyond_the_mask_explains_and_parts_nothing():
    x, _ = grid(30, 40)
    depth = np.where(x < 20, x, x + 1e6)
    assert parted(depth, x < 20) == (0, 0)
    assert parted(np.zeros((3, 3)), np.eye(3) > 0) == (0, 0)


def test_whole_windows_are_those_that_loops_find(rng):
    mask = np.ones((30, 34), bool)
    mask[4, 5] = mask[-1, 20] = False
    across, down = np.ones((30, 33), bool), np.ones((29, 34), bool)
    across[17, 26] = down[22, 9] = False
    expected = np.zeros_like(mask)
    for row in range(3, 27):
        for column in range(3, 31):
            rows, columns = slice(row - 3, row + 4), slice(column - 3, column + 4)
            # A contour passes between two pixels: the window must hold neither.
            expected[row, column] = mask[rows, columns].all() and not (
                (abs(row - 17) <= 3 and -3 <= column - 26 <= 4)
                or (-3 <= row - 22 <= 4 and abs(column - 9) <= 3)
            )
    given = mask.copy()
    np.testing.assert_array_equal(whole_windows(mask, across, down, reach=3), expected)
    np.testing.assert_array_equal(mask, given)


def test_slopes_are_those_of_each_surface_beside_a_contour():
    x, y = grid(20, 30)
    depth = np.where(x < 12, 0.5 * x - 0.25 * y, 90 - 0.125 * x - 0.25 * y)
    mask = np.ones(x.shape, bool)
    slopes = mean_slopes(depth, connected(depth, mask, 1), connected(depth, mask, 0))
    np.testing.assert_allclose(slopes[0], np.where(x < 12, 0.5, -0.125), atol=1e-12)
    np.testing.assert_allclose(slopes[1], -0.25, atol=1e-12)


def test_a_pixel_without_neighbours_is_level():
    alone = np.eye(3) > 0
    slopes = mean_slopes(np.eye(3), connected(np.eye(3), alone, 1), connected(np.eye(3), alone, 0))
    assert not np.any(slopes)
