"""The tensor estimator against its slow twin, and curvature at a scale against noise."""

import numpy as np
import pytest
from exact_surfaces import SURFACES

from meshdepict import samples, scale_space, threads
from meshdepict.curvature import principal_curvatures
from meshdepict.shapes.mesh import Mesh


def twin(mesh, normals):
    """Rusinkiewicz's estimate as 3×3 matrices (n, 3, 3), one face after the other."""
    total, weights = np.zeros((len(mesh.vertices), 3, 3)), np.zeros(len(mesh.vertices))
    for face in mesh.faces:
        corners, n = mesh.vertices[face], normals[face]
        mean = n.sum(axis=0) / np.linalg.norm(n.sum(axis=0))
        plane = np.linalg.svd(mean[None])[2][1:]  # any two unit vectors across the mean normal
        flat, turn = corners @ plane.T, n @ plane.T
        edges, turns = (x[[1, 2, 0]] - x for x in (flat, turn))
        # S = [[a, b], [b, c]]: six equations S e = Δn for three unknowns.
        rows = [[(x, y, 0), (0, x, y)] for x, y in edges]
        a, b, c = np.linalg.lstsq(np.reshape(rows, (6, 3)), turns.ravel())[0]
        shape = plane.T @ np.array([[a, b], [b, c]]) @ plane
        share = voronoi(flat)
        for v, own, weight in zip(face, n, share, strict=True):
            away = mean if mean @ own >= 0 else -mean
            total[v] += weight * (r := rotation_onto(away, own)) @ shape @ r.T
            weights[v] += weight
    return total / weights[:, None, None]


def voronoi(corners):
    """Mixed Voronoi areas by angles: half the area at an obtuse corner, a quarter at others."""
    sides = [corners[(k + 2) % 3] - corners[(k + 1) % 3] for k in range(3)]  # opposite corner k
    lengths = [np.linalg.norm(s) for s in sides]
    angles = [
        np.arccos(-(sides[k - 1] @ sides[k - 2]) / lengths[k - 1] / lengths[k - 2])
        for k in range(3)
    ]
    area = abs(np.linalg.det(np.stack(sides[:2]))) / 2
    if max(angles) > np.pi / 2:
        return [area / 2 if angle > np.pi / 2 else area / 4 for angle in angles]
    squares = [length**2 / np.tan(angle) / 8 for length, angle in zip(lengths, angles, strict=True)]
    return [sum(squares) - squares[k] for k in range(3)]


def rotation_onto(a, b):
    """The rotation by the angle between unit vectors a and b that turns a onto b."""
    cross, cosine = np.cross(a, b), a @ b
    k = np.array([[0, -cross[2], cross[1]], [cross[2], 0, -cross[0]], [-cross[1], cross[0], 0]])
    return np.eye(3) + k + k @ k / (1 + cosine)


def as_matrices(found):
    outer = [d[:, :, None].astype(float) * d[:, None, :] for d in (found.d1, found.d2)]
    return found.k1[:, None, None] * outer[0] + found.k2[:, None, None] * outer[1]


@pytest.mark.parametrize("name", SURFACES)
def test_it_equals_its_slow_twin(name):
    mesh = SURFACES[name](300).mesh
    found = as_matrices(principal_curvatures(mesh))
    expected = twin(mesh, mesh.normals)
    np.testing.assert_allclose(found, expected, atol=1e-6 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("steepness", [0.1, 1.0, 10.0])
def test_it_equals_its_slow_twin_for_any_normals(steepness, rng):
    mesh = samples.golf_ball(300)
    normals = mesh.normals + steepness * rng.normal(size=mesh.normals.shape)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    expected = twin(mesh, normals)
    found = as_matrices(principal_curvatures(mesh, normals=normals))
    # Faces seen edge-on have huge operators and little weight.
    scale = np.abs(expected).max(axis=(1, 2), keepdims=True) + 1
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-6)


def test_normals_of_a_sphere_give_its_curvature_on_any_surface(ball):
    # What bends is the field of normals; the dimples underneath don't matter …
    radial = ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)
    found = principal_curvatures(ball, normals=radial)
    # … but by as much as they lie deeper.
    np.testing.assert_allclose(found.mean, 1, atol=0.02)
    assert np.ptp(principal_curvatures(ball).mean) > 3


@pytest.mark.parametrize("noise", [0.003, 0.01])
def test_at_a_scale_a_rough_sphere_is_a_sphere(noise, rng):
    ball = samples.sphere(10_000)
    rough = Mesh(ball.vertices * (1 + noise * rng.normal(size=(len(ball.vertices), 1))), ball.faces)
    space = scale_space(rough, scales=7)  # up to eight edges
    found = space.curvature(7)
    # Slopes don't lower it: faces are seen along the smoothed normals.
    assert abs(np.median(found.mean) - 1) < 0.002
    assert np.ptp(np.percentile(found.mean, [5, 95])) < 0.05
    assert np.median(np.abs(space.curvature(0).mean - 1)) > 0.2


def test_at_the_same_width_noise_spreads_less_than_a_fitted_quadric_lets_it(rng):
    ball = samples.sphere(10_000)
    noisy = Mesh(ball.vertices * (1 + 1e-3 * rng.normal(size=(len(ball.vertices), 1))), ball.faces)
    width = 4 * noisy.edge_length
    space = scale_space(noisy, scales=5, width=width / 4)
    assert space.widths[5] == pytest.approx(width)
    tensor = space.curvature(5).mean
    quadric = principal_curvatures(noisy, method="quadric", radius=width).mean
    ranges = [np.ptp(np.percentile(mean, [5, 95])) for mean in (tensor, quadric)]
    assert ranges[0] < 0.5 * ranges[1]
    assert abs(np.median(tensor) - 1) < abs(np.median(quadric) - 1) + 0.01


def test_the_number_of_threads_changes_no_bit():
    mesh = samples.golf_ball(12_000)
    results = []
    for count in (1, 2, 3):
        threads.limit(count)
        try:
            results.append(principal_curvatures(mesh))
        finally:
            threads.limit(None)
    for other in results[1:]:
        for a, b in zip(results[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_single_and_double_precision_normals_agree(ball):
    one = principal_curvatures(ball)
    other = principal_curvatures(ball, normals=ball.normals.astype(np.float32))
    # Rounding of 6e-8 over edges of 0.05.
    np.testing.assert_allclose(other.mean, one.mean, atol=1e-5)


def test_normals_are_not_modified(ball):
    normals = ball.normals.copy()
    principal_curvatures(ball, normals=normals)
    np.testing.assert_array_equal(normals, ball.normals)
    assert normals.flags.writeable
