"""Seams, copies, degenerate faces and edges of many faces do no harm to the winding."""

import numpy as np
import pytest
from windings import BALL, CUBE, both, flips, inside_out, moved, scrambled, sheet

# --- seams, copies, degenerate faces --------------------------------------------------------


def soup(mesh):
    """Give every face corners of its own, as STL does."""
    points, faces = mesh
    return points[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


def test_vertices_at_one_position_are_one():
    points, faces = soup(BALL)
    given, which = scrambled(faces)
    np.testing.assert_array_equal(flips((points, given)), which)
    points[points == 0] *= -1  # −0 is 0
    np.testing.assert_array_equal(flips((points, given)), which)


@pytest.mark.parametrize("apart", [True, False])
def test_a_sheet_stored_twice_stays(apart):
    points, faces = sheet(8)
    twice = both((points, faces), (points, faces)) if apart else (points, np.tile(faces, (2, 1)))
    assert not flips(twice).any()
    given = twice[1].copy()
    given[5] = given[5, ::-1]
    assert np.flatnonzero(flips((twice[0], given))).tolist() == [5, 5 + len(faces)]  # together


def test_copies_turn_with_the_face_that_they_equal():
    points, faces = BALL
    again = np.concatenate((faces, faces[7:8, [1, 2, 0]], faces[7:8, ::-1]))  # one the other way
    assert not flips((points, again)).any()
    assert flips((points, again[:, ::-1])).all()


def test_degenerate_faces_do_no_harm():
    points, faces = BALL
    a, b, _ = faces[0]
    middle = len(points)  # a needle on an edge, without area but with three corners
    points = np.concatenate((points, [(points[a] + points[b]) / 2]))
    collapsed = np.array([(a, a, b), (a, a, a), (b, a, b)])
    for given in (np.concatenate((collapsed, faces)), np.concatenate((faces, [(a, b, middle)]))):
        proper = (np.sort(given, axis=1)[:, 1:] != np.sort(given, axis=1)[:, :-1]).all(axis=1)
        proper &= (given != middle).all(axis=1)
        assert not flips((points, given))[proper].any()
        assert flips((points, given[:, ::-1]))[proper].all()
    given = np.concatenate((collapsed, faces[:, ::-1]))
    np.testing.assert_array_equal(flips((points, given)), [False] * 3 + [True] * len(faces))
    assert not flips((points, collapsed)).any()


def test_nothing_and_a_single_face_stay():
    assert flips((np.zeros((1, 3)), np.zeros((0, 3), int))).shape == (0,)
    for corners in (np.eye(3), np.eye(3)[::-1], np.zeros((3, 3))):
        assert not flips((corners, np.array([(0, 1, 2)]))).any()


# --- edges of more than two faces -----------------------------------------------------------


def test_flap_on_an_edge_leaves_the_body_closed():
    points, faces = CUBE
    points = np.concatenate((points, [(0.0, -1.0, 0.5)]))
    flap = np.array([(0, 1, 8)])
    assert not flips((points, np.concatenate((faces, flap)))).any()
    expected = [True] * 12 + [False]
    given = np.concatenate((faces[:, ::-1], flap))
    np.testing.assert_array_equal(flips((points, given)), expected)


@pytest.mark.parametrize("offset", [(1, 1, 0), (1, 1, 1)])
def test_bodies_that_touch_at_an_edge_or_a_corner(offset):
    mesh = both(CUBE, moved(CUBE, offset))
    assert not flips(mesh).any()
    assert flips(inside_out(mesh)).all()
    given, which = scrambled(mesh[1], 0.25, seed=4)
    np.testing.assert_array_equal(flips((mesh[0], given)), which)


def test_parts_closed_only_together_count_as_closed():
    # Two intersecting double cones cut along their circle: four cones, none closed by itself.
    turn = np.arange(12) * (np.pi / 6)
    ring = np.stack((np.cos(turn), np.sin(turn), 0 * turn), axis=1)
    points = np.concatenate((ring, [(0, 0, z) for z in (1.0, 0.3, -0.3, -1.0)]))
    i, j = np.arange(12), np.roll(np.arange(12), -1)
    up = [np.stack((i, j, np.full(12, 12 + k)), axis=1) for k in (0, 1)]
    down = [np.stack((j, i, np.full(12, 12 + k)), axis=1) for k in (2, 3)]
    mesh = points, np.concatenate((*up, *down))
    assert not flips(mesh).any()
    assert flips(inside_out(mesh)).all()
    beside = both(mesh, sheet(4))  # not the short cut for a mesh closed as a whole
    assert not flips(beside).any()
    np.testing.assert_array_equal(
        flips(both(inside_out(mesh), sheet(4))), [True] * 48 + [False] * 18
    )


def test_wall_between_two_cells():
    points, faces = both(CUBE, moved(CUBE, (1, 0, 0)))
    # Given once, the wall leaves both cells open: rays turn their outsides and can't see the wall.
    corners, number = np.unique(points, axis=0, return_inverse=True)
    wall = (points[faces][..., 0] == 1).all(axis=1)
    once = corners, number[faces[~wall | (np.arange(24) < 12)]]
    assert len(once[1]) == 22
    assert not flips(once).any()
    outside = (corners[once[1]][..., 0] != 1).any(axis=1)
    np.testing.assert_array_equal(flips(inside_out(once)), outside)
    # Given for each of them, it closes both; the sheet is for a mesh not closed as a whole.
    twice = both(inside_out((corners, number[faces])), moved(sheet(3), (0, 0, 4)))
    np.testing.assert_array_equal(flips(twice), np.arange(len(twice[1])) < 24)
