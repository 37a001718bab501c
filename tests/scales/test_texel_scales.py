"""Samples of a texture, and the normals that normal maps give."""

import numpy as np
import pytest
from textured_shapes import globe, laid, picture, sheet

from meshdepict import samples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.making import scale_space
from meshdepict.scales.mapped_normals import NormalMaps
from meshdepict.scales.texel_scales import TexelSpace
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Textures


def places(mesh, count=300, seed=0):
    rng = np.random.default_rng(seed)
    triangle = rng.integers(0, len(mesh.faces), count).astype(np.int32)
    return triangle, rng.dirichlet(np.ones(3), count).astype(np.float32)


def test_single_and_double_precision_give_the_same_normals():
    mesh = samples.golf_ball(900)
    space = scale_space(mesh, scales=3)
    triangle, weights = places(mesh)
    corners = mesh.faces[triangle]
    one = TexelSpace(space, corners.astype(np.int32), weights)
    other = TexelSpace(space, corners, weights.astype(np.float64))
    assert np.abs(one.normals - other.normals).max() < 1e-6
    assert np.allclose(np.linalg.norm(one.normals, axis=2), 1, atol=1e-6)
    mean = np.einsum("nc,ncx->nx", weights, space.normals_at(2)[corners])
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    assert np.abs(one.normals_at(2) - mean).max() < 1e-6
    at = np.einsum("nc,ncx->nx", weights, mesh.vertices[corners])
    assert np.abs(one.points - at).max() < 1e-6


def test_where_corners_cancel_the_nearest_ones_normal_is_taken():
    space = scale_space(sheet(1), scales=0)
    opposed = np.array([[0.0, 0, 1], [0, 0, -1], [0, 0, -1], [0, 0, 1]], np.float32)
    own = np.arange(4)[:, None] * [1, 1, 1]
    turned = InterpolatedSpace(space, own, np.full((4, 3), 1 / 3), normals=opposed)
    shares = np.array([[0.5, 0.5, 0], [0.5, 0.5, 0], [0.4, 0.2, 0.4]])
    found = TexelSpace(turned, np.array([[0, 1, 2], [1, 0, 2], [1, 2, 3]]), shares)
    assert np.allclose(found.normals_at(0)[:, 2], [1, -1, -1])


def test_texels_cast_their_own_rays():
    mesh = sheet(8, height=lambda x, y: 0.2 * np.sin(9 * x + y))
    space = scale_space(mesh, scales=0)
    triangle, weights = places(mesh, 50)
    texels = TexelSpace(space, mesh.faces[triangle], weights)
    own = texels.occlusion(64)
    between = np.einsum("nc,nc->n", weights, space.occlusion(64)[mesh.faces[triangle]])
    assert not np.allclose(own, between, atol=1e-3)
    assert np.abs(own - between).mean() < 0.1  # but they see the same surroundings


def tilted(x, y):
    """A normal map's bytes of a tilt by (x, y) everywhere."""
    normal = np.array([x, y, np.sqrt(1 - x * x - y * y)])
    return np.rint(255 * (normal / 2 + 0.5)).astype(np.uint8) * np.ones((4, 4, 1), np.uint8)


@pytest.mark.parametrize("strength", [0.5, 1.0])
def test_on_a_sheet_a_map_turns_normals_along_u_and_v(strength):
    flat = sheet(4)
    mesh = laid(flat, flat.texcoords, normal=picture(tilted(0.4, 0.2)), strength=strength)
    triangle, weights = places(mesh)
    found = NormalMaps(mesh, mesh.normals, mesh.textures).at(triangle, weights)
    wanted = np.array([0.4 * strength, 0.2 * strength, np.sqrt(1 - 0.2)])
    assert np.abs(found - wanted / np.linalg.norm(wanted)).max() < 1 / 127


def test_a_level_map_leaves_normals_as_they_are_but_for_its_eight_bits():
    ball = globe(8)
    mesh = laid(ball, ball.texcoords, normal=picture(tilted(0, 0)))
    triangle, weights = places(mesh)
    found = NormalMaps(mesh, mesh.normals, mesh.textures).at(triangle, weights)
    smooth = np.einsum("nc,ncx->nx", weights, mesh.normals[mesh.faces[triangle]])
    smooth /= np.linalg.norm(smooth, axis=1, keepdims=True)
    assert np.arccos(np.clip((found * smooth).sum(axis=1), -1, 1)).max() < 0.01
    assert np.allclose(np.linalg.norm(found, axis=1), 1)


def test_a_map_of_nothing_leaves_the_normals():
    flat = sheet(2)
    mesh = laid(flat, flat.texcoords, normal=picture(np.full((2, 2, 3), 128)), strength=0.0)
    triangle, weights = places(mesh, 20)
    found = NormalMaps(mesh, mesh.normals, mesh.textures).at(triangle, weights)
    assert np.allclose(found, (0, 0, 1))


def turning(angle, size=512):
    """A normal map of normals that lean by an angle (radians) that grows along u, and its bytes."""
    u = (np.arange(size) + 0.5) / size
    normal = np.stack([np.sin(angle(u)), np.zeros(size), np.cos(angle(u))], 1)
    return np.rint(255 * (normal / 2 + 0.5)).astype(np.uint8) * np.ones((size, 1, 1), np.uint8)


@pytest.mark.parametrize("size", [1.0, 40.0])
def test_a_map_bends_as_its_normals_turn(size):
    flat = sheet(3)
    large = Mesh(flat.vertices * size, flat.faces)
    mesh = laid(large, flat.texcoords, normal=picture(turning(lambda u: 2 * (u - 0.5), 64)))
    triangle, weights = places(mesh, 500)
    at = np.einsum("nc,ncx->nx", weights, mesh.texcoords[triangle])
    inner = (np.abs(at - 0.5) < 0.4).all(axis=1)
    k1, k2, d1, _ = NormalMaps(mesh, mesh.normals, mesh.textures).curvature(triangle, weights)
    # A cylinder: two radians along the side, seen from the sheet below it. Bytes round by 1/127.
    lean = np.cos(2 * (at[inner, 0] - 0.5))
    assert np.allclose((k1[inner] * lean).mean() * size, 2, rtol=0.05)
    assert np.abs(k2[inner]).mean() * size < 0.1
    assert np.abs(np.abs(d1[inner][:, 1])).mean() < 0.1


def test_where_there_is_no_map_curvature_is_the_vertices():
    ball = globe(8)
    half = np.repeat([0, 1], len(ball.faces) // 2)
    level = picture(tilted(0, 0))
    mesh = ball.with_textures(
        Textures(ball.texcoords, half, (None, None), np.ones((2, 4)), (None, level), np.ones(2))
    )
    space = scale_space(mesh, scales=1)
    triangle, weights = places(mesh)
    maps = NormalMaps(mesh, mesh.normals, mesh.textures)
    assert np.array_equal(maps.reach(triangle), half[triangle] == 1)
    with_map = TexelSpace(space, mesh.faces[triangle], weights, maps=maps, triangle=triangle)
    without = TexelSpace(space, mesh.faces[triangle], weights)
    bare = half[triangle] == 0
    assert np.allclose(with_map.curvature(0).mean[bare], without.curvature(0).mean[bare], rtol=1e-4)
    # A level map on a sphere turns as the vertices' normals do.
    assert np.allclose(with_map.curvature(0).mean[~bare], 1, atol=0.3)
    assert np.allclose(with_map.curvature(1).mean, without.curvature(1).mean, rtol=1e-2)


def test_triangles_without_area_in_the_map_are_level_there():
    flat = sheet(2)
    texcoords = flat.texcoords.copy()
    texcoords[0] = 0.3
    mesh = laid(flat, texcoords, normal=picture(turning(lambda u: u)))
    maps = NormalMaps(mesh, mesh.normals, mesh.textures)
    k1, k2, *_ = maps.curvature(np.zeros(4, np.int32), np.full((4, 3), 1 / 3))
    assert (k1 == 0).all()
    assert (k2 == 0).all()
