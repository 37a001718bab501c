"""All estimators as a family: same sign, unit, order and frame; finite whatever comes in."""

import numpy as np
import pytest
from conftest import rotation
from exact_surfaces import SURFACES, sphere

from meshdepict import samples
from meshdepict.curvature import ESTIMATORS, principal_curvatures
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.mesh import Mesh

DIRECTED = ("tensor", "quadric")


def estimate(mesh, method):
    radius = 2 * mesh.edge_length if method == "quadric" else None
    return principal_curvatures(mesh, method=method, radius=radius)


def assert_proper(found, mesh):
    n = len(mesh.vertices)
    assert found.k1.shape == found.k2.shape == (n,)
    assert found.d1.shape == found.d2.shape == (n, 3)
    for array in found:
        assert np.isfinite(array).all()
    assert (np.abs(found.k1) >= np.abs(found.k2)).all()
    frame = np.stack([found.d1, found.d2, mesh.normals], axis=1)
    products = np.einsum("nij,nkj->nik", frame, frame)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(3), products.shape), atol=1e-6)
    assert (np.linalg.det(frame) > 0).all()


@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize("name", SURFACES)
def test_exact_answers(name, method):
    exact = SURFACES[name]()
    found = estimate(exact.mesh, method)
    assert_proper(found, exact.mesh)
    unit = max(np.abs(exact.k1).max(), 1.0)
    inner = exact.inner
    # One-ring estimates are off by about (k · edge)²: edges are 0.02 to 0.07 here, k up to 7.
    assert np.sqrt(np.mean((found.mean - exact.mean)[inner] ** 2)) < 0.02 * unit
    ours, theirs = (np.sort([c.k1, c.k2], axis=0)[:, inner] for c in (found, exact))
    assert np.sqrt(np.mean((ours - theirs) ** 2)) < 0.04 * unit


@pytest.mark.parametrize("method", DIRECTED)
@pytest.mark.parametrize("name", ["ellipsoid", "torus", "saddle", "monkey", "wavy"])
def test_exact_directions(name, method):
    exact = SURFACES[name]()
    found = estimate(exact.mesh, method)
    # Only where one curvature clearly dominates is there a direction to find.
    clear = exact.inner & (exact.k1**2 - exact.k2**2 > 0.1 * np.square(exact.k1).max())
    for ours, theirs in ((found.d1, exact.d1), (found.d2, exact.d2)):
        cosine = np.abs(np.einsum("ij,ij->i", ours, theirs))[clear]
        angle = np.degrees(np.arccos(np.minimum(cosine, 1)))
        assert np.median(angle) < 0.5
        assert angle.max() < 10  # a few edges from where k1² = k2²


@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize("name", ["ellipsoid", "torus", "wavy"])
def test_errors_fall_with_resolution(name, method):
    errors = []
    for vertices in (2_500, 10_000):
        exact = SURFACES[name](vertices)
        error = (estimate(exact.mesh, method).mean - exact.mean)[exact.inner]
        errors.append(np.sqrt(np.mean(error**2)))
    assert errors[1] < 0.6 * errors[0]  # a quarter where all is smooth; 12 irregular vertices lag


@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize("radius", [1e-130, 1e-3, 250.0, 1e130])
def test_curvature_times_length_has_no_unit(method, radius):
    small = samples.sphere(600)
    large = Mesh(small.vertices * radius, small.faces)
    one, other = estimate(small, method), estimate(large, method)
    np.testing.assert_allclose(other.k1 * radius, one.k1, rtol=1e-6)
    assert (one.k1 > 0.9).all()
    assert (one.k2 > 0.9).all()


@pytest.mark.parametrize("method", ESTIMATORS)
def test_turning_moving_and_permuting_change_nothing(method, rng):
    ellipsoid = SURFACES["ellipsoid"](600).mesh
    turn, order = rotation(rng), rng.permutation(len(ellipsoid.vertices))
    # 1000 diameters away a coordinate keeps 13 digits, a second difference 8.
    moved = Mesh((ellipsoid.vertices @ turn.T)[order] + 2e3, np.argsort(order)[ellipsoid.faces])
    one, other = estimate(ellipsoid, method), estimate(moved, method)
    np.testing.assert_allclose(other.k1, one.k1[order], rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(other.k2, one.k2[order], rtol=1e-5, atol=1e-4)
    if method in DIRECTED:
        clear = one.anisotropy > 0.5
        cosine = np.einsum("ij,ij->i", other.d1, (one.d1 @ turn.T)[order])
        assert np.abs(cosine)[clear[order]].min() > 1 - 1e-5


@pytest.mark.parametrize("method", ESTIMATORS)
def test_a_hollow_is_negative(method):
    ball = samples.sphere(600)
    hollow = Mesh(ball.vertices, ball.faces[:, ::-1], winding="keep")
    found = estimate(hollow, method)
    assert (found.k1 < -0.9).all()
    assert (found.k2 < -0.9).all()


def odd_meshes():
    ball = samples.sphere(160)
    v, f = ball.vertices, ball.faces
    sheet = samples.wavy_sheet(100)
    soup = v[f].reshape(-1, 3)
    n = len(v)
    fan = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1.0]])
    yield "isolated vertices", np.vstack([v, [[2, 0, 0], [0, 0, 5]]]), f
    yield "one triangle", np.eye(3), [[0, 1, 2]]
    yield "one degenerate triangle", np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0.0]]), [[0, 1, 2]]
    yield "all at one point", np.ones((4, 3)), [[0, 1, 2], [1, 2, 3]]
    yield "repeated corners", v, np.vstack([f, [[0, 0, 1], [5, 5, 5]]])
    yield "duplicate faces", v, np.vstack([f, f[:20]])
    yield "opposed faces", v, np.vstack([f, f[:, ::-1]])
    yield "a sliver", np.vstack([v, (v[0] + v[1]) / 2 + 1e-12]), np.vstack([f, [[0, 1, n]]])
    yield "a needle", np.vstack([v, v[:1] + 1e-13]), np.vstack([f, [[0, n, 1]]])
    yield "a small part", np.vstack([v, 3 + np.eye(3)]), np.vstack([f, [[n, n + 1, n + 2]]])
    yield "triangle soup", soup, np.arange(len(soup)).reshape(-1, 3)
    yield "fins on an edge", fan, [[0, 1, 5], [0, 2, 5], [0, 3, 5], [0, 4, 5]]
    yield "squashed", sheet.vertices * [1, 1e-8, 0], sheet.faces
    yield "cube", *cube()


def cube():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    return corners, [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ]


@pytest.mark.filterwarnings("ignore:.*are there twice")
@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize(
    ("vertices", "faces"), [pytest.param(*m[1:], id=m[0]) for m in odd_meshes()]
)
def test_odd_meshes_have_finite_curvature(vertices, faces, method):
    mesh = Mesh(vertices, faces, winding="keep")
    assert_proper(estimate(mesh, method), mesh)


@pytest.mark.parametrize("method", ESTIMATORS)
def test_isolated_vertices_are_flat_and_change_nothing(method):
    ball = samples.sphere(600)
    mesh = Mesh(np.vstack([[[0.0, 0, 0]], ball.vertices, [[0.5, 0, 0]]]), ball.faces + 1)
    found, plain = estimate(mesh, method), estimate(ball, method)
    for end in (0, -1):
        assert found.k1[end] == found.k2[end] == 0
    np.testing.assert_allclose(found.k1[1:-1], plain.k1, rtol=1e-9)


@pytest.mark.parametrize("method", ESTIMATORS)
def test_vertices_at_one_position_share_their_curvature(method):
    ball = SURFACES["ellipsoid"](600).mesh
    soup = Mesh(
        ball.vertices[ball.faces].reshape(-1, 3), np.arange(3 * len(ball.faces)).reshape(-1, 3)
    )
    found, plain = estimate(soup, method), estimate(ball, method)
    np.testing.assert_allclose(found.k1, plain.k1[ball.faces.ravel()], rtol=1e-9)
    np.testing.assert_allclose(found.k2, plain.k2[ball.faces.ravel()], rtol=1e-7)


@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize("name", ["sphere", "plane"])
def test_umbilics_have_the_same_frame_in_every_run(name, method):
    first, again = (estimate(SURFACES[name](600).mesh, method) for _ in range(2))
    np.testing.assert_array_equal(first.d1, again.d1)


def test_derived_values():
    found = principal_curvatures(SURFACES["saddle"](400).mesh)
    np.testing.assert_allclose(found.mean, (found.k1 + found.k2) / 2)
    np.testing.assert_allclose(found.gaussian, found.k1 * found.k2)
    np.testing.assert_allclose(found.anisotropy, found.k1**2 - found.k2**2, atol=1e-12)
    assert (found.anisotropy >= 0).all()
    with pytest.raises(ValueError, match="read-only"):
        found.k1[0] = 1


@pytest.mark.filterwarnings("ignore:.*are there twice")
@pytest.mark.parametrize("method", ESTIMATORS)
@pytest.mark.parametrize(
    "name", ["bunny_69k", "gears_19k", "dragon_203k", "beetle_2k", "fandisk_13k"]
)
def test_real_scans_have_finite_curvature(data, name, method):
    from meshdepict.io import read_mesh

    mesh = read_mesh(data / "mesh" / f"{name}.ply", winding="keep")
    assert_proper(estimate(mesh, method), mesh)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "tensr"}, "no curvature estimator is called 'tensr'; did you mean 'tensor'"),
        ({"method": "quadric", "normals": "own"}, "method='quadric' measures positions"),
        ({"method": "discrete", "normals": "own"}, "method='discrete' measures positions"),
        ({"radius": 1.0}, "radius belongs to method='quadric'; method='tensor' has none"),
        ({"method": "discrete", "radius": 1.0}, "radius belongs to"),
        ({"method": "quadric", "radius": -1.0}, "not a positive length"),
        ({"method": "quadric", "radius": "wide"}, "not a positive length"),
        ({"normals": "up"}, "must be an .n, 3. array of numbers"),
        ({"normals": np.eye(3)}, r"normals have shape \(3, 3\); the mesh's 12 vertices"),
        ({"normals": np.ones((12, 3))}, "12 of 12 normals are not of unit length .the first is 0"),
        ({"normals": np.full((12, 3), np.nan)}, "12 of 12 normals are not of unit length"),
    ],
)
def test_errors(options, message):
    mesh = samples.sphere(12)
    if isinstance(options.get("normals"), str) and options["normals"] == "own":
        options = options | {"normals": mesh.normals}
    with pytest.raises(MeshdepictError, match=message):
        principal_curvatures(mesh, **options)


def test_the_curvature_of_a_sphere_is_one_over_its_radius():
    exact = sphere(41_000, radius=2.0)
    found = principal_curvatures(exact.mesh)
    # Max's normals are exact on a sphere, and then so is this estimator: far better than 1 %.
    assert np.abs(found.k1 - 0.5).max() < 1e-9
    assert np.abs(found.k2 - 0.5).max() < 1e-9
