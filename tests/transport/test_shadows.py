"""Shadows of lights and of discs against where they must fall."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictError
from meshdepict.transport.shadows import seen_share

UP = np.array([0.0, 0.0, 1.0])


def towards(tilt, azimuth=0.0):
    tilt, azimuth = np.radians([tilt, azimuth])
    return np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])


def plate_over_floor(height=0.5, half=1.0, reach=10.0):
    """A square plate that floats over the middle of a floor."""
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    vertices = np.vstack([reach * square, half * square + height * UP])
    return md.Mesh(vertices, np.vstack([faces, faces + 4]), winding="keep")


def on_floor(mesh, points):
    """Points of the floor, in the mesh's frame, and their normals."""
    points = np.column_stack([points, np.zeros(len(points))])
    return mesh.recentred(points), np.tile(UP, (len(points), 1))


@pytest.mark.parametrize(("tilt", "azimuth"), [(0, 0), (30, 40), (60, 200), (75, 300)])
def test_a_shadow_falls_where_the_light_is_hidden(rng, tilt, azimuth):
    mesh, light = plate_over_floor(), towards(tilt, azimuth)
    points = rng.uniform(-4, 4, (3_000, 2))
    seen = seen_share(mesh, light, at=on_floor(mesh, points))
    through = np.abs(points + 0.5 * light[:2] / light[2])
    np.testing.assert_array_equal(seen, (through > 1).any(axis=1))
    assert 0 < seen.mean() < 1


def test_half_of_a_disc_is_seen_over_an_edge_and_a_segment_beside_it():
    mesh = plate_over_floor(height=1.0, half=5.0)
    # The sun overhead, and the plate's edge at angles from it: beyond a chord of a disc of
    # half-angle s, the share arccos(d)/π − d √(1 − d²)/π is left, d = tan(angle)/tan(s).
    spread = 10.0
    for angle in (-12.0, -7.0, -3.0, 0.0, 4.0, 8.0, 12.0):
        x = 5.0 - np.tan(np.radians(angle))
        d = np.clip(np.tan(np.radians(angle)) / np.tan(np.radians(spread)), -1, 1)
        exact = (np.arccos(d) - d * np.sqrt(1 - d * d)) / np.pi
        found = seen_share(mesh, UP, at=on_floor(mesh, [[x, 0.0]]), spread=spread, rays=4096)
        assert found[0] == pytest.approx(exact, abs=0.01)


def test_a_convex_object_has_no_shadow_but_its_own_dark_side(sphere):
    light = towards(40, 70)
    at = sphere.unit_points, sphere.normals
    cosine = sphere.normals @ light
    seen = seen_share(sphere, light, at=at)
    assert not seen[cosine <= 0].any()
    assert seen[cosine > 0.01].all()
    soft = seen_share(sphere, light, at=at, spread=20, rays=64)
    # Just as the sun sets: seen whole until its lower rim meets the horizon.
    assert soft[cosine > np.sin(np.radians(20)) + 0.02].min() == 1
    assert not soft[cosine < -np.sin(np.radians(20)) - 0.02].any()
    setting = np.abs(cosine) < 0.02
    assert soft[setting].mean() == pytest.approx(0.5, abs=0.05)


def test_a_small_disc_is_the_light_itself(ball):
    light, at = towards(60, 10), (ball.unit_points, ball.normals)
    hard = seen_share(ball, light, at=at)
    soft = seen_share(ball, light, at=at, spread=0.01, rays=8)
    assert 0.2 < hard.mean() < 0.7
    assert np.abs(hard - soft).mean() < 0.005


def test_no_sheet_shades_itself():
    # A sheet twice, one turned: its sides lie on each other.
    sheet = md.samples.wavy_sheet(900)
    count = len(sheet.vertices)
    double = md.Mesh(
        np.vstack([sheet.vertices, sheet.vertices]),
        np.vstack([sheet.faces, sheet.faces[:, ::-1] + count]),
        winding="keep",
    )
    normals = np.vstack([sheet.normals, -sheet.normals])
    for far in (0.0, 2.0**19):
        mesh = md.Mesh(double.vertices + far, double.faces, winding="keep")
        seen = seen_share(mesh, UP, at=(mesh.unit_points, normals))
        up = normals @ UP
        assert seen[up > 0.05].all()
        assert not seen[up <= 0].any()


def test_a_box_on_a_table_does_not_darken_its_own_foot():
    # Vertices of the box lie within the table's faces.
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T.astype(float)
    table = np.array([[-5, -5, 0], [6, -5, 0], [6, 6, 0], [-5, 6, 0]], float)
    from scipy.spatial import ConvexHull

    hull = ConvexHull(corners)
    faces = hull.simplices.copy()
    normal = np.cross(
        corners[faces[:, 1]] - corners[faces[:, 0]], corners[faces[:, 2]] - corners[faces[:, 0]]
    )
    inward = np.einsum("ij,ij->i", normal, hull.equations[:, :3]) < 0
    faces[inward] = faces[inward, ::-1]
    mesh = md.Mesh(
        np.vstack([table, corners]),
        np.vstack([[[0, 1, 2], [0, 2, 3]], faces + 4]),
        winding="keep",
    )
    foot = 4 + np.flatnonzero(corners[:, 2] == 0)
    outwards = corners[foot - 4] - 0.5
    outwards[:, 2] = 0
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    for normal, place in zip(outwards, mesh.unit_points[foot], strict=True):
        light = normal + 0.5 * UP
        seen = seen_share(mesh, light / np.linalg.norm(light), at=(place[None], normal[None]))
        assert seen == 1


def test_wrong_numbers_of_rays_are_refused(ball):
    at = ball.unit_points, ball.normals
    with pytest.raises(MeshdepictError, match="is not a whole number from 2 to 65536"):
        seen_share(ball, UP, at=at, spread=5, rays=1)


def test_light_does_not_leak_through_the_foot_of_a_wall():
    # Floor and wall have vertices of their own along the edge where they meet, as creases make.
    floor = np.array([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0]], float)
    wall = np.array([[0, 0, 0], [0, 1, 0], [0, 1, 4], [0, 0, 4]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    mesh = md.Mesh(np.vstack([floor, wall]), np.vstack([faces, faces + 4]), winding="keep")
    normals = np.repeat([UP, [1.0, 0, 0]], 4, axis=0)
    foot = [0, 3]
    for tilt in (20, 45, 70):
        at = mesh.unit_points, normals
        behind, before = (seen_share(mesh, towards(tilt, a), at=at) for a in (180, 0))
        assert not behind[foot].any()
        assert (before == 1).all()
