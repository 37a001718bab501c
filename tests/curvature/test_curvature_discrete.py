"""The discrete estimator: Gauss–Bonnet to the last digit, exact forms, borders."""

import numpy as np
import pytest
from exact_surfaces import SURFACES

from meshdepict import samples
from meshdepict.curvature import principal_curvatures
from meshdepict.curvature.discrete import angle_defects, mean_curvature_normals
from meshdepict.curvature.frames import halved_angle, tangents
from meshdepict.shapes.mesh import Mesh


def euler(mesh):
    """V − E + F of the surface, vertices at one position being one."""
    _, label = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = label.reshape(-1)[mesh.faces]
    edges = np.unique(
        np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])), axis=0
    )
    return len(np.unique(faces)) - len(np.unique(np.sort(edges, axis=1), axis=0)) + len(faces)


def as_soup(mesh):
    return Mesh(
        mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3)
    )


def holed():
    sphere = samples.sphere(600)
    return Mesh(sphere.vertices, np.delete(sphere.faces, [0, 100, 200], axis=0))


MESHES = {
    "sphere": (lambda: samples.sphere(600), 2),
    "golf ball": (lambda: samples.golf_ball(2_000), 2),
    "torus": (lambda: samples.torus(600), 0),
    "sheet": (lambda: samples.wavy_sheet(400), 1),
    "sphere with three holes": (holed, -1),
    "two spheres": (
        lambda: Mesh(
            np.vstack([samples.sphere(42).vertices, samples.sphere(42).vertices + 5]),
            np.vstack([samples.sphere(42).faces, samples.sphere(42).faces + 42]),
        ),
        4,
    ),
    "soup": (lambda: as_soup(samples.sphere(600)), 2),
    "isolated vertices": (
        lambda: Mesh(
            np.vstack([samples.sphere(600).vertices, [[9, 9, 9]]]), samples.sphere(600).faces
        ),
        2,
    ),
}


@pytest.mark.parametrize("name", MESHES)
def test_gauss_bonnet(name):
    make, characteristic = MESHES[name]
    mesh = make()
    assert euler(mesh) == characteristic
    defects = angle_defects(mesh)
    assert defects.shape == (len(mesh.vertices),)
    assert defects.sum() == pytest.approx(2 * np.pi * characteristic, abs=1e-9)


@pytest.mark.parametrize("name", ["armadillo_86k", "fandisk_13k", "flake1_152k", "bunny_69k"])
def test_gauss_bonnet_on_real_scans(data, name):
    from meshdepict.io import read_mesh

    mesh = read_mesh(data / "mesh" / f"{name}.ply", winding="keep")
    defects = angle_defects(mesh)
    assert defects.sum() == pytest.approx(2 * np.pi * euler(mesh), abs=1e-6)


def test_gaussian_curvature_times_area_is_the_defect_where_no_root_is_clamped():
    mesh = SURFACES["torus"](2_500).mesh
    found = principal_curvatures(mesh, method="discrete")
    defects = angle_defects(mesh)
    inside = found.mean**2 > found.gaussian * (1 + 1e-6)
    assert inside.mean() > 0.9
    np.testing.assert_allclose((found.gaussian * mesh.areas)[inside], defects[inside], atol=1e-9)


def test_the_mean_curvature_normal_of_a_sphere_is_twice_its_curvature():
    mesh = samples.sphere(600, radius=4.0)
    normals = mean_curvature_normals(mesh)
    np.testing.assert_allclose(normals, 2 / 4.0 * mesh.normals, atol=0.005)  # one-ring error


def test_the_mean_curvature_normals_add_up_to_nothing_on_a_closed_surface(ball):
    # They are the gradient of the area, which moving the whole doesn't change.
    total = (mean_curvature_normals(ball) * ball.areas[:, None]).sum(axis=0)
    np.testing.assert_allclose(total, 0, atol=1e-9)


def test_they_are_the_gradient_of_the_area(rng):
    ball = samples.golf_ball(300)
    step = rng.normal(size=ball.vertices.shape) * 1e-6
    grown, shrunk = (Mesh(ball.vertices + s * step, ball.faces) for s in (1, -1))
    change = (grown.areas.sum() - shrunk.areas.sum()) / 2
    expected = (mean_curvature_normals(ball) * ball.areas[:, None] * step).sum()
    assert change == pytest.approx(expected, rel=1e-4)


def test_a_border_takes_after_the_inside():
    dome = samples.sphere(2_500)
    cap = Mesh(dome.vertices, dome.faces[(dome.vertices[dome.faces][:, :, 2] > 0.2).all(axis=1)])
    used = np.unique(cap.faces)
    found = principal_curvatures(cap, method="discrete")
    np.testing.assert_allclose(found.mean[used], 1, atol=0.02)


def test_a_border_without_an_inside_is_flat():
    strip = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0.5]], [[0, 1, 2], [0, 2, 3]])
    found = principal_curvatures(strip, method="discrete")
    np.testing.assert_array_equal(found.k1, 0)


def test_its_directions_are_any_tangents():
    mesh = SURFACES["torus"](600).mesh
    found = principal_curvatures(mesh, method="discrete")
    np.testing.assert_allclose(found.d1, tangents(mesh.normals), atol=1e-7)


def test_tangents_of_every_direction_are_unit_and_tangent(rng):
    axes = np.vstack([np.eye(3), -np.eye(3), [[0.0, 0, -1], [-0.0, -0.0, -1]]])
    near = axes + 1e-12 * rng.normal(size=axes.shape)
    normals = np.vstack([axes, near, rng.normal(size=(1000, 3))])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found = tangents(normals)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(np.einsum("ij,ij->i", found, normals), 0, atol=1e-14)


def test_halved_angles(rng):
    angle, length = rng.uniform(-np.pi, np.pi, 1000), 10 ** rng.uniform(-100, 100, 1000)
    cosine, sine = halved_angle(length * np.cos(angle), length * np.sin(angle))
    np.testing.assert_allclose(np.arctan2(sine, cosine), angle / 2, atol=1e-12)
    for x, y, expected in ((0.0, 0.0, (1, 0)), (1.0, 0.0, (1, 0)), (-1.0, 0.0, (0, 1))):
        cosine, sine = halved_angle(np.array([x]), np.array([y]))
        assert (abs(cosine[0]), abs(sine[0])) == expected
