"""The procedural terrain has what it promises, where it says, at any number of cells."""

import numpy as np
import pytest

from meshdepict import HeightField, MeshdepictError, samples
from meshdepict.samples.landscape import BANK, MOUND, SIDE, TERRACES


def test_the_ground_is_four_hundred_metres_wide_whatever_its_cells():
    for size in ((400, 400), (37, 91), (2, 2)):
        field = samples.terrain(size)
        assert isinstance(field, HeightField)
        assert field.size == size
        along, down = field.spacing
        assert (along * size[0], down * size[1]) == pytest.approx((SIDE, SIDE))
        assert field.whole
        assert field.crs == ""


def test_cells_have_the_heights_of_their_centres():
    field = samples.terrain((50, 30))
    x, y, z = field.points.T
    np.testing.assert_array_equal(z, samples.terrain_height(x, y).astype(np.float32))


def test_it_is_the_same_every_time():
    first, second = samples.terrain((60, 40)), samples.terrain((60, 40))
    assert first.z.tobytes() == second.z.tobytes()
    assert first.identity == second.identity


def test_ground_falls_by_less_than_its_cells_jump_nowhere():
    """Without a cliff: halving the cells halves the largest difference between neighbours."""
    steps = [np.abs(np.diff(samples.terrain((n, n)).z.astype(float), axis=0)).max()
             for n in (800, 1600)]  # fmt: skip
    assert steps[1] == pytest.approx(steps[0] / 2, rel=0.05)


def test_the_mound_stands_above_what_is_around_it():
    (east, north), height, ditch = MOUND
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)

    def ring(radius):
        x, y = east + radius * np.cos(turn), north + radius * np.sin(turn)
        return samples.terrain_height(x, y).mean()

    # Means over a ring: the swells of the ground nearly cancel, a quarter of the mound's height.
    assert ring(0) - ring(22) == pytest.approx(height, abs=0.2)
    assert ring(22) - ring(15) == pytest.approx(ditch, abs=0.1)


def test_the_river_is_the_lowest_of_every_cross_section_and_terraces_rise_from_it():
    field = samples.terrain((200, 200))
    lowest = np.argmin(field.z, axis=0)
    _, north = field.place(lowest + 0.0, np.arange(200.0))
    middle = 120 + 28 * np.sin(2 * np.pi * np.arange(1, 401, 2) / 290 + 0.6)
    np.testing.assert_allclose(north, middle, atol=2.5)  # a cell's half, and the ground's swells
    x = np.linspace(20, 380, 200)
    bed = np.interp(x, np.arange(1, 401, 2), north)
    for begin, height in TERRACES:
        above, below = (samples.terrain_height(x, bed + begin + off).mean() for off in (8, -3))
        assert above - below == pytest.approx(height, abs=0.3)


def test_banks_stand_round_fields_on_the_upper_terrace_alone():
    """Of cells of a quarter metre, those higher than the mean of 9 m around them."""
    from scipy.ndimage import uniform_filter

    z = samples.terrain((1600, 1600)).z.astype(float)
    above = z - uniform_filter(z, 36)
    x, y = (np.arange(1600) + 0.5) / 4, (SIDE - (np.arange(1600) + 0.5) / 4)[:, None]
    away = y - (120 + 28 * np.sin(2 * np.pi * x / 290 + 0.6))  # from the river
    inside = (np.abs(x - SIDE / 2) < 190) & (y < 390)
    upper = above[inside & (away > 110)]
    assert 0.6 * BANK < upper.max() < MOUND[1]
    assert 0.03 < (upper > BANK / 2).mean() < 0.2
    lower = above[inside & (away > 47) & (away < 75)]  # 4.5 m and more from either step
    assert lower.max() < BANK / 4


@pytest.mark.parametrize("size", [(1, 5), (5, 40_001), (5,), 5, (5.5, 5), "wide"])
def test_a_wrong_size_is_refused(size):
    with pytest.raises(MeshdepictError, match="terrain: size="):
        samples.terrain(size)
