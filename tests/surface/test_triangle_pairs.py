"""An atlas in which every triangle has a place of its own."""

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.errors import MeshdepictError
from meshdepict.surface.texels import TexelGrid
from meshdepict.surface.triangle_pairs import LEAST_CELL, paired


def owners(texcoords, size):
    found = TexelGrid(texcoords, size, closed=True).texels(0, size)
    grid = np.full(size * size, -1)
    grid[found.place] = found.triangle
    return grid.reshape(size, size)


@pytest.fixture(scope="module")
def ball():
    return samples.golf_ball(800)


@pytest.mark.parametrize("size", [256, 500, 1024])
def test_no_two_triangles_touch(ball, size):
    texcoords = paired(ball.unit_points, ball.faces, size)
    grid = owners(texcoords, size)
    assert set(np.unique(grid)) - {-1} == set(range(len(ball.faces)))
    for down, across in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here, there = grid, np.roll(grid, (-down, -across), (0, 1))
        inner = np.s_[1:-1, 1:-1]
        apart = (here == there) | (here < 0) | (there < 0)
        assert apart[inner].all()


def test_places_face_the_way_the_triangles_do_and_lie_within_the_square(ball):
    texcoords = paired(ball.unit_points, ball.faces, 700)
    one, other = np.moveaxis(texcoords[:, 1:] - texcoords[:, :1], 1, 0)
    assert (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] > 0).all()
    assert texcoords.min() > 0
    assert texcoords.max() < 1


def test_the_right_angle_is_opposite_to_the_longest_side(ball):
    texcoords = paired(ball.unit_points, ball.faces, 700)
    corners = ball.unit_points[ball.faces]

    def longest(places):
        return np.linalg.norm(places - np.roll(places, -1, axis=1), axis=2).argmax(axis=1)

    assert np.array_equal(longest(texcoords), longest(corners))


def test_larger_triangles_have_larger_places():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [5.1, 0, 0], [5, 0.1, 0]])
    faces = np.array([[3, 4, 5], [0, 1, 2], [3, 4, 5], [0, 1, 2]])
    counts = TexelGrid(paired(points, faces, 256), 256, closed=True).claims(0, 256).counts
    assert counts[1] == counts[3]
    assert counts[0] == counts[2]
    assert counts[1] > 20 * counts[0]


def test_triangles_without_area_have_places_too():
    faces = np.array([[0, 0, 0], [0, 1, 1], [0, 1, 2]])
    texcoords = paired(np.eye(3), faces, 64)
    assert (TexelGrid(texcoords, 64, closed=True).claims(0, 64).counts >= 3).all()
    flat = paired(np.zeros((3, 3)), faces, 64)
    assert (TexelGrid(flat, 64, closed=True).claims(0, 64).counts >= 3).all()


def test_more_triangles_than_have_room_are_refused_with_a_size_that_holds_them():
    most = 2 * (64 // LEAST_CELL) ** 2
    faces = np.tile([[0, 1, 2]], (most, 1))
    assert np.isfinite(paired(np.eye(3), faces, 64)).all()
    more = np.concatenate([faces, faces[:1]])
    with pytest.raises(MeshdepictError, match=r"no room on 64 x 64 texels: take --size 128"):
        paired(np.eye(3), more, 64)
    assert np.isfinite(paired(np.eye(3), more, 128)).all()
