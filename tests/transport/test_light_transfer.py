"""Light from surface to surface against exact answers, a slow twin, and its own stated error."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import threads
from meshdepict.errors import MeshdepictError
from meshdepict.files import limits
from meshdepict.scene.environment import Environment
from meshdepict.transport.radiosity import bounced
from meshdepict.transport.rays import AGAIN, FIRST, MOST_RAYS, RaySet, cosine_weighted
from meshdepict.transport.sky_cells import ACROSS, cell, cell_directions, parted_sky
from meshdepict.transport.transfer import traced_transfer


def furnace(count=800):
    """A sphere wound inwards: closed, and seen from within."""
    outside = md.samples.sphere(count)
    return md.Mesh(outside.vertices, outside.faces[:, ::-1], winding="keep")


def facing_discs(height, count=64, rings=12):
    """Two unit discs that face each other, the lower one's middle first."""
    angle = 2 * np.pi * np.arange(count) / count
    around = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    radii = np.arange(1, rings + 1) / rings
    disc = np.vstack([[[0, 0, 0]], *(radius * around for radius in radii)])
    first, after = np.arange(count), (np.arange(count) + 1) % count
    faces = [np.stack([0 * first, 1 + first, 1 + after], axis=1)]
    for ring in range(rings - 1):
        a, b = 1 + ring * count + first, 1 + ring * count + after
        faces += [np.stack([a, a + count, b], 1), np.stack([b, a + count, b + count], 1)]
    lower = np.vstack(faces)
    upper = lower[:, ::-1] + len(disc)
    return md.Mesh(
        np.vstack([disc, disc + np.array([0, 0, height])]),
        np.vstack([lower, upper]),
        winding="keep",
    )


def ones(transfer):
    return np.ones(len(transfer), np.float32)


def sky(brightness=1.0):
    return Environment(np.full((16, 32, 3), brightness, np.float32))


# --- the operator -----------------------------------------------------------------------------


def test_a_ray_finds_what_a_slow_twin_finds():
    mesh = md.samples.torus(200)
    transfer = traced_transfer(mesh, rays=32)
    points, normals = mesh.unit_points, mesh.normals
    origins, directions = RaySet(32, cosine_weighted).leaving(points, normals, normals, FIRST)
    corners = points[mesh.faces]
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    values = np.cos(np.arange(len(points)))  # of no pattern that another corner would have, too
    expected, open_to_sky = np.zeros(len(points)), np.zeros(len(points))
    for i, bundle in enumerate(directions.astype(float)):
        for direction in bundle:
            start = origins[i * 32].astype(float)
            # Möller and Trumbore 1997.
            p = np.cross(direction, v)
            scale = 1 / np.einsum("ij,ij->i", u, p)
            s = start - a
            second = scale * np.einsum("ij,ij->i", s, p)
            q = np.cross(s, u)
            third, distance = scale * (q @ direction), scale * np.einsum("ij,ij->i", v, q)
            met = (second >= 0) & (third >= 0) & (second + third <= 1) & (distance > 0)
            if not met.any():
                open_to_sky[i] += 1 / 32
                continue
            f = np.flatnonzero(met)[distance[met].argmin()]
            weights = np.array([1 - second[f] - third[f], second[f], third[f]])
            expected[i] += weights @ values[mesh.faces[f]] / 32
    assert 0.02 < 1 - open_to_sky.mean() < 0.5
    # A ray in a thousand may pass the other side of an edge in single precision.
    close = np.abs(transfer.from_surface(values) - expected) < 2e-4
    assert close.mean() > 0.97
    assert (np.abs(transfer.sky_share - open_to_sky) < 1e-6).mean() > 0.97


@pytest.mark.parametrize("height", [0.5, 1.0, 2.0])
def test_a_disc_is_seen_by_its_view_factor(height):
    mesh = facing_discs(height)
    seen = traced_transfer(mesh, rays=4096).from_surface(np.ones(len(mesh.vertices)))
    assert seen[0] == pytest.approx(1 / (1 + height**2), abs=0.005)


def test_no_light_goes_from_a_convex_object_to_itself(sphere):
    transfer = traced_transfer(sphere, rays=64)
    # Rays along the horizon may graze the facets next to their vertex.
    assert transfer.from_surface(ones(transfer)).max() < 0.02
    assert transfer.sky_share.min() > 0.98


def test_light_between_two_places_is_the_same_both_ways():
    torus = md.samples.torus(4_000)
    transfer = traced_transfer(torus, rays=256)
    x, y, z = torus.unit_points.T
    areas = torus.unit_areas
    for u, v in ((1 + x, 1 + y * z), (x**2, 1 + z), (np.ones_like(x), np.abs(x + y))):
        there = (areas * u) @ transfer.from_surface(v).astype(float)
        back = (areas * v) @ transfer.from_surface(u).astype(float)
        assert there == pytest.approx(back, rel=0.01)


def test_light_adds_up_and_colours_stay_apart(ball, rng):
    transfer = traced_transfer(ball, rays=16)
    one, other = rng.random((2, len(transfer), 3)).astype(np.float32)
    both = transfer.from_surface(one + 2 * other)
    parts = transfer.from_surface(one) + 2 * transfer.from_surface(other)
    np.testing.assert_allclose(both, parts, atol=1e-5)
    np.testing.assert_array_equal(
        transfer.from_surface(one)[:, 1], transfer.from_surface(one[:, 1])
    )


def test_a_back_sends_nothing_but_where_the_surface_is_open():
    floor = facing_discs(0.5)
    half = len(floor.vertices) // 2
    lower = floor.faces[floor.faces[:, 0] < half]
    lid = lower + half  # wound as the floor: it shows it its back
    mesh = md.Mesh(floor.vertices, np.vstack([lower, lid]), winding="keep")
    transfer = traced_transfer(mesh, rays=256)
    assert transfer.from_surface(ones(transfer))[0] == pytest.approx(0.8, abs=0.02)
    # A vertex within a closed ball sees backs alone, and no sky.
    ball = md.samples.sphere(300)
    inner = 0.2 * md.samples.sphere(100).vertices
    both = md.Mesh(
        np.vstack([ball.vertices, inner]),
        np.vstack([ball.faces, md.samples.sphere(100).faces + len(ball.vertices)]),
        winding="keep",
    )
    hidden = traced_transfer(both, rays=32)
    within = slice(len(ball.vertices), None)
    assert not hidden.from_surface(ones(hidden))[within].any()
    assert not hidden.sky_share[within].any()


def test_turned_faces_carry_the_light_of_their_own_corners():
    mesh = md.samples.torus(600)
    faces = mesh.faces.copy()
    faces[::3] = faces[::3, ::-1]
    mixed = md.Mesh(mesh.vertices, faces)
    with pytest.warns(md.MeshdepictWarning, match="winding"):
        normals = mixed.normals
    np.testing.assert_allclose(normals, mesh.normals, atol=1e-12)
    values = np.cos(np.arange(len(mesh.vertices)))
    one = traced_transfer(mesh, rays=64).from_surface(values)
    other = traced_transfer(mixed, rays=64).from_surface(values)
    assert (np.abs(one - other) < 2e-4).mean() > 0.97


# --- bounces ----------------------------------------------------------------------------------


@pytest.mark.parametrize("bounces", [0, 1, 3, 8])
def test_a_closed_furnace_glows_as_a_geometric_series(bounces):
    transfer = traced_transfer(furnace(), rays=64)
    albedo = 0.8
    arriving, _ = bounced(transfer, 0 * ones(transfer), albedo=albedo, bounces=bounces, emitted=1)
    exact = (1 - albedo ** (bounces + 1)) / (1 - albedo)
    np.testing.assert_allclose(1 + albedo * arriving, exact, rtol=2e-3)


def test_in_a_white_furnace_nothing_is_seen():
    torus = md.samples.torus(1_500)
    transfer = traced_transfer(torus, rays=64)
    light = transfer.from_sky(sky())[:, 0]
    assert light.min() < 0.8
    arriving, _ = bounced(transfer, light, albedo=1.0, bounces=60)
    np.testing.assert_allclose(arriving, 1, atol=2e-3)
    assert arriving.max() < 1 + 1e-4  # energy never grows


def test_bounces_are_linear_in_light_and_none_leaves_it_alone(ball, rng):
    transfer = traced_transfer(ball, rays=16)
    one, other = rng.random((2, len(transfer))).astype(np.float32)

    def arriving(light, bounces=3):
        return bounced(transfer, light, albedo=0.7, bounces=bounces)[0]

    np.testing.assert_array_equal(arriving(one, 0), one)
    np.testing.assert_allclose(arriving(one + other), arriving(one) + arriving(other), atol=1e-5)
    assert (arriving(one, 2) >= arriving(one, 1)).all()


def test_bounces_are_what_dense_radiosity_finds(rng):
    mesh = md.samples.torus(200)
    transfer = traced_transfer(mesh, rays=64)
    count = len(transfer)
    dense = transfer.from_surface(np.eye(count))
    albedo, light = rng.random((2, count))
    exact = np.linalg.solve(np.eye(count) - dense * albedo, light)
    np.testing.assert_allclose(
        bounced(transfer, light, albedo=albedo, bounces=60)[0], exact, rtol=1e-4
    )


def room(count=12):
    """A unit cube seen from within: six walls with vertices of their own, areas and normals."""
    along = np.linspace(0, 1, count + 1)
    weight = np.full(count + 1, 1 / count)
    weight[[0, -1]] /= 2
    u, v = (part.ravel() for part in np.meshgrid(along, along, indexing="ij"))
    corner = (np.arange(count)[:, None] * (count + 1) + np.arange(count)).ravel()
    quads = np.stack([corner, corner + count + 1, corner + count + 2, corner + 1], axis=1)
    faces = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    points, normals, triangles = [], [], []
    for axis in range(3):
        for side in (0.0, 1.0):
            place = np.empty((len(u), 3))
            place[:, axis], place[:, axis - 2], place[:, axis - 1] = side, u, v
            inward = np.zeros_like(place)
            inward[:, axis] = 1 - 2 * side
            triangles.append((faces if side == 0 else faces[:, ::-1]) + sum(map(len, points)))
            points.append(place)
            normals.append(inward)
    mesh = md.Mesh(np.vstack(points), np.vstack(triangles), winding="keep")
    return mesh, np.vstack(normals), np.outer(weight, weight).ravel()


def test_walls_of_a_room_send_each_other_what_view_factors_say():
    mesh, normals, areas = room()
    transfer = traced_transfer(mesh, normals=normals, rays=256)
    wall = np.repeat(np.arange(6), len(areas))
    seen = transfer.from_surface(np.eye(6)[wall])  # from the walls at once, each a colour
    factors = np.einsum("p,wpc->wc", areas, seen.reshape(6, len(areas), 6))
    exact = np.full((6, 6), 0.20004) - 0.20004 * np.eye(6)  # of two unit squares with one edge
    exact[np.arange(6), np.arange(6) ^ 1] = 0.19982  # of those that face each other
    np.testing.assert_allclose(factors, exact, atol=0.004)
    np.testing.assert_allclose(factors.sum(axis=1), 1, atol=0.003)


def test_coloured_walls_tint_the_others_as_the_radiosity_of_the_room_does(rng):
    mesh, normals, areas = room(8)
    transfer = traced_transfer(mesh, normals=normals, rays=256)
    wall = np.repeat(np.arange(6), len(areas))
    albedo, emitted = rng.uniform(0, 0.8, (6, 3)), np.zeros((6, 3))
    emitted[3] = 1, 0.9, 0.7  # the ceiling
    light = np.zeros((len(transfer), 3))
    arriving, _ = bounced(transfer, light, albedo=albedo[wall], emitted=emitted[wall], bounces=60)
    found = np.einsum("p,wpc->wc", areas, arriving.reshape(6, len(areas), 3))
    # As patches that see each other from middle to middle, all that leaves one arriving somewhere.
    middle = (np.arange(8) + 0.5) / 8
    u, v = (part.ravel() for part in np.meshgrid(middle, middle))
    centres, towards, patch = [], [], np.repeat(np.arange(6), 64)
    for axis in range(3):
        for side in (0.0, 1.0):
            place = np.empty((64, 3))
            place[:, axis], place[:, axis - 2], place[:, axis - 1] = side, u, v
            centres.append(place)
            towards.append(np.tile((1 - 2 * side) * np.eye(3)[axis], (64, 1)))
    apart = np.vstack(centres)[None] - np.vstack(centres)[:, None]
    square = (apart**2).sum(axis=2) + np.eye(384)
    leaving = np.einsum("ijk,ik->ij", apart, np.vstack(towards))
    arriving_at = -np.einsum("ijk,jk->ij", apart, np.vstack(towards))
    factors = np.maximum(leaving, 0) * np.maximum(arriving_at, 0) / square**2
    factors /= factors.sum(axis=1, keepdims=True)
    for channel in range(3):
        sent = np.linalg.solve(
            np.eye(384) - albedo[patch, channel, None] * factors, emitted[patch, channel]
        )
        exact = (factors @ sent).reshape(6, 64).mean(axis=1)
        np.testing.assert_allclose(found[:, channel], exact, rtol=0.05)


# --- the sky ----------------------------------------------------------------------------------


def test_a_direction_lies_in_its_cell():
    directions = cell_directions()
    assert len(directions) == ACROSS**2
    some = np.arange(0, len(directions), 61)
    assert [cell.py_func(*directions[i]) for i in some] == list(some)
    # Neighbours are nowhere far: every direction is within a degree of the middle of its cell.
    rng = np.random.default_rng(1)
    any_ones = rng.normal(size=(2_000, 3))
    any_ones /= np.linalg.norm(any_ones, axis=1, keepdims=True)
    for one in any_ones:
        assert directions[cell.py_func(*one)] @ one > np.cos(np.radians(1))


@pytest.mark.parametrize("up", ["y", "z"])
def test_a_sky_is_what_an_open_sphere_gathers_of_it(sphere, rng, up):
    pixels = rng.random((8, 16, 3)).astype(np.float32).repeat(32, 0).repeat(32, 1)
    environment = Environment(pixels, up=up)
    gathered = traced_transfer(sphere, rays=1024).from_sky(environment)
    exact = environment.irradiance(sphere.normals) / np.pi
    # Nine harmonics alone are the coarser of the two: about 1 % of the mean.
    assert np.sqrt(np.mean((gathered - exact) ** 2)) < 0.02
    assert gathered.mean() == pytest.approx(exact.mean(), rel=0.005)


def test_lamps_in_a_sky_are_lights_and_both_together_are_the_sky(rng):
    pixels = rng.random((32, 64, 3)).astype(np.float32)
    pixels[4:6, 10:13] = 500, 400, 300
    environment = Environment(pixels, up="z")
    sky, lamps = parted_sky(environment)
    assert parted_sky(environment)[0] is sky
    assert sky.up == "z"
    assert sky.brightest < environment.brightest / 5
    normals = rng.normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lit = sum(np.maximum(normals @ lamp.direction, 0)[:, None] * lamp.color for lamp in lamps)
    exact = sum(
        np.maximum(normals @ one.direction, 0)[:, None] * one.color
        for one in environment.lights(4096)
    )
    found = lit + sum(
        np.maximum(normals @ one.direction, 0)[:, None] * one.color for one in sky.lights(4096)
    )
    np.testing.assert_allclose(found, exact, atol=0.01 * exact.max())
    # Where nothing is brighter than the rest there is no lamp.
    even = Environment(np.ones((16, 32, 3)))
    assert parted_sky(even) == (even, [])


def test_a_sky_of_one_radiance_gives_it_where_it_is_open():
    torus = md.samples.torus(800)
    transfer = traced_transfer(torus, rays=32)
    np.testing.assert_allclose(
        transfer.from_sky(sky(2.5)), np.repeat(2.5 * transfer.sky_share[:, None], 3, 1), rtol=1e-5
    )
    np.testing.assert_array_equal(transfer.sky_share, md.scale_space(torus, scales=0).occlusion(32))


# --- what it costs, and how sure it is --------------------------------------------------------


def light_of(transfer, bounces=1):
    """Light from above and its bounces."""
    direct = np.maximum(transfer.normals[:, 2], 0)
    return bounced(transfer, direct, albedo=0.8, bounces=bounces)


@pytest.mark.parametrize("bounces", [1, 3])
def test_the_estimate_is_what_the_rays_err(bounces):
    mesh = md.samples.torus(1_500)
    exact, _ = light_of(traced_transfer(mesh, rays=4096), bounces)
    for rays in (16, 64):
        transfer = traced_transfer(mesh, rays=rays)
        found, sent = light_of(transfer, bounces)
        probes = transfer.probes
        direct = np.maximum(transfer.normals[probes.chosen, 2], 0)
        error = probes.error(found, direct + probes.transfer.from_surface(sent))
        true = np.sqrt(np.mean((found - exact) ** 2))
        assert 0.8 * true <= error <= 1.25 * true


def test_the_estimate_is_true_on_scans(data):
    for name in ("fandisk_13k", "gears_19k", "bunny_69k"):
        mesh = md.read(data / "mesh" / f"{name}.ply")
        exact, _ = light_of(traced_transfer(mesh, rays=1024))
        transfer = traced_transfer(mesh, rays=64)
        found, sent = light_of(transfer)
        direct = np.maximum(transfer.normals[transfer.probes.chosen, 2], 0)
        error = transfer.probes.error(found, direct + transfer.probes.transfer.from_surface(sent))
        true = np.sqrt(np.mean((found - exact) ** 2))
        assert 0.8 * true <= error <= 1.25 * true, name


def test_a_second_set_is_another(ball):
    transfer = traced_transfer(ball, rays=16)
    again = transfer.probes
    assert len(again.chosen) >= 1024
    np.testing.assert_array_equal(again.transfer.points, ball.unit_points[again.chosen])
    assert (again.transfer.sky_share != transfer.sky_share[again.chosen]).any()
    normals = ball.normals
    one, other = (
        RaySet(16, cosine_weighted).leaving(ball.unit_points, normals, normals, steps).directions
        for steps in (FIRST, AGAIN)
    )
    assert np.abs(one - other).max() > 0.1


def test_it_is_as_small_as_it_says(ball):
    transfer = traced_transfer(ball, rays=64)
    samples = len(transfer)
    hits, misses = len(transfer.triangle), len(transfer.sky)
    assert 0 < hits + misses <= 64 * samples
    assert transfer.nbytes == 8 * hits + 2 * misses + 16 * (samples + 1)
    try:
        limits.set_max_memory(16 * 64 * samples - 1)
        with pytest.raises(
            MeshdepictError, match=r"rays=64 from .* samples may take .* take fewer"
        ):
            traced_transfer(ball, rays=64)
    finally:
        limits.set_max_memory(None)


@pytest.mark.parametrize("rays", [1, 0, 2.5, True, MOST_RAYS + 1])
def test_wrong_numbers_of_rays_are_refused(ball, rays):
    with pytest.raises(MeshdepictError, match="is not a whole number from 2 to 65536"):
        traced_transfer(ball, rays=rays)


def test_neither_threads_nor_offset_nor_size_change_what_is_found(ball):
    transfer = traced_transfer(ball, rays=16)
    values = np.cos(np.arange(len(transfer)))
    try:
        threads.limit(1)
        alone = traced_transfer(ball, rays=16)
    finally:
        threads.limit(None)
    np.testing.assert_array_equal(alone.triangle, transfer.triangle)
    np.testing.assert_array_equal(alone.from_surface(values), transfer.from_surface(values))
    for moved in (ball.vertices + 2.0**19, ball.vertices * 2.0**-40):
        there = traced_transfer(md.Mesh(moved, ball.faces), rays=16)
        difference = there.sky_share - transfer.sky_share
        assert np.abs(difference.mean()) < 1e-3


def test_degenerate_meshes_have_finite_light():
    point = md.Mesh(np.zeros((3, 3)), [[0, 1, 2]])
    line = md.Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [5, 5, 5]], [[0, 1, 2]])
    for mesh in (point, line):
        transfer = traced_transfer(mesh, rays=8)
        assert np.isfinite(transfer.from_surface(ones(transfer))).all()
        assert np.isfinite(transfer.from_sky(sky())).all()
