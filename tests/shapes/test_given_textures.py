"""Meshes that are given other textures than their file's."""

import numpy as np
import pytest
from textured_shapes import globe, sheet

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.mesh import Mesh


def test_a_mesh_with_other_textures_is_the_same_mesh():
    flat = sheet(3)
    normals = flat.normals
    turned = flat.textures.__class__(
        **{**vars(flat.textures), "texcoords": flat.texcoords[..., ::-1]}
    )
    other = flat.with_textures(turned)
    assert other.textures is turned
    assert np.array_equal(other.texcoords, flat.texcoords[..., ::-1])
    assert other.vertices is flat.vertices
    assert other.normals is normals
    assert flat.textures is not turned


def test_textures_of_another_number_of_triangles_and_what_are_none_are_refused():
    flat = sheet(3)
    with pytest.raises(MeshdepictError, match="textures of 192 triangles don't fit a mesh of 18"):
        flat.with_textures(globe(4).textures)
    with pytest.raises(MeshdepictError, match=r"textures='oak\.png' are neither Textures"):
        Mesh(flat.vertices, flat.faces, textures="oak.png")


def test_the_corners_of_triangles_are_counted_through_all_polygons():
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], float)
    mesh = Mesh(corners, [[0, 1, 2, 3], [1, 4, 2]])
    connectivity = mesh.polygons.connectivity
    assert np.array_equal(connectivity[mesh.triangle_corners], mesh.faces)
    assert mesh.triangle_corners[-1].min() >= 4
