"""The icosahedron's symmetry and counts carry over to its lattices."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from meshdepict import MeshdepictError
from meshdepict.surface.icosahedron import icosahedron, icosphere, lattice_points


def fifth_of_a_turn(points):
    """Turn about a corner of the icosahedron, which maps it to itself."""
    axis = icosahedron()[0][0]
    along = np.outer(points @ axis, axis)
    angle = 2 * np.pi / 5
    return along + np.cos(angle) * (points - along) + np.sin(angle) * np.cross(axis, points)


def test_icosahedron_is_regular_and_outward():
    corners, faces = icosahedron()
    a, b, c = corners[faces].transpose(1, 0, 2)
    sides = np.linalg.norm([b - a, c - b, a - c], axis=-1)
    np.testing.assert_allclose(sides, 1 / np.sin(2 * np.pi / 5), rtol=1e-14)
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0).all()
    assert (np.bincount(faces.ravel()) == 5).all()
    np.testing.assert_allclose(cKDTree(corners).query(fifth_of_a_turn(corners))[0], 0, atol=1e-7)


@pytest.mark.parametrize("frequency", [1, 2, 3, 7])
def test_icosphere_is_the_icosahedron_cut(frequency):
    f = frequency
    points, faces = icosphere(10 * f * f + 2)
    assert points.shape == (10 * f * f + 2, 3)
    assert faces.shape == (20 * f * f, 3)
    np.testing.assert_array_equal(points[:12], icosahedron()[0])
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, rtol=1e-15)
    np.testing.assert_allclose(cKDTree(points).query(fifth_of_a_turn(points))[0], 0, atol=1e-7)
    neighbours = np.bincount(faces.ravel())
    assert (neighbours[:12] == 5).all()
    assert (neighbours[12:] == 6).all()


@pytest.mark.parametrize("count", [12, 32, 42, 72, 272, 362, 392, 492])
def test_lattices_are_even_and_symmetric(count):
    points = lattice_points(count)
    assert points.shape == (count, 3)
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    assert nearest.max() < 1.2 * nearest.min()
    np.testing.assert_allclose(cKDTree(points).query(fifth_of_a_turn(points))[0], 0, atol=1e-7)


def test_lattice_along_the_edges_is_the_icosphere():
    points, _ = icosphere(362)
    np.testing.assert_allclose(cKDTree(points).query(lattice_points(362))[0], 0, atol=1e-7)


@pytest.mark.parametrize(("count", "nearest"), [(5, "12$"), (100, "92 or 122")])
def test_other_counts_are_refused(count, nearest):
    with pytest.raises(MeshdepictError, match=rf"has {count} points; take {nearest}"):
        lattice_points(count)
