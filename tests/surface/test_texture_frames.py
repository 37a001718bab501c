"""Tangents at the corners of triangles that have texture coordinates."""

import numpy as np
from textured_shapes import globe, sheet

from meshdepict.surface.texture_frames import corner_tangents


def frames(mesh, texcoords=None):
    at = mesh.texcoords if texcoords is None else texcoords
    return corner_tangents(mesh.unit_points, mesh.faces, mesh.normals, at)


def test_on_a_square_tangents_are_where_u_grows():
    tangents, signs = frames(sheet(3))
    assert np.allclose(tangents, (1, 0, 0))
    assert (signs == 1).all()


def test_mirrored_charts_have_the_other_sign_and_v_still_grows_along_the_third_axis():
    mesh = sheet(3)
    tangents, signs = frames(mesh, mesh.texcoords * (-1, 1))
    assert np.allclose(tangents, (-1, 0, 0))
    assert (signs == -1).all()
    third = signs[:, None, None] * np.cross(mesh.normals[mesh.faces], tangents)
    assert np.allclose(third, (0, 1, 0))


def test_tangents_are_unit_and_lie_in_the_plane_of_the_normal():
    mesh = globe(6)
    tangents, _ = frames(mesh)
    assert np.allclose(np.linalg.norm(tangents, axis=2), 1)
    assert np.abs((tangents * mesh.normals[mesh.faces]).sum(axis=2)).max() < 1e-12


def test_corners_that_share_vertex_and_coordinates_share_a_tangent():
    mesh = globe(6)
    tangents, _ = frames(mesh)
    key = np.column_stack([mesh.faces.reshape(-1), mesh.texcoords.reshape(-1, 2)])
    _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
    flat = tangents.reshape(-1, 3)
    assert np.allclose(flat, flat[first][group.reshape(-1)])
    assert len(first) < len(flat)


def test_triangles_without_area_in_the_atlas_have_some_tangent_in_the_plane():
    mesh = sheet(2)
    tangents, _ = frames(mesh, np.zeros_like(mesh.texcoords))
    assert np.allclose(np.linalg.norm(tangents, axis=2), 1)
    assert np.allclose(tangents[..., 2], 0)
