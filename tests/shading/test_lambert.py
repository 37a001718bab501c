import numpy as np
import pytest

from meshdepict import samples, scale_space
from meshdepict.shading import declaration, half_lambert, lambert


@pytest.fixture(scope="module")
def space(sphere):
    return scale_space(sphere, scales=0)


@pytest.mark.parametrize("light", [(0, 0, 1), (1, 0, 0), (-1, 2, -3)])
def test_on_a_sphere_shading_is_the_position_along_the_light(space, sphere, light):
    # The normals of a unit sphere are its points; what is left is single precision.
    along = sphere.vertices @ (np.array(light) / np.linalg.norm(light))
    np.testing.assert_allclose(lambert(space, light), np.maximum(along, 0), atol=3e-7)
    np.testing.assert_allclose(half_lambert(space, light), 0.5 + 0.5 * along, atol=3e-7)


def test_half_of_a_sphere_is_black_and_none_of_it_half_black(space):
    assert (lambert(space, "front") == 0).mean() == pytest.approx(0.5, abs=0.03)
    assert (half_lambert(space, "front") == 0).mean() < 0.01


def test_opposite_lights_give_the_negative_and_share_the_sphere(space, rng):
    light = rng.normal(size=3)
    both = half_lambert(space, light) + half_lambert(space, -light)
    np.testing.assert_allclose(both, 1, atol=2e-7)
    assert not (lambert(space, light) * lambert(space, -light)).any()


def test_more_light_on_a_plane_than_on_the_slope():
    sheet = scale_space(samples.wavy_sheet(400, amplitude=0), scales=0)
    np.testing.assert_array_equal(lambert(sheet, (0, 0, 1)), 1)
    np.testing.assert_allclose(lambert(sheet, (1, 0, 1)), 0.5**0.5, rtol=1e-6)
    np.testing.assert_array_equal(lambert(sheet, (0, 0, -1)), 0)


def test_brighter_light_reaches_white_and_no_further(space, sphere):
    found = lambert(space, "front", exposure=2)
    np.testing.assert_allclose(found, np.clip(2 * sphere.vertices[:, 2], 0, 1), atol=5e-7)


def test_one_is_light_and_the_other_is_for_looking_at():
    assert declaration(lambert).linear
    assert not declaration(half_lambert).linear
    assert declaration(lambert).scales == declaration(half_lambert).scales == 0
