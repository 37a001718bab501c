"""A hundred thousand of everything: a picture in time, within memory."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from extreme_calls import proper, refused, usual
from odd_meshes import LARGE

import meshdepict as md
from meshdepict.curvature import principal_curvatures
from meshdepict.shading import METHODS
from meshdepict.shading.accessibility import accessible_radii

pytestmark = pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")

# Of arrays, for each vertex and face: scale space, curvature and a method's own come to less.
BYTES = 2_000

QUICK = ["exaggerated", "light_alignment", "mean_curvature", "accessibility", "unsharp_masking"]


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_it_is_shaded_within_memory(name):
    vertices, faces = LARGE[name]()
    tracemalloc.start()
    try:
        space = md.scale_space(md.Mesh(vertices, faces), scales=2)
        for method in QUICK:
            proper(METHODS[method](space, "northwest", **usual(method)), len(vertices))
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < BYTES * (len(vertices) + len(faces))


def test_vertices_at_one_place_are_one():
    # A tree would ask each of 20,000 about all others.
    corners = np.eye(3)
    normals = np.tile([0.0, 0.0, 1.0], (3, 1))
    alone = accessible_radii(corners, normals, 10.0)
    many = accessible_radii(np.tile(corners, (20_000, 1)), np.tile(normals, (20_000, 1)), 10.0)
    np.testing.assert_array_equal(many, np.tile(alone, 20_000))


def test_a_radius_that_holds_all_of_a_large_mesh_is_refused():
    vertices, faces = LARGE["a fan of 100,000 spokes"]()
    said = refused(lambda: principal_curvatures(md.Mesh(vertices, faces), method="quadric"))
    assert "would take too long: take a smaller radius" in said


def test_the_closest_point_across_a_seam_is_found_on_either_side():
    from meshdepict.surface.closest_points import ClosestPoints

    # Two triangles that touch along an edge whose vertices are there twice.
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 0], [0, 1, 0], [-1, 0, 0.0]])
    faces = np.array([[0, 2, 1], [3, 4, 5]])
    found, shares = ClosestPoints(points, faces).at(np.array([[0.2, 0.2, 1], [-0.2, 0.2, 1]]))
    assert found.tolist() == [0, 1]
    at = np.einsum("nc,ncx->nx", shares, points[faces[found]])
    np.testing.assert_allclose(at, [[0.2, 0.2, 0], [-0.2, 0.2, 0]], atol=1e-12)
