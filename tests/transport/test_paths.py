"""Rays from mirror to mirror against exact geometry: plates, corners, spheres, and what is matt."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.transport.paths import (
    AWAY,
    HIDDEN,
    mirrored_paths,
    starting,
)
from meshdepict.transport.rays import lifted
from meshdepict.transport.walls import between, turning, walls_of


def plate(corners, cells=4):
    """Points and faces of a flat plate: a corner, and its two sides."""
    start, right, up = np.asarray(corners, float)
    share = np.linspace(0, 1, cells + 1)
    points = start + share[:, None, None] * right + share[None, :, None] * up
    at = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    return points.reshape(-1, 3), np.vstack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def plates(*corners, place=1.0, move=0.0):
    """A mesh of several plates; which plate every face is of."""
    parts = [plate(each) for each in corners]
    before = np.cumsum([0, *(len(points) for points, _ in parts)])
    faces = [part + first for (_, part), first in zip(parts, before, strict=False)]
    points = np.vstack([points for points, _ in parts])
    mesh = md.Mesh(points * place + move, np.vstack(faces), winding="keep")
    return mesh, np.repeat(np.arange(len(parts)), [len(part) for part in faces])


def follow(mesh, at, towards, place=1.0, move=0.0, **options):
    """Follow rays from positions in the plates' own units."""
    directions = np.atleast_2d(np.asarray(towards, float))
    directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    points = mesh.recentred(np.atleast_2d(np.asarray(at, float)) * place + move)
    normals = options.pop("normals", mesh.normals)
    return mirrored_paths(mesh, points, directions, normals=normals, **options)


def own_rays(mesh, rng):
    """Rays that the vertices of a mesh mirror from somewhere."""
    eyes = rng.normal(size=mesh.normals.shape)
    eyes /= np.linalg.norm(eyes, axis=1, keepdims=True)
    eyes *= np.sign(np.einsum("ij,ij->i", eyes, mesh.normals))[:, None]
    looks = 2 * np.einsum("ij,ij->i", eyes, mesh.normals)[:, None] * mesh.normals - eyes
    return starting(mesh.unit_points, lifted(mesh.unit_points, mesh.normals), looks), looks


def inward(count):
    outside = md.samples.sphere(count)
    return md.Mesh(outside.vertices, outside.faces[:, ::-1], winding="keep")


FLOOR = ((-1, -1, 0), (2, 0, 0), (0, 2, 0))
LID = ((-1, -1, 0.5), (0, 2, 0), (2, 0, 0))  # faces the floor


# --- exact ways -------------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", [0.11, 0.23, 0.4])
def test_between_two_facing_mirrors_a_ray_goes_to_and_fro_until_it_is_out(tilt):
    mesh, _ = plates(FLOOR, LID)
    paths = follow(mesh, (0, 0, 0.25), (tilt, 0, 1), bounces=100, hidden=True)
    # The lid is met at x = 0.25 tilt, and from there every 0.5 tilt.
    times = int((1 - 0.25 * tilt) / (0.5 * tilt)) + 1
    assert sum(len(met.ray) for met in paths.mirrored) == times
    expected = np.array([tilt, 0, 1 if times % 2 == 0 else -1])
    np.testing.assert_allclose(paths.directions[0], expected / np.hypot(tilt, 1), atol=1e-6)
    assert paths.triangle[0] == AWAY
    few = follow(mesh, (0, 0, 0.25), (tilt, 0, 1), bounces=times - 1, hidden=True)
    assert few.triangle[0] == HIDDEN
    free = follow(mesh, (0, 0, 0.25), (tilt, 0, 1), bounces=times - 1)
    assert free.triangle[0] == AWAY
    np.testing.assert_allclose(free.directions[0, 2], -paths.directions[0, 2], atol=1e-6)


@pytest.mark.parametrize(("place", "move"), [(1.0, 0.0), (1e-7, 0.0), (1.0, 1e6), (1e9, -1e12)])
def test_a_corner_of_three_mirrors_sends_light_back_to_where_it_came_from(rng, place, move):
    x, y, z = np.eye(3)
    mesh, _ = plates((0 * x, x, y), (0 * x, y, z), (0 * x, z, x), place=place, move=move)
    away = -rng.uniform(0.3, 1, size=(50, 3))
    at = rng.uniform(0.05, 0.15, size=(50, 3))
    flat = np.repeat([z, x, y], 25, axis=0)  # where plates meet each has its own
    paths = follow(mesh, at, away, place=place, move=move, normals=flat, bounces=3, hidden=True)
    assert [len(met.ray) for met in paths.mirrored] == [50, 50, 50]
    straight = away / np.linalg.norm(away, axis=1, keepdims=True)
    # Far away vertices are rounded: plates are not quite plane.
    np.testing.assert_allclose(paths.directions, -straight, atol=5e-4 if move else 1e-5)
    assert (paths.triangle == AWAY).all()


def test_a_mirror_shows_the_place_on_a_matt_floor_that_geometry_says(rng):
    mesh, part = plates(FLOOR, ((-0.2, -0.2, 0.5), (0, 0.4, 0), (0.4, 0, 0)))
    at = np.column_stack([rng.uniform(-0.1, 0.1, (40, 2)), np.full(40, 0.3)])
    to = np.column_stack([rng.uniform(-0.18, 0.18, (40, 2)), np.full(40, 0.5)])
    paths = follow(mesh, at, to - at, mirrors=part == 1, bounces=2)
    assert (part[paths.triangle] == 0).all()
    assert len(paths.mirrored[0].ray) == 40
    image = at + (to - at) * (0.7 / 0.2)  # of the floor, 0.5 behind the mirror
    found = between(mesh.vertices, mesh.faces[paths.triangle], paths.weights)
    # Rays begin a hundred-thousandth of the diagonal, 2.9, off the mirror.
    np.testing.assert_allclose(found[:, :2], image[:, :2], atol=1e-4)
    np.testing.assert_allclose(found[:, 2], 0, atol=1e-6)


def test_within_a_closed_mirror_nothing_gets_out_and_every_chord_is_like_the_last(rng):
    ball = inward(8_000)
    starts, looks = own_rays(ball, rng)
    paths = mirrored_paths(ball, starts, looks, normals=ball.normals, bounces=6, hidden=True)
    assert (paths.triangle == HIDDEN).all()
    walls = walls_of(ball)
    steep = np.abs(np.einsum("ij,ij->i", looks, ball.normals)) > 0.5
    at = {}
    for met in paths.mirrored:
        place = between(ball.unit_points, walls.faces[met.triangle], met.weights)
        for ray, here in zip(met.ray, place, strict=True):
            at.setdefault(ray, []).append(here)
    for ray in np.flatnonzero(steep):
        places = np.array([ball.unit_points[ray], *at[ray]])
        chords = np.linalg.norm(np.diff(places, axis=0), axis=1)
        # Triangles are 0.04 radii wide, and their planes lie that much squared over 8 inside.
        assert np.ptp(chords) < 0.01 * chords.mean()


def test_a_convex_mirror_does_not_see_itself(sphere, rng):
    starts, looks = own_rays(sphere, rng)
    for bounces in (0, 1, 4):
        paths = mirrored_paths(
            sphere, starts, looks, normals=sphere.normals, bounces=bounces, hidden=True
        )
        assert (paths.triangle == AWAY).all()
        assert not paths.mirrored
        np.testing.assert_array_equal(paths.directions, looks.astype(np.float32))


# --- sides ------------------------------------------------------------------------------------


def test_a_plate_mirrors_on_both_sides_and_is_matt_on_both():
    mesh, _ = plates(FLOOR)
    for z in (0.3, -0.3):
        paths = follow(mesh, (0.1, 0.1, z), (0.2, 0, -z), bounces=1)
        assert np.sign(paths.directions[0, 2]) == np.sign(z)
        matt = follow(mesh, (0.1, 0.1, z), (0.2, 0, -z), mirrors=np.zeros(32, bool), bounces=1)
        assert matt.triangle[0] >= 0


def test_backs_of_what_is_closed_are_no_mirrors_and_send_nothing():
    ball = md.samples.sphere(500)
    within = {"at": (0.1, 0.2, 0.0), "towards": (0.3, 0.5, 0.8), "bounces": 2, "hidden": True}
    out = follow(ball, **within)
    assert out.triangle[0] == AWAY
    assert not out.mirrored
    matt = follow(ball, **within, mirrors=np.zeros(len(ball.faces), bool))
    assert matt.triangle[0] == HIDDEN


def test_without_bounces_and_shadows_nothing_is_asked(sphere, monkeypatch):
    monkeypatch.setattr("meshdepict.transport.paths._step", None)
    paths = follow(sphere, (0, 0, 3), (0, 0, -1), bounces=0)
    assert paths.triangle[0] == AWAY
    np.testing.assert_array_equal(paths.directions, [[0, 0, -1]])


def test_a_mirrored_ray_stays_on_its_side_of_a_facet(rng):
    """Normals between corners may lean so far that a ray would go through the mirror."""
    mesh, _ = plates(FLOOR)
    leaning = np.broadcast_to([0.8, 0, 0.6], mesh.normals.shape)
    angle = np.linspace(0.02, np.pi - 0.02, 200)
    towards = np.stack([np.cos(angle), 0 * angle, -np.sin(angle)], axis=1)
    at = np.array([0.0, 0.1, 0.0]) - 5 * towards  # from farther away than what grazes its own facet
    paths = follow(mesh, at, towards, normals=leaning, bounces=1)
    steps = np.linalg.norm(np.diff(paths.directions, axis=0), axis=1)
    assert (paths.directions[:, 2] > -1e-6).all()
    assert steps.max() < 3.5 * angle[1] - 3 * angle[0]  # and goes round without a jump


# --- how far rays are apart -------------------------------------------------------------------


def test_rays_of_neighbours_spread_as_far_as_a_mirror_bends():
    mesh, _ = plates(FLOOR)
    flat = follow(mesh, (0, 0, 0.3), (0.2, 0.1, -1), bounces=1, cones=([0.01], [0.1]))
    assert flat.spread[0] == pytest.approx(0.1)
    ball = md.samples.sphere(4_000)
    radius = 1 / ball.diagonal
    bend = turning(ball, ball.normals)
    assert np.median(bend) == pytest.approx(1 / radius, rel=0.01)
    near = follow(ball, (0, 0, 1.001), (0.2, 0.1, -1), bounces=1, cones=([0.01], [0.0]))
    assert near.spread[0] == pytest.approx(2 * 0.01 / radius, rel=0.02)
    far = follow(ball, (0, 0, 3), (0, 0.01, -1), bounces=1, cones=([0.01], [0.1]))
    width = 0.01 + 0.1 * 2 * radius
    assert far.spread[0] == pytest.approx(0.1 + 2 * width / radius, rel=0.02)
