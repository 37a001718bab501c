"""The phantom is a head in Hounsfield units whose left, front and top can be told."""

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.samples.phantom import BEADS, ct_phantom


@pytest.fixture(scope="module")
def head():
    return ct_phantom((120, 120, 120))


def at(volume, *place):
    """The value at a place in mm."""
    x, y, z = np.rint((np.array(place) - volume.origin) / volume.spacing).astype(int)
    return volume.values[z, y, x]


def test_it_is_a_box_of_240_mm_about_the_origin_in_hounsfield_units(head):
    assert head.unit == "HU"
    assert head.values.dtype == np.int16
    np.testing.assert_allclose(head.values.shape[::-1] * head.spacing, 240)
    np.testing.assert_allclose(head.centre, 0, atol=1e-12)
    assert head.range == (-1000, 3000)


@pytest.mark.parametrize(
    ("place", "low", "high"),
    [
        ((100, 100, 100), -1000, -1000),  # outside
        ((30, 20, 60), 8, 38),  # brain
        ((0, 8, -60), -1000, -900),  # windpipe
        ((31, -63, 0), 8, 8),  # eye
        ((0, -82, -87), 400, 1300),  # chin
        ((0, 34, -72), 400, 1300),  # a vertebra's middle
        ((30, 45, -90), 50, 60),  # muscle of the neck
    ],
)
def test_tissues_have_their_numbers(head, place, low, high):
    assert low <= at(head, *place) <= high


def test_the_skull_is_bone_all_round_between_skin_and_brain(head):
    centre = np.array((0.0, 8.0, 30.0))
    for direction in ((1, 0, 0.2), (-1, 0, 0.2), (0, 1, 0.3), (0.1, 0.4, 1), (0.5, -1, 0.8)):
        unit = np.array(direction) / np.linalg.norm(direction)
        numbers = np.array([at(head, *(centre + r * unit)) for r in np.arange(40, 96, 0.5)])
        bone = np.flatnonzero(numbers > 300)
        skin = np.flatnonzero(numbers > -500)[-1]
        assert 4 <= 0.5 * len(bone) <= 18  # mm
        assert 3 <= 0.5 * (skin - bone[-1]) <= 12
        assert (numbers[: bone[0] - 6] < 60).all()


def test_beads_tell_left_front_and_top(head):
    beads = head.to_world(np.argwhere(head.values > 2500)[:, ::-1])
    for side, centre in BEADS.items():
        near = beads[np.linalg.norm(beads - centre, axis=1) < 5]
        np.testing.assert_allclose(near.mean(axis=0), centre, atol=1, err_msg=side)
    assert BEADS["left"][0] > 0 > BEADS["front"][1]
    assert BEADS["top"][2] > 0
    assert len(beads) == sum(
        int((np.linalg.norm(beads - centre, axis=1) < 5).sum()) for centre in BEADS.values()
    )


def test_it_is_symmetric_but_for_bead_and_seam(head):
    differs = head.values != head.values[:, :, ::-1]
    x, _, z = head.to_world(np.argwhere(differs)[:, ::-1]).T
    bead = np.abs(np.abs(x) - BEADS["left"][0]) < 6
    assert bead.any()
    assert (np.abs(x[~bead]) < 75).all()
    assert (z[~bead] > 15).all()  # seams are in the vault
    assert 0 < np.count_nonzero(~bead) < 0.005 * head.n_samples


def test_sizes_that_differ_sample_the_same_head(head):
    flat = ct_phantom((120, 60, 40))
    np.testing.assert_allclose(flat.spacing, (2, 4, 6))
    for place in ((0, 0, 60), (40, 20, 30), (-30, 30, 45), (100, -100, 0)):
        assert abs(int(at(flat, *place)) - int(at(head, *place))) <= 30
    share = [np.count_nonzero(v.values > -500) / v.n_samples for v in (head, flat)]
    assert share[1] == pytest.approx(share[0], rel=0.01)
    assert ct_phantom((7, 5, 3)).values.shape == (3, 5, 7)  # odd counts have a middle column


def test_noise_is_white_of_the_asked_width_and_the_same_every_time(head):
    noisy = ct_phantom((120, 120, 120), noise=20)
    difference = (noisy.values - head.values)[head.values > -900].astype(float)
    assert difference.std() == pytest.approx(20, rel=0.01)
    assert abs(difference.mean()) < 0.1
    again = ct_phantom((120, 120, 120), noise=20)
    np.testing.assert_array_equal(again.values, noisy.values)


@pytest.mark.parametrize(
    "wrong", [{"size": (1, 9, 9)}, {"size": (9, 9)}, {"size": (9, 9, 5000)}, {"noise": -1}]
)
def test_arguments_out_of_range_are_refused(wrong):
    with pytest.raises(MeshdepictError, match="ct_phantom: "):
        ct_phantom(**wrong)
