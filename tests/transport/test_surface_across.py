"""What lies across from one surface on another."""

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.shapes.mesh import Mesh
from meshdepict.transport.surface_across import surface_across


@pytest.fixture(scope="module")
def ball():
    return samples.sphere(2000)


def directions(count=500):
    found = np.random.default_rng(0).normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


@pytest.mark.parametrize("radius", [0.97, 1.0, 1.03])
def test_from_inside_and_from_outside_a_sphere_radial_rays_meet_it(ball, radius):
    normals = directions()
    found = surface_across(ball, ball.recentred(radius * normals), normals, 0.05)
    assert (found.triangle >= 0).all()
    met = np.einsum("nc,ncx->nx", found.weights, ball.vertices[ball.faces[found.triangle]])
    met /= np.linalg.norm(met, axis=1, keepdims=True)
    assert np.abs(met - normals).max() < 1e-4  # of single precision
    assert np.allclose(found.weights.sum(axis=1), 1)


def test_what_is_further_away_than_rays_reach_is_missed(ball):
    normals = directions()
    assert (surface_across(ball, ball.recentred(1.2 * normals), normals, 0.05).triangle == -1).all()


def test_the_nearer_of_two_sides_is_met_and_the_far_side_of_a_wall_is_not():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    places = np.array([[0.4, 0.3, 0.01]])
    up = np.array([[0.0, 0, 1]])
    # Two sheets that look up, one far above, and one close above that looks down.
    points = np.concatenate([square, *(np.add(square, (0, 0, z)) for z in (0.1, 0.015))])
    mesh = Mesh(points, np.concatenate([faces, faces + 4, faces[:, ::-1] + 8]), winding="keep")
    found = surface_across(mesh, mesh.recentred(places), up, 0.2)
    assert found.triangle[0] in (0, 1)
    met = found.weights[0] @ points[mesh.faces[found.triangle[0]]]
    assert np.allclose(met, (0.4, 0.3, 0), atol=1e-5)
