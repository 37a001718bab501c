"""The point of a surface that is closest to another."""

import igl
import numpy as np

from meshdepict import samples
from meshdepict.surface.closest_points import ClosestPoints


def test_near_a_surface_the_closest_points_are_libigls():
    mesh = samples.golf_ball(900)
    rng = np.random.default_rng(1)
    chosen = rng.integers(0, len(mesh.faces), 400)
    weights = rng.dirichlet(np.ones(3), 400)
    on = np.einsum("nc,ncx->nx", weights, mesh.unit_points[mesh.faces[chosen]])
    near = on + rng.normal(size=on.shape) * 0.004
    triangle, shares = ClosestPoints(mesh.unit_points, mesh.faces).at(near)
    found = np.einsum("nc,ncx->nx", shares, mesh.unit_points[mesh.faces[triangle]])
    squared, *_ = igl.point_mesh_squared_distance(near, mesh.unit_points, mesh.faces)
    distance = np.linalg.norm(found - near, axis=1)
    # Only triangles at the nearest vertex are looked at; mostly the closest is among them.
    assert np.mean(distance < np.sqrt(squared) + 1e-9) > 0.97
    assert (distance <= np.linalg.norm(on - near, axis=1).max()).all()
    assert np.allclose(shares.sum(axis=1), 1)
    assert shares.min() >= 0


def test_points_of_the_surface_find_themselves():
    mesh = samples.golf_ball(500)
    shares = np.array([[0.2, 0.3, 0.5]])
    points = np.einsum(
        "nc,ncx->nx", np.repeat(shares, len(mesh.faces), 0), mesh.unit_points[mesh.faces]
    )
    triangle, weights = ClosestPoints(mesh.unit_points, mesh.faces).at(points)
    found = np.einsum("nc,ncx->nx", weights, mesh.unit_points[mesh.faces[triangle]])
    assert np.abs(found - points).max() < 1e-9


def test_the_seven_regions_of_a_triangle_each_have_their_point():
    points, faces = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    places = np.array(
        [[-1, -1, 1], [2, -0.5, 1], [-0.5, 2, 1], [0.5, -1, 1], [-1, 0.5, 1], [1, 1, 1],
         [0.2, 0.3, 1]]
    )  # fmt: skip
    wanted = [
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [0.5, 0, 0],
        [0, 0.5, 0],
        [0.5, 0.5, 0],
        [0.2, 0.3, 0],
    ]
    _, weights = ClosestPoints(points, faces).at(places)
    assert np.allclose(weights @ points, wanted)
