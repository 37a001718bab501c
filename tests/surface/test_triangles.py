import numpy as np
import pytest
from conftest import rotation, tetrahedron

from meshdepict import samples
from meshdepict.surface import triangles


def one(*corners):
    return np.array(corners, float), np.array([[0, 1, 2]])


def test_normals_are_exact_on_a_sphere(sphere):
    sums = triangles.normal_sums(sphere.vertices, sphere.faces)
    unit = sums / np.linalg.norm(sums, axis=1, keepdims=True)
    # Max's weights are exact for vertices on a sphere; what is left is rounding.
    np.testing.assert_allclose(unit, sphere.vertices, atol=1e-11)


def test_normals_are_exact_on_an_irregular_sphere(rng):
    from scipy.spatial import ConvexHull

    points = rng.normal(size=(300, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    faces = ConvexHull(points).simplices
    corners = points[faces]
    inward = (
        np.einsum(
            "ij,ij->i", np.cross(*(corners[:, 1:] - corners[:, :1]).swapaxes(0, 1)), corners[:, 0]
        )
        < 0
    )
    faces[inward] = faces[inward, ::-1]
    sums = triangles.normal_sums(points, faces)
    unit = sums / np.linalg.norm(sums, axis=1, keepdims=True)
    np.testing.assert_allclose(unit, points, atol=1e-10)


def test_voronoi_areas_follow_the_definition_in_an_acute_triangle():
    points, faces = one((0, 0, 0), (4, 0, 0), (1, 3, 0))
    areas = triangles.mixed_voronoi_areas(points, faces)
    a, b, c = points

    def cot(p, q, r):
        u, v = q - p, r - p
        return u @ v / np.linalg.norm(np.cross(u, v))

    expected = (
        ((b - a) @ (b - a) * cot(c, a, b) + (c - a) @ (c - a) * cot(b, a, c)) / 8,
        ((a - b) @ (a - b) * cot(c, a, b) + (c - b) @ (c - b) * cot(a, b, c)) / 8,
        ((a - c) @ (a - c) * cot(b, a, c) + (b - c) @ (b - c) * cot(a, b, c)) / 8,
    )
    np.testing.assert_allclose(areas, expected, rtol=1e-14)


def test_voronoi_areas_in_an_obtuse_triangle_are_a_half_and_two_quarters():
    points, faces = one((0, 0, 0), (2, 0, 0), (-3, 1, 0))  # obtuse at the first corner, area 1
    np.testing.assert_allclose(
        triangles.mixed_voronoi_areas(points, faces), [0.5, 0.25, 0.25], rtol=1e-14
    )


def test_voronoi_areas_in_a_right_triangle_agree_with_both_rules():
    points, faces = one((0, 0, 0), (2, 0, 0), (0, 1, 0))
    np.testing.assert_allclose(
        triangles.mixed_voronoi_areas(points, faces), [0.5, 0.25, 0.25], rtol=1e-14
    )


@pytest.mark.parametrize("name", ["bunny_69k", "gears_19k", "beetle_2k", "dragon_203k"])
def test_voronoi_areas_sum_to_the_area(data, name):
    from meshdepict.io import read_mesh

    mesh = read_mesh(data / "mesh" / f"{name}.ply")
    a, b, c = (mesh.unit_points[mesh.faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    areas = triangles.mixed_voronoi_areas(mesh.unit_points, mesh.faces)
    assert areas.sum() == pytest.approx(area, rel=1e-12)
    assert areas.min() >= 0


def test_voronoi_areas_agree_with_libigl(sphere):
    import igl

    mass = igl.massmatrix(sphere.vertices, sphere.faces, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
    areas = triangles.mixed_voronoi_areas(sphere.vertices, sphere.faces)
    np.testing.assert_allclose(areas, mass, rtol=1e-9)


def test_degenerate_faces_add_nothing():
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 0, 0]])
    assert not triangles.normal_sums(points, faces).any()
    assert not triangles.mixed_voronoi_areas(points, faces).any()


def test_every_edge_is_counted_once():
    vertices, faces = tetrahedron()
    lengths = triangles.edge_lengths(vertices, faces)
    np.testing.assert_allclose(lengths, np.full(6, np.sqrt(8)))


def test_volume_of_a_tetrahedron_and_of_its_mirror_image():
    vertices, faces = tetrahedron()
    assert triangles.enclosed_volume(vertices, faces) == pytest.approx(8 / 3)
    assert triangles.enclosed_volume(vertices, faces[:, ::-1]) == pytest.approx(-8 / 3)


def test_blocks_change_nothing(monkeypatch, ball):
    whole = triangles.normal_sums(ball.vertices, ball.faces)
    areas = triangles.mixed_voronoi_areas(ball.vertices, ball.faces)
    monkeypatch.setattr(triangles, "_BLOCK", 1000)
    np.testing.assert_allclose(
        triangles.normal_sums(ball.vertices, ball.faces),
        whole,
        rtol=1e-12,
        atol=1e-9 * np.abs(whole).max(),
    )
    np.testing.assert_allclose(
        triangles.mixed_voronoi_areas(ball.vertices, ball.faces), areas, rtol=1e-12
    )


def test_turning_turns_the_normals(rng):
    mesh = samples.torus(2000)
    turn = rotation(rng)
    plain = triangles.normal_sums(mesh.vertices, mesh.faces)
    turned = triangles.normal_sums(mesh.vertices @ turn.T, mesh.faces)
    np.testing.assert_allclose(turned, plain @ turn.T, atol=1e-12 * np.abs(plain).max())
