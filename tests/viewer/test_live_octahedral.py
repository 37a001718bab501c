"""Packed normals: the stated error, exact axes, and numbers that float32 holds."""

import numpy as np
import pytest
from conftest import angle_between

from meshdepict.viewer.live.octahedral import (
    fold,
    most_sets,
    pack_normals,
    unfold,
    unpacking,
)

STATED = 4.4e-5  # radians, in the module's docstring


def directions(rng, count):
    n = rng.normal(size=(count, 3))
    return (n / np.linalg.norm(n, axis=1, keepdims=True)).astype(np.float32)


def unpack(packed):
    """The readable twin of the GLSL: three sets of places from four numbers."""
    upper, lower = np.divmod(packed.astype(np.int64), 256)
    third = np.stack((256 * lower[:, 0] + lower[:, 1], 256 * lower[:, 2] + lower[:, 3]), axis=1)
    return upper[:, :2], upper[:, 2:], third


def test_the_error_is_the_stated_one(rng):
    n = directions(rng, 500_000)
    turned = angle_between(unfold(fold(n)), n.astype(float) / np.linalg.norm(n, axis=1)[:, None])
    # Half a million find nearly the largest; float32 normals themselves are off by 1e-7.
    assert 4.2e-5 < turned.max() < STATED
    assert np.sqrt((turned**2).mean()) == pytest.approx(2.3e-5, abs=1e-6)


def test_with_more_bits_the_shader_s_own_rounding_is_left(rng):
    """The GLSL in single precision, line by line."""
    n = directions(rng, 200_000)
    one = np.float32(1)
    p = fold(n, bits=24) / np.float32(2**23 - 1) - one
    z = one - np.abs(p).sum(axis=1, keepdims=True)
    below = np.maximum(-z, 0)
    found = np.concatenate((np.where(p < 0, p + below, p - below), z), axis=1)
    assert found.dtype == np.float32
    found = found.astype(float) / np.linalg.norm(found.astype(float), axis=1, keepdims=True)
    exact = n.astype(float) / np.linalg.norm(n.astype(float), axis=1, keepdims=True)
    assert 1e-8 < angle_between(found, exact).max() < 4.2e-7


def test_no_other_place_around_is_nearer(rng):
    n = directions(rng, 2_000)
    best = angle_between(unfold(fold(n)), n)
    for step in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)):
        other = angle_between(unfold(fold(n) + step), n)
        # Next to the square's edges a step leaves the octahedron; those are farther in any case.
        assert (best <= other + 2e-7).all()


def test_axes_and_edges_of_the_fold_are_exact():
    n = np.concatenate((np.eye(3), -np.eye(3)))
    assert (unfold(fold(n)) == n).all()
    diagonal = np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]) / np.sqrt(2)
    assert angle_between(unfold(fold(diagonal)), diagonal).max() < STATED


def test_signed_zeros_and_no_normal_at_all_stay_finite():
    n = np.array([[0.0, -0.0, -1], [-0.0, 0.0, -1], [-0.0, -0.0, 1], [0, 0, 0]])
    found = unfold(fold(n))
    assert np.isfinite(found).all()
    assert (found[:3, 2] == n[:3, 2]).all()


@pytest.mark.parametrize("sets", [1, 2, 3, 4, 14])
def test_three_sets_share_an_attribute_exactly(rng, sets):
    normals = np.array([directions(rng, 500) for _ in range(sets)])
    packed = pack_normals(normals)
    assert len(packed) == -(-sets // 3)
    places = [place for numbers in packed for place in unpack(numbers)]
    for one, place in zip(normals, places, strict=False):
        assert (place == fold(one)).all()
    for numbers in packed:
        assert numbers.dtype == np.float32
        assert numbers.shape == (500, 4)
        assert ((numbers >= 0) & (numbers < 2**24) & (numbers == np.rint(numbers))).all()


@pytest.mark.parametrize("sets", [1, 2, 5])
def test_two_sets_share_an_attribute_with_more_bits(rng, sets):
    normals = np.array([directions(rng, 500) for _ in range(sets)])
    packed = pack_normals(normals, bits=24)
    assert len(packed) == -(-sets // 2)
    places = [place for numbers in packed for place in (numbers[:, :2], numbers[:, 2:])]
    for one, place in zip(normals, places, strict=False):
        assert (place == fold(one, bits=24)).all()
        assert ((place >= 0) & (place < 2**24)).all()


def test_fourteen_sets_fit_with_room_to_spare():
    assert unpacking(14).count("in vec4") == 5
    assert unpacking(14, bits=24).count("in vec4") == 7
    assert unpacking(most_sets(24), bits=24).count("in vec4") == 15
    assert unpacking(most_sets(16)).count("in vec4") == 15  # and the position is the sixteenth


def test_normals_are_not_modified(rng):
    normals = directions(rng, 100)[None]
    before = normals.copy()
    normals.setflags(write=False)
    pack_normals(normals)
    assert (normals == before).all()
