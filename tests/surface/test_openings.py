"""Which parts of a surface have a boundary."""

import numpy as np
from conftest import tetrahedron

from meshdepict.surface.openings import open_faces


def test_a_closed_surface_is_open_nowhere():
    vertices, faces = tetrahedron()
    assert not open_faces(vertices, faces).any()
    # Nor with the winding of a face turned: it is closed still.
    faces[0] = faces[0][::-1]
    assert not open_faces(vertices, faces).any()


def test_a_component_with_a_hole_is_open_all_over_and_others_are_not():
    vertices, faces = tetrahedron()
    both = np.vstack([vertices, vertices + 10])
    joined = np.vstack([faces, faces[1:] + 4])
    np.testing.assert_array_equal(open_faces(both, joined), [False] * 4 + [True] * 3)


def test_a_seam_is_no_boundary_and_a_degenerate_face_has_no_side():
    vertices, faces = tetrahedron()
    corners = vertices[faces].reshape(-1, 3)  # every face with vertices of its own
    alone = np.arange(12).reshape(-1, 3)
    assert not open_faces(corners, alone).any()
    with_needle = np.vstack([faces[1:], [[0, 0, 1]]])
    np.testing.assert_array_equal(open_faces(vertices, with_needle), [True] * 3 + [False])


def test_components_that_share_an_edge_are_one():
    vertices, faces = tetrahedron()
    with_fin = np.vstack([faces, [[0, 1, 4]]])
    assert open_faces(np.vstack([vertices, [[5, 5, 5]]]), with_fin).all()
