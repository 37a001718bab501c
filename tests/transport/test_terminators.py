"""Coarse triangles with smooth normals hide no light from themselves."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import samples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.making import scale_space
from meshdepict.scene.light import Light
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.mesh import Mesh
from meshdepict.transport.terminators import lifts_to_patches, smooth_starts


def places(mesh, count=20_000):
    """Evenly spread over a mesh: its corners and barycentric coordinates."""
    rng = np.random.default_rng(3)
    a, b, c = (mesh.vertices[corner] for corner in mesh.faces.T)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    triangle = rng.choice(len(areas), count, p=areas / areas.sum())
    return mesh.faces[triangle], rng.dirichlet((1, 1, 1), count)


def spread(mesh, count=20_000):
    return InterpolatedSpace(scale_space(mesh, scales=0), *places(mesh, count))


@pytest.mark.parametrize("count", [40, 150, 600])
def test_half_of_a_coarse_ball_is_dark_and_all_of_it_where_shading_is(count):
    ball = samples.sphere(count)
    found, towards = spread(ball), np.array([3, 4, 5]) / np.sqrt(50)
    seen = found.seen_share(Light(towards))
    assert np.array_equal(seen > 0, found.normals_at(0) @ towards.astype(np.float32) > 0)
    assert np.mean(seen) == pytest.approx(0.5, abs=4 * 0.5 / np.sqrt(len(seen)) + 0.5 / count)


def test_places_are_projected_onto_the_vertices_planes():
    """The article's own loop over the three corners."""
    ball = samples.sphere(80)
    points, normals = ball.unit_points, ball.normals
    corners, weights = places(ball, 50)
    found = lifts_to_patches(points, normals, corners, weights)
    for corner, weight, lift in zip(corners, weights, found, strict=True):
        place = weight @ points[corner]
        moved = np.zeros(3)
        for share, at, up in zip(weight, points[corner], normals[corner], strict=True):
            away = place - at
            moved += share * (away - min(0.0, away @ up) * up)
        np.testing.assert_allclose(lift, moved, atol=1e-12)
    # A file may wind its triangles the other way.
    other = lifts_to_patches(points, normals, corners[:, ::-1], weights[:, ::-1])
    np.testing.assert_allclose(other, found, atol=1e-12)


def test_starts_lie_about_a_balls_surface_and_vertices_stay():
    ball = samples.sphere(150)
    corners, weights = places(ball)
    radius = np.linalg.norm(ball.vertices - ball.centre, axis=1).mean()

    def far(weights):
        flat = np.einsum("nc,nci->ni", weights, ball.unit_points[corners]) * ball.diagonal
        lifts = lifts_to_patches(ball.unit_points, ball.normals, corners, weights)
        return np.linalg.norm(flat + lifts * ball.diagonal, axis=1) / radius

    # The planes about a vertex lie outside: by as much as the triangle inside, at most.
    assert 0.999 < far(weights).min() < far(weights).max() < 1.03
    np.testing.assert_allclose(far(np.eye(3)[np.zeros(len(corners), int)]), 1, atol=1e-3)


def test_planes_hollows_and_right_angles_are_left():
    def lifts(mesh, normals, **more):
        return np.abs(lifts_to_patches(mesh.unit_points, normals, *places(mesh, 500), **more)).max()

    x, y = np.mgrid[:4, :4].reshape(2, -1).astype(float)
    cells = np.array([[i, i + 4, i + 5] for i in (0, 1, 2, 4, 5, 6, 8, 9, 10)])
    plane = Mesh(np.stack([x, y, 0 * x], 1), cells)
    assert lifts(plane, plane.normals) < 1e-12
    ball = samples.sphere(150)
    assert lifts(ball, ball.normals) > 1e-3
    assert lifts(ball, -ball.normals) == 0  # a bowl
    assert lifts(ball, ball.normals, turned=True) == 0  # the same from within
    corner = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T.astype(float)
    sides = [
        [0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3],
    ]  # fmt: skip
    halves = [half for a, b, c, d in sides for half in ((c, b, a), (d, c, a))]
    cube = Mesh(corner, np.array(halves))
    assert lifts(cube, cube.normals) == 0


def test_what_lies_close_above_keeps_its_shadow():
    """A leaf between a triangle and the surface that its normals pretend."""
    ball = samples.sphere(60)
    a, b, c = ball.faces[0]
    middle = ball.vertices[[a, b, c]].mean(axis=0)
    lift = ball.diagonal * lifts_to_patches(
        ball.unit_points, ball.normals, np.array([[a, b, c]]), np.full((1, 3), 1 / 3)
    )
    leaf = ball.vertices[[a, b, c]] + lift / 2
    both = Mesh(
        np.concatenate([ball.vertices, leaf]),
        np.concatenate([ball.faces, np.arange(3)[None] + len(ball.vertices)]),
        winding="keep",
    )
    np.testing.assert_allclose(smooth_starts(ball, middle[None], lift), middle[None] + lift)
    np.testing.assert_array_equal(smooth_starts(both, middle[None], lift), middle[None])


LOW = (1, 0.3, 0.2)


@pytest.mark.parametrize("method", ["lambert", "phong"])
def test_a_ball_hides_no_light_from_itself_texel_by_texel(method):
    ball = samples.sphere(120)
    shown = [
        md.bake_texture(ball, method, size=256, light=LOW, shadows=shadows).image.astype(int)
        for shadows in (False, True)
    ]
    assert np.abs(shown[1] - shown[0]).max() <= 1


def test_a_ball_hides_no_light_from_itself_pixel_by_pixel():
    buffer = GBuffer.of(samples.sphere(120), "front", size=(120, 120))
    shown = [
        md.bake(buffer, "lambert", light=LOW, shadows=shadows).intensity
        for shadows in (False, True)
    ]
    np.testing.assert_allclose(shown[1], shown[0], atol=1e-6)


def test_texels_of_a_ball_see_all_of_the_sky_above_them():
    image = md.bake_texture(samples.sphere(120), map="occlusion", size=128, rays=32).image
    assert image.min() >= 254


def test_the_other_side_of_a_ball_is_lit_within():
    """Seen from both sides: a bowl whose edges look at the eye from within."""
    ball = samples.sphere(200)
    front = ball.vertices[ball.faces].mean(axis=1)[:, 2] < ball.centre[2]
    bowl = Mesh(ball.vertices, ball.faces[front], winding="keep")
    shown = [
        md.bake_texture(
            bowl, "lambert", size=256, light=(0, 0, 1), view="front", two_sided=True,
            shadows=shadows,
        ).image.astype(int)
        for shadows in (False, True)
    ]  # fmt: skip
    assert np.abs(shown[1] - shown[0]).max() <= 1
