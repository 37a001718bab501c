"""Ambient occlusion and sky view against exact answers and their own stated errors."""

import numpy as np
import pytest
from conftest import rotation

import meshdepict as md
from meshdepict import threads
from meshdepict.errors import MeshdepictError
from meshdepict.transport import occlusion
from meshdepict.transport.occlusion import ambient_openness, sky_openness
from meshdepict.transport.rays import MOST_RAYS

UP = np.array([0.0, 0.0, 1.0])


def bowl(depth, count=40):
    """A floor at z = 0 in a tall cylinder's stead: a disc under a ring-shaped wall."""
    angle = 2 * np.pi * np.arange(count) / count
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    upper = ring + np.array([0, 0, depth])
    vertices = np.vstack([[[0, 0, 0]], ring, upper])
    a, b = 1 + np.arange(count), 1 + (np.arange(count) + 1) % count
    floor = np.stack([0 * a, a, b], axis=1)
    wall = np.vstack([np.stack([a, a + count, b], 1), np.stack([b, a + count, b + count], 1)])
    return md.Mesh(vertices, np.vstack([floor, wall]), winding="keep")


def test_nothing_hides_a_sphere_from_outside(sphere):
    openness = ambient_openness(sphere, rays=64)
    # Rays along the horizon may graze the facets next to their vertex.
    assert openness.values.min() > 0.98
    assert openness.error < 0.01


@pytest.mark.parametrize("depth", [0.5, 1.0, 2.0])
def test_the_floor_of_a_well_sees_the_solid_angle_of_its_mouth(depth):
    # Cosine-weighted, a disc of radius R at height h fills R²/(R² + h²) of the hemisphere.
    mesh = bowl(depth, count=200)
    share = 1 / (1 + depth**2)
    values, _ = ambient_openness(mesh, rays=4096)
    assert mesh.normals[0] == pytest.approx(UP)
    assert values[0] == pytest.approx(share, abs=0.005)
    assert sky_openness(mesh, UP, rays=4096).values[0] == pytest.approx(share, abs=0.005)


def open_sky(mesh, rays):
    return sky_openness(mesh, UP, rays=rays)


@pytest.mark.parametrize("openness", [ambient_openness, open_sky])
def test_more_rays_err_less_and_the_estimate_is_what_they_err(openness):
    torus = md.samples.torus(1_500)
    exact = openness(torus, rays=4096).values
    assert exact.min() < 0.7
    before = 1.0
    for rays in (16, 64, 256):
        values, error = openness(torus, rays=rays)
        true = np.sqrt(np.mean((values - exact) ** 2))
        assert 0.8 * true <= error <= 1.2 * true
        assert true < before / 2  # better than the half that independent rays would get
        before = true


def test_the_estimate_is_true_on_scans(data):
    for name in ("fandisk_13k", "gears_19k", "bunny_69k", "armadillo_86k"):
        mesh = md.read(data / "mesh" / f"{name}.ply")
        some = np.linspace(0, len(mesh.vertices) - 1, 1024).astype(int)
        at = mesh.vertices[some], mesh.normals[some]
        exact = ambient_openness(mesh, at=at, rays=4096).values
        for rays in (16, 128):
            values, error = ambient_openness(mesh, at=at, rays=rays)
            true = np.sqrt(np.mean((values - exact) ** 2))
            assert 0.8 * true <= error <= 1.2 * true, (name, rays)


def test_neither_threads_nor_order_nor_offset_change_a_value(ball, rng):
    values = ambient_openness(ball, rays=16).values
    try:
        threads.limit(1)
        np.testing.assert_array_equal(ambient_openness(ball, rays=16).values, values)
    finally:
        threads.limit(None)
    order = rng.permutation(len(ball.vertices))
    place = np.argsort(order)
    shuffled = md.Mesh(ball.vertices[order], place[ball.faces])
    # Normals are summed in another order, so single rays may graze the other way.
    same = ambient_openness(shuffled, rays=16).values == values[order]
    assert same.mean() > 0.99


def test_far_from_the_origin_nothing_is_lost(ball):
    there = md.Mesh(ball.vertices + 2.0**19, ball.faces)
    here = ambient_openness(ball, rays=256)
    difference = ambient_openness(there, rays=256).values - here.values
    assert np.abs(difference.mean()) < 1e-3
    assert difference.std() < 3 * here.error


def test_turning_changes_no_more_than_the_error(ball, rng):
    turn = rotation(rng)
    turned = md.Mesh(ball.vertices @ turn.T, ball.faces)
    for function, other in (
        (ambient_openness, ambient_openness),
        (
            lambda m, rays: sky_openness(m, UP, rays=rays),
            lambda m, rays: sky_openness(m, turn @ UP, rays=rays),
        ),
    ):
        here, there = function(ball, rays=256), other(turned, rays=256)
        rms = np.sqrt(np.mean((here.values - there.values) ** 2))
        assert rms <= 2 * (here.error + there.error)


def test_a_small_cap_of_sky_is_a_lamp(sphere):
    values = sky_openness(sphere, UP, spread=1.0, rays=64).values
    np.testing.assert_allclose(values, np.maximum(sphere.normals @ UP, 0), atol=0.02)


def test_an_open_plane_sees_the_part_of_the_sky_above_it():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], float)
    plane = md.Mesh(vertices, [[0, 1, 2], [1, 3, 2]], winding="keep")
    for tilt in (0, 40, 90, 140, 180):
        sky = np.array([np.sin(np.radians(tilt)), 0, np.cos(np.radians(tilt))])
        values = sky_openness(plane, sky, rays=4096).values
        np.testing.assert_allclose(values, (1 + np.cos(np.radians(tilt))) / 2, atol=0.01)


def test_degenerate_meshes_have_finite_values():
    point = md.Mesh(np.zeros((3, 3)), [[0, 1, 2]])
    line = md.Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [5, 5, 5]], [[0, 1, 2]])
    for mesh in (point, line):
        for values, error in (ambient_openness(mesh, rays=8), sky_openness(mesh, UP, rays=8)):
            assert ((values >= 0) & (values <= 1)).all()
            assert np.isfinite(error)


@pytest.mark.parametrize("rays", [1, 0, -5, 2.5, True, MOST_RAYS + 1])
def test_wrong_numbers_of_rays_are_refused(ball, rays):
    with pytest.raises(MeshdepictError, match="is not a whole number from 2 to 65536"):
        ambient_openness(ball, rays=rays)
    with pytest.raises(MeshdepictError, match="is not a whole number from 2 to 65536"):
        sky_openness(ball, UP, rays=rays)


def test_a_scale_space_computes_occlusion_once(ball, monkeypatch):
    calls = []
    real = occlusion.ambient_openness
    monkeypatch.setattr(
        occlusion, "ambient_openness", lambda *a, **k: calls.append(k["rays"]) or real(*a, **k)
    )
    space = md.scale_space(ball, scales=0)
    first = space.occlusion(8)
    assert space.occlusion(8) is first
    assert not first.flags.writeable
    space.occlusion(16)
    assert calls == [8, 16]


def test_nothing_leaks_through_the_creases_of_a_closed_room(rng):
    # Walls with vertices of their own, turned so that rounding is everywhere.
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    walls = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    )
    vertices = corners[walls.ravel()] @ turn.T
    quads = np.arange(24).reshape(6, 4)
    faces = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    inward = np.repeat([np.eye(3)[i // 2] * (1 - 2 * (i % 2)) for i in range(6)], 4, axis=0)
    room = md.Mesh(vertices, faces, winding="keep")
    middle = vertices.reshape(6, 4, 3).mean(axis=1)
    normals = inward @ turn.T
    # Each wall's normal looks to the room's middle.
    inwards = vertices.mean(axis=0) - np.repeat(middle, 4, axis=0)
    assert (np.einsum("ij,ij->i", inwards, normals) > 0).all()
    at = vertices, normals
    assert not ambient_openness(room, at=at).values.any()
    assert not sky_openness(room, normals, at=at, even=True).values.any()


def test_elsewhere_rays_start_where_they_always_did(ball, rng, monkeypatch):
    points, normals = ball.vertices, ball.normals
    twice = rng.integers(0, len(points), 900)  # some of them more than once, as along a seam
    found = [
        ambient_openness(ball, at=(points[some], normals[some]), rays=16).values
        for some in (np.arange(len(points)), twice)
    ]
    monkeypatch.setattr(occlusion, "lifted", lambda _, own: own)
    np.testing.assert_array_equal(ambient_openness(ball, rays=16).values, found[0])
    again = ambient_openness(ball, at=(points[twice], normals[twice]), rays=16).values
    np.testing.assert_array_equal(again, found[1])
