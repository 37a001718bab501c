"""Rays in glass against Snell, Fresnel and the glass sphere of the textbooks."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.shading.transmission import fresnel
from meshdepict.transport.inner_paths import inner_paths

ETA = 1.5
BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def box(place=1.0, move=0.0):
    """A closed unit box whose sides have corners, and flat normals, of their own."""
    sides, normals = [], []
    for axis in range(3):
        for side in (0, 1):
            corners = np.zeros((4, 3))
            corners[:, (axis + 1) % 3] = (0, 1, 1, 0)
            corners[:, (axis + 2) % 3] = (0, 0, 1, 1)
            corners[:, axis] = side
            sides.append(corners if side else corners[::-1])
            normal = np.zeros(3)
            normal[axis] = 2 * side - 1
            normals += [normal] * 4
    faces = np.vstack([[[i, i + 1, i + 2], [i, i + 2, i + 3]] for i in range(0, 24, 4)])
    mesh = md.Mesh(np.vstack(sides) * place + move, faces, winding="keep")
    return mesh, np.array(normals)


def follow(mesh, at, towards, *, refraction=ETA, walls=1, normals=None, **options):
    directions = np.atleast_2d(np.asarray(towards, float))
    directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    points = mesh.recentred(np.atleast_2d(np.asarray(at, float)))
    return inner_paths(
        mesh, points, directions, normals=mesh.normals if normals is None else normals,
        refraction=refraction, walls=walls, **options,
    )  # fmt: skip


def refracted_in(incidence, refraction=ETA):
    """The direction (3,) below a level surface of what falls on it at an angle in the xz plane."""
    sine = np.sin(incidence) / refraction
    return np.array([sine, 0, -np.sqrt(1 - sine**2)])


@pytest.mark.parametrize(("place", "move"), [(1.0, 0.0), (1e-8, 0.0), (1.0, 2.0**20)])
@pytest.mark.parametrize("incidence", [0.0, 0.3, 0.7])
def test_a_slab_lets_rays_out_parallel_to_how_they_came(incidence, place, move):
    mesh, normals = box(place, move)
    inner = refracted_in(incidence)
    at = np.array([0.3, 0.5, 0.99]) * place + move
    found = follow(mesh, at, inner, normals=normals)
    (wall,) = found.walls
    outside = [np.sin(incidence), 0, -np.cos(incidence)]
    np.testing.assert_allclose(wall.leaving[0], outside, atol=1e-6)
    np.testing.assert_allclose(wall.normal[0], [0, 0, -1], atol=1e-6)
    # Fresnel is the same both ways.
    assert 1 - wall.let_out[0] == pytest.approx(fresnel(np.cos(incidence), ETA), rel=1e-4)


def test_a_prism_mirrors_all_of_what_comes_too_flat():
    mesh, normals = box()
    # At 60° to the lower side, beyond 41.8°; then at 30° to the right one.
    found = follow(mesh, (0.3, 0.5, 0.3), (np.sqrt(3), 0, -1), walls=2, normals=normals)
    first, second = found.walls
    assert first.let_out[0] == 0
    np.testing.assert_allclose(second.arriving[0], [np.sqrt(0.75), 0, 0.5], atol=1e-6)
    assert second.share[0] == 1
    np.testing.assert_allclose(
        second.leaving[0], [np.sqrt(1 - 0.75**2), 0, 0.75], atol=1e-5
    )  # sin 30° · 1.5


@pytest.mark.parametrize("incidence", [0.1, 0.5, 0.9, 1.2])
def test_a_glass_sphere_turns_a_ray_as_its_rainbows_say(incidence):
    ball = md.samples.sphere(40_000)
    normals = ball.vertices  # of the sphere itself
    inside = np.arcsin(np.sin(incidence) / ETA)
    # A ray along −z that falls on the sphere at this angle, in the plane of x and z.
    normal = np.array([np.sin(incidence), 0, np.cos(incidence)])
    down = np.array([0, 0, -1.0])
    cosine = np.cos(incidence)
    inner = down / ETA + (cosine / ETA - np.cos(inside)) * normal
    found = follow(ball, 0.999 * normal, inner, walls=3, normals=normals)
    for order, wall in enumerate(found.walls):
        # Deviation after so many inner reflections, in the sense in which the surface turns.
        turned = 2 * (incidence - inside) + order * (np.pi - 2 * inside)
        expected = [-np.sin(turned), 0, -np.cos(turned)]
        # Facets are 0.02 wide, and their planes that squared over 8 within.
        np.testing.assert_allclose(wall.leaving[0], expected, atol=0.01)
        kept = fresnel(np.cos(incidence), ETA)
        assert wall.share[0] == pytest.approx(kept**order, rel=0.05)
        assert wall.let_out[0] == pytest.approx(1 - kept, abs=0.01)
    assert found.walls


def test_no_light_is_made_and_none_is_lost(rng):
    ball = md.samples.golf_ball(4_000)
    towards = -ball.normals + 0.6 * rng.normal(size=ball.normals.shape)
    towards[np.einsum("ij,ij->i", towards, ball.normals) > 0] *= -1
    at = ball.vertices - 1e-3 * ball.normals
    left = []
    for walls in (1, 2, 6):
        found = follow(ball, at, towards, walls=walls)
        total = found.rest.astype(float)
        for wall in found.walls:
            total[wall.ray] += wall.share * wall.let_out
            assert (wall.let_out <= 1).all()
            assert (wall.let_out >= 0).all()
            np.testing.assert_allclose(np.linalg.norm(wall.leaving, axis=1), 1, atol=1e-5)
        np.testing.assert_allclose(total, 1, atol=1e-4)
        assert len(found.walls) >= min(walls, 2)
        left.append(found.rest.mean())
    assert left[0] > left[1] > left[2] > 0  # what goes round in a ball never gets out


def test_what_does_not_refract_is_not_there(rng):
    ball = md.samples.golf_ball(2_000)
    towards = rng.normal(size=ball.normals.shape)
    towards[np.einsum("ij,ij->i", towards, ball.normals) > 0] *= -1
    found = follow(ball, 0.9 * ball.vertices, towards, refraction=1.0)
    (wall,) = found.walls
    np.testing.assert_allclose(wall.leaving, wall.arriving, atol=1e-5)
    assert np.median(wall.let_out) == 1


def test_a_ray_that_finds_no_wall_leaves_as_it_goes():
    sheet = md.samples.wavy_sheet(100, amplitude=0)
    down = follow(sheet, (0, 0, -0.1), (0.2, 0, -1), walls=3)
    assert not down.walls
    np.testing.assert_array_equal(down.rest, 1)
    # From outside a face is none, and the next one is.
    ball = md.samples.sphere(500)
    through = follow(ball, (0, 0, 3), (0, 0.01, -1))
    (wall,) = through.walls
    assert wall.normal[0, 2] < -0.9


def test_rays_spread_by_what_a_wall_bends():
    mesh, normals = box()
    flat = follow(mesh, (0.5, 0.5, 0.5), (0, 0, -1), normals=normals, cones=([0.01], [0.1]))
    assert flat.walls[0].spread[0] == pytest.approx(ETA * 0.1, rel=1e-5)
    ball = md.samples.sphere(4_000)
    bent = follow(ball, (0, 0, 0.5), (0.01, 0, -1), cones=([0.01], [0.0]))
    assert bent.walls[0].spread[0] == pytest.approx(0.5 * 0.01 * ball.diagonal, rel=0.02)
