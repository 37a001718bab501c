"""Quadric fitting: against libigl's, exact where the surface is a quadric, and its radius."""

import numpy as np
import pytest
from exact_surfaces import SURFACES

from meshdepict import samples
from meshdepict.curvature import principal_curvatures
from meshdepict.shapes.mesh import Mesh


def mean_edge(mesh):
    corners = mesh.vertices[mesh.faces]
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()


@pytest.mark.parametrize("edges", [2, 3, 5])
@pytest.mark.parametrize("name", ["sphere", "ellipsoid", "torus", "monkey", "wavy"])
def test_it_agrees_with_libigl(name, edges):
    igl = pytest.importorskip("igl")
    exact = SURFACES[name]()
    mesh = exact.mesh
    *_, high, low, bad = igl.principal_curvature(
        np.array(mesh.vertices), np.array(mesh.faces), edges, useKring=False
    )
    assert not bad
    found = principal_curvatures(mesh, method="quadric", radius=edges * mean_edge(mesh))
    # libigl symmetrises the fitted quadric's operator, whose antisymmetric part is of the order
    # of its slopes: the peer is the less accurate of the two.
    difference = np.abs(found.mean - (high + low) / 2)[exact.inner].max()
    assert difference < 0.005 * np.abs(exact.k1).max() * edges
    ours, theirs = (
        np.sqrt(np.mean((mean - exact.mean)[exact.inner] ** 2))
        for mean in (found.mean, (high + low) / 2)
    )
    assert ours < theirs * 1.01


@pytest.mark.parametrize("radius", [0.05, 0.1, 0.3])
def test_a_paraboloid_is_fitted_exactly_at_its_top(radius):
    sheet = samples.wavy_sheet(41**2, size=1.0, amplitude=0)
    x, y = sheet.vertices[:, 0], sheet.vertices[:, 1]
    mesh = Mesh(np.stack([x, y, -(1.5 * x * x + 0.4 * x * y + 0.5 * y * y)], axis=1), sheet.faces)
    top = int(np.argmin(x * x + y * y))
    found = principal_curvatures(mesh, method="quadric", radius=radius)
    expected = np.linalg.eigvalsh([[3.0, 0.4], [0.4, 1.0]])
    # By symmetry the mean of the normals there is the axis.
    np.testing.assert_allclose([found.k2[top], found.k1[top]], expected, rtol=1e-9)


def test_the_radius_is_a_length_of_the_world(ball):
    large = Mesh(ball.vertices * 50, ball.faces)
    one = principal_curvatures(ball, method="quadric", radius=0.2)
    for radius in (10.0, f"{10 / large.diagonal * 100}%"):
        other = principal_curvatures(large, method="quadric", radius=radius)
        np.testing.assert_allclose(other.k1 * 50, one.k1, rtol=1e-6, atol=1e-9)


def test_the_default_radius_is_five_edges(ball):
    default = principal_curvatures(ball, method="quadric")
    given = principal_curvatures(ball, method="quadric", radius=5 * ball.edge_length)
    np.testing.assert_array_equal(default.k1, given.k1)


def test_a_wider_radius_smooths_more(ball):
    spread = [
        np.std(principal_curvatures(ball, method="quadric", radius=edges * ball.edge_length).mean)
        for edges in (2, 4, 8, 16)
    ]
    assert spread == sorted(spread, reverse=True)
    assert spread[-1] < 0.2 * spread[0]


def test_a_radius_too_small_for_six_vertices_grows():
    sphere = samples.sphere(600)
    found = principal_curvatures(sphere, method="quadric", radius=1e-9)
    np.testing.assert_allclose(found.mean, 1, atol=0.05)


@pytest.mark.parametrize("radius", [1e-300, 1e-9, 1e9, 1e300])
def test_any_radius_is_finite(radius):
    found = principal_curvatures(samples.golf_ball(300), method="quadric", radius=radius)
    for array in found:
        assert np.isfinite(array).all()


def test_a_part_of_too_few_vertices_takes_the_tensor_estimate():
    sphere = samples.sphere(600)
    n = len(sphere.vertices)
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    mesh = Mesh(np.vstack([sphere.vertices, corner + 3]), np.vstack([sphere.faces, faces + n]))
    found = principal_curvatures(mesh, method="quadric", radius=0.3)
    tensor = principal_curvatures(mesh)
    np.testing.assert_allclose(found.k1[n:], tensor.k1[n:])
    np.testing.assert_allclose(found.d1[n:], tensor.d1[n:], atol=1e-6)
    assert (found.k1[n:] > 0.1).all()


def test_points_on_a_plane_curve_of_degree_two_are_no_quadric_and_stay_finite():
    # A fan whose rim lies on a circle about its hub: u² + v² is the same everywhere.
    angle = np.linspace(0, 2 * np.pi, 7)[:6]
    rim = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    mesh = Mesh(np.vstack([[[0, 0, 0]], rim]), [[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])
    found = principal_curvatures(mesh, method="quadric", radius=3.0)
    np.testing.assert_allclose(found.k1, 0, atol=1e-9)


def test_normals_that_cancel_do_no_harm():
    # Four fins on an edge, symmetric: libigl's own estimator ends the process here.
    fan = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1.0]])
    mesh = Mesh(fan, [[0, 1, 5], [0, 2, 5], [0, 3, 5], [0, 4, 5]])
    found = principal_curvatures(mesh, method="quadric", radius=9.0)
    for array in found:
        assert np.isfinite(array).all()
