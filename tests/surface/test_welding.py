import numpy as np
import pytest
from conftest import rotation

from meshdepict import samples
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface import welding
from meshdepict.surface.welding import normal_groups, same_position


def sets(labels):
    """The partition that labels stand for, whatever the numbers."""
    return {frozenset(np.flatnonzero(labels == label)) for label in np.unique(labels)}


def by_dictionary(vertices):
    """The slow and obvious way to the same labels."""
    numbers = {}
    return np.array([numbers.setdefault(tuple(vertex + 0.0), len(numbers)) for vertex in vertices])


def lattice(rng, count=3000):
    """Points of a small lattice in any order: many at one position, coordinates much alike."""
    return rng.integers(-6, 6, (count, 3)) / 4.0


# --- positions --------------------------------------------------------------------------------


def test_labels_are_those_of_a_dictionary(rng):
    points = lattice(rng)
    labels = same_position(points)
    assert sets(labels) == sets(by_dictionary(points))
    np.testing.assert_array_equal(np.unique(labels), np.arange(labels.max() + 1))


@pytest.mark.parametrize("constant", [0, 3])
def test_positions_of_one_hash_are_told_apart(rng, monkeypatch, constant):
    # All hashes alike, or four of them for all positions.
    hashes = welding._hashes
    monkeypatch.setattr(welding, "_hashes", lambda keys: hashes(keys) & np.uint64(constant))
    points = lattice(rng)
    assert sets(same_position(points)) == sets(by_dictionary(points))
    distinct = np.unique(points, axis=0)
    assert same_position(rng.permutation(distinct)) is None


def test_where_all_differ_there_are_no_labels(sphere):
    assert same_position(sphere.vertices) is None
    assert same_position(np.zeros((1, 3))) is None
    assert same_position(np.empty((0, 3))) is None


def test_a_last_bit_is_a_difference_and_a_sign_of_zero_is_none():
    assert same_position(np.array([[1, 2, 3], [1, 2, np.nextafter(3, 4)]])) is None
    labels = same_position(np.array([[0.0, -0.0, 1], [-0.0, 0.0, 1]]))
    np.testing.assert_array_equal(labels, [0, 0])


def test_swapped_coordinates_are_other_positions():
    assert same_position(np.array([[1.0, 2, 3], [2, 1, 3], [3, 2, 1], [1, 3, 2]])) is None


def test_hashes_of_regular_points_differ():
    # Coordinates of few digits differ in few bits: a weak hash would have them collide, and cost
    # the slow ranking. Of 10⁶ random 64-bit numbers two are alike once in 4·10⁷ times.
    axis = np.arange(100.0)
    grid = np.stack(np.meshgrid(axis, axis / 8, axis * 1e5), axis=-1).reshape(-1, 3)
    hashes = np.sort(welding._hashes(grid))
    assert (hashes[1:] != hashes[:-1]).all()


# --- normals ----------------------------------------------------------------------------------


def flat(*degrees, length=1.0):
    """Normals in a plane, at these angles."""
    angle = np.radians(degrees)
    return length * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)


HERE = np.zeros(3, int)


@pytest.mark.parametrize(
    ("angle", "shared"),
    [(0, True), (89, True), (90, True), (90.1, False), (91, False), (180, False)],
)
def test_two_normals_share_up_to_a_right_angle(angle, shared, rng):
    for _ in range(20):  # whichever way rounding goes
        normals = flat(10, 10 + angle) @ rotation(rng).T * rng.uniform(0.1, 10, (2, 1))
        group = normal_groups(HERE[:2], normals)
        assert (group[0] == group[1]) == shared


def test_the_middle_one_of_three_gathers_both(rng):
    normals = flat(0, 80, 160)
    for order in ([0, 1, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]):
        np.testing.assert_array_equal(normal_groups(HERE, normals[order]), [0, 0, 0])


def test_of_three_two_sides_are_two_groups():
    assert sets(normal_groups(HERE, flat(0, 20, 190))) == {frozenset({0, 1}), frozenset({2})}


def test_opposed_in_all_directions_each_is_alone():
    assert len(sets(normal_groups(HERE, flat(0, 120, 240)))) == 3


def test_vertices_without_a_normal_join_one_that_has_one():
    normals = np.vstack([flat(0), np.zeros((1, 3)), flat(180)])
    group = normal_groups(HERE, normals)
    assert group[0] != group[2]
    assert group[1] in (group[0], group[2])
    np.testing.assert_array_equal(normal_groups(HERE, np.zeros((3, 3))), [0, 0, 0])


def test_groups_lie_within_positions_and_are_numbered_without_gaps(rng):
    position = rng.integers(0, 200, 3000)
    position = np.unique(position, return_inverse=True)[1]
    group = normal_groups(position, rng.normal(size=(3000, 3)))
    np.testing.assert_array_equal(np.unique(group), np.arange(group.max() + 1))
    for members in sets(group):
        assert len(set(position[list(members)])) == 1


def test_groups_do_not_depend_on_numbering(rng):
    position = np.unique(rng.integers(0, 200, 3000), return_inverse=True)[1]
    # Of few directions and lengths, so that there are ties of all kinds.
    normals = rng.integers(-1, 2, (3000, 3)).astype(float)
    group, order = normal_groups(position, normals), rng.permutation(3000)
    again = np.empty_like(group)
    again[order] = normal_groups(position[order], normals[order])
    same = {(g, a) for g, a in zip(group, again, strict=True)}
    # One to one, up to vertices with equal normals, which are the same to everyone.
    assert len(same) == len(set(group)) == len(set(again))


# --- on meshes --------------------------------------------------------------------------------


def loose_box(size, rng):
    """A box whose faces share no vertices, turned any way."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float) / 2
    quads = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    )
    vertices = (corners * size)[quads.ravel()] @ rotation(rng).T
    return Mesh(vertices, np.arange(24).reshape(6, 4))


def test_a_cube_of_loose_faces_is_smooth_whichever_way_it_lies(rng):
    for _ in range(10):
        cube = loose_box((1, 1, 1), rng)
        diagonal = cube.vertices / np.linalg.norm(cube.vertices, axis=1, keepdims=True)
        np.testing.assert_allclose(cube.normals, diagonal, atol=1e-12)


def test_areas_at_a_seam_are_shared_evenly(rng):
    box = loose_box((1, 2, 3), rng)  # by themselves the corners of its faces have 2/4, 3/4, 6/4
    np.testing.assert_allclose(box.areas, np.full(24, 22 / 24))


def test_permuting_a_mesh_permutes_its_normals(rng):
    ball = samples.golf_ball(400, dimples=12)
    vertices = ball.vertices[ball.faces].reshape(-1, 3)
    soup = Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3))
    order = rng.permutation(len(vertices))
    permuted = Mesh(vertices[order], np.argsort(order).reshape(-1, 3))
    # Sums in another order: rounding.
    np.testing.assert_allclose(permuted.normals, soup.normals[order], atol=1e-12)
    np.testing.assert_allclose(permuted.areas, soup.areas[order], rtol=1e-12)
