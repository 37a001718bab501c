"""Samples of a texture, and the normals that normal maps give."""

import numpy as np
import pytest
from textured_shapes import globe, laid, picture, sheet

from meshdepict.scales.making import scale_space
from meshdepict.scales.mapped_normals import TangentFrames, mapped_normals
from meshdepict.scales.texel_scales import TexelSpace
from meshdepict.shapes import samples


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
    mesh = sheet(1)
    space = scale_space(mesh, scales=0)
    planes = np.array([[0.0, 0, 1], [0, 0, -1], [0, 0, -1], [0, 0, 1]], np.float32)
    space = TexelSpace(
        space, np.arange(4)[:, None] * [1, 1, 1], np.ones((4, 3)) / 3, normals=planes
    )
    found = TexelSpace(space, np.array([[0, 1, 0], [1, 0, 1]]), np.array([[0.5, 0.5, 0.0]] * 2))
    assert np.allclose(np.abs(found.normals_at(0)), (0, 0, 1))
    assert np.allclose(found.normals_at(0)[0], (0, 0, 1))


def test_texels_cast_their_own_rays():
    mesh = samples.golf_ball(900)
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
    frames = TangentFrames(mesh, mesh.normals, mesh.texcoords)
    found = mapped_normals(frames, mesh.textures, triangle, weights)
    wanted = np.array([0.4 * strength, 0.2 * strength, np.sqrt(1 - 0.2)])
    assert np.abs(found - wanted / np.linalg.norm(wanted)).max() < 1 / 127


def test_a_level_map_leaves_normals_as_they_are_but_for_its_eight_bits():
    ball = globe(8)
    mesh = laid(ball, ball.texcoords, normal=picture(tilted(0, 0)))
    triangle, weights = places(mesh)
    frames = TangentFrames(mesh, mesh.normals, mesh.texcoords)
    found = mapped_normals(frames, mesh.textures, triangle, weights)
    smooth = np.einsum("nc,ncx->nx", weights, mesh.normals[mesh.faces[triangle]])
    smooth /= np.linalg.norm(smooth, axis=1, keepdims=True)
    assert np.arccos(np.clip((found * smooth).sum(axis=1), -1, 1)).max() < 0.01
    assert np.allclose(np.linalg.norm(found, axis=1), 1)


def test_a_map_of_nothing_leaves_the_normals():
    flat = sheet(2)
    mesh = laid(flat, flat.texcoords, normal=picture(np.full((2, 2, 3), 128)), strength=0.0)
    triangle, weights = places(mesh, 20)
    found = mapped_normals(
        TangentFrames(mesh, mesh.normals, mesh.texcoords), mesh.textures, triangle, weights
    )
    assert np.allclose(found, (0, 0, 1))
