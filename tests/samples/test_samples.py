"""The procedural shapes are what their docstrings promise."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from meshdepict import MeshdepictError, samples
from meshdepict.samples.golf_ball import _pressed
from meshdepict.surface.icosahedron import lattice_points

CLOSED = [
    (samples.sphere(1000), 2),
    (samples.golf_ball(3000), 2),
    (samples.torus(1000), 0),
    (samples.sphere(12), 2),
    (samples.torus(9), 0),
    (samples.tablet(4000), 2),
    (samples.coin(4000), 2),
    (samples.knapped_core(4000), 2),
    (samples.knapped_core(12), 2),
]
SHEETS = [samples.wavy_sheet(900), samples.radiating_ridges(2500), samples.wavy_sheet(4)]
FINDS = [samples.inscription, samples.tablet, samples.coin, samples.knapped_core]


def directed_edges(mesh):
    return np.concatenate([mesh.faces[:, [k, (k + 1) % 3]] for k in range(3)])


def cross_products(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def volume(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


@pytest.mark.parametrize(("mesh", "euler"), CLOSED)
def test_closed_shapes_are_outward_manifolds(mesh, euler):
    edges = directed_edges(mesh)
    assert len(np.unique(edges, axis=0)) == len(edges)  # no directed edge twice
    assert {*map(tuple, edges)} == {*map(tuple, edges[:, ::-1])}  # each has its opposite
    assert len(np.unique(mesh.faces)) == len(mesh.vertices)  # every vertex is used
    assert len(mesh.vertices) - len(edges) // 2 + len(mesh.faces) == euler
    assert volume(mesh) > 0


@pytest.mark.parametrize("mesh", SHEETS)
def test_sheets_are_manifold_and_face_up(mesh):
    edges = directed_edges(mesh)
    assert len(np.unique(edges, axis=0)) == len(edges)
    side = round(len(mesh.vertices) ** 0.5)
    border = {*map(tuple, edges)} - {*map(tuple, edges[:, ::-1])}
    assert len(border) == 4 * (side - 1)
    assert (cross_products(mesh)[:, 2] > 0).all()


@pytest.mark.parametrize("wanted", [12, 13, 27, 1000, 40_000, 123_456])
def test_spheres_have_about_the_wanted_vertices(wanted):
    counts = 10 * np.arange(1, 200) ** 2 + 2
    found = len(samples.sphere(wanted).vertices)
    assert abs(found - wanted) == np.abs(counts - wanted).min()
    assert abs(found - wanted) <= 3.2 * wanted**0.5
    assert len(samples.golf_ball(wanted).vertices) == found


@pytest.mark.parametrize("wanted", [100, 1000, 12_345])
@pytest.mark.parametrize("minor", [0.1, 0.4, 0.9])
def test_tori_and_sheets_have_about_the_wanted_vertices(wanted, minor):
    found = len(samples.torus(wanted, minor=minor).vertices)
    assert abs(found - wanted) <= (wanted * minor) ** 0.5 / 2 + 0.25  # the tube's own rounding
    assert abs(len(samples.wavy_sheet(wanted).vertices) - wanted) <= wanted**0.5 + 1


def test_sphere_is_round_and_even():
    mesh = samples.sphere(40_000, radius=3.0)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 3.0, rtol=1e-15)
    ends = mesh.vertices[directed_edges(mesh)]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    assert lengths.max() < 1.18 * lengths.min()


def test_volumes_converge_to_the_exact_ones():
    # Second order in the edge: four times the vertices, a quarter of the error.
    for shape, exact in (
        (samples.sphere, 4 / 3 * np.pi),
        (samples.torus, 2 * np.pi**2 * 0.4**2),
    ):
        coarse, fine = (1 - volume(shape(n)) / exact for n in (4000, 16_000))
        assert 0 < fine < 0.002
        assert 3.8 < coarse / fine < 4.2


def test_torus_lies_on_its_surface():
    x, y, z = samples.torus(2000, major=2.0, minor=0.5).vertices.T
    np.testing.assert_allclose((np.hypot(x, y) - 2) ** 2 + z**2, 0.25, rtol=1e-14)


# --- the golf ball --------------------------------------------------------------------------


def test_golf_ball_has_its_dimples():
    # 150 vertices a dimple: those in its inner half are connected, and apart from all others.
    mesh = samples.golf_ball(60_000)
    deep = 1 - np.linalg.norm(mesh.vertices, axis=1) > 0.012 / 2
    edges = directed_edges(mesh)
    edges = edges[deep[edges].all(axis=1)]
    graph = coo_array((np.ones(len(edges)), edges.T), shape=(len(deep),) * 2)
    labels = connected_components(graph, directed=False)[1][deep]
    _, sizes = np.unique(labels, return_counts=True)
    assert len(sizes) == 392
    assert sizes.min() > 20


def test_golf_ball_is_pressed_in_by_the_depth_and_nowhere_out():
    distance = np.linalg.norm(samples.golf_ball(40_000, depth=0.02, radius=5.0).vertices, axis=1)
    assert distance.max() <= 5 * (1 + 1e-15)
    assert distance.min() == pytest.approx(5 * 0.98, rel=1e-3)
    assert (distance < 5 * (1 - 1e-12)).mean() > 0.75  # real balls: 75 to 85 % in dimples
    assert (distance > 5 * (1 - 1e-12)).mean() > 0.1  # and land between them


def test_golf_ball_without_depth_is_the_sphere():
    ball, sphere = samples.golf_ball(2000, depth=0, radius=2.0), samples.sphere(2000, radius=2.0)
    np.testing.assert_array_equal(ball.faces, sphere.faces)
    np.testing.assert_allclose(ball.vertices, sphere.vertices, rtol=0, atol=1e-15)


@pytest.mark.parametrize("shape", [samples.golf_ball, *FINDS])
def test_shapes_are_the_same_every_time(shape):
    first, second = shape(5000), shape(5000)
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert first.faces.tobytes() == second.faces.tobytes()


def test_dimples_are_spherical_caps():
    centre = lattice_points(392)[200]
    points = samples.golf_ball(400_000).vertices
    middle = points[np.linalg.norm(points - centre, axis=1) < 0.05]
    # |x|² + b·x + c = 0 is a sphere; the residual over its gradient is the distance from it.
    system = np.column_stack((middle, np.ones(len(middle))))
    squared = (middle**2).sum(axis=1)
    solution = np.linalg.lstsq(system, -squared, rcond=None)[0]
    ball_centre = -solution[:3] / 2
    radius = np.linalg.norm(middle - ball_centre, axis=1).mean()
    residual = np.linalg.norm(middle - ball_centre, axis=1) - radius
    assert ball_centre @ centre > 1  # concave: its centre lies outside the ball
    assert np.abs(residual).max() < 0.01 * 0.012  # 1 % of the depth


def test_dimple_rims_are_smooth():
    # Along the arc between two neighbours the slope of the profile turns without a jump: halving
    # the step halves its largest change.
    centres = lattice_points(392)
    _, neighbour = cKDTree(centres).query(centres[0], k=2)
    changes = []
    for count in (2001, 4001):
        share = np.linspace(0, 1, count)[:, None]
        arc = centres[0] * (1 - share) + centres[neighbour[1]] * share
        profile = _pressed(arc / np.linalg.norm(arc, axis=1, keepdims=True), centres)
        slope = np.diff(profile) * count
        changes.append(np.abs(np.diff(slope)).max())
    assert profile[[0, -1]] == pytest.approx(1)
    assert changes[1] == pytest.approx(changes[0] / 2, rel=0.05)


# --- the ridges -----------------------------------------------------------------------------


def test_ridges_repeat_in_azimuth():
    generator = np.random.default_rng(1)
    distance, angle = generator.uniform(0, 1, 100), generator.uniform(0, 2 * np.pi, 100)
    turned = angle + 2 * np.pi / 24
    here = samples.ridge_height(distance * np.cos(angle), distance * np.sin(angle))
    there = samples.ridge_height(distance * np.cos(turned), distance * np.sin(turned))
    np.testing.assert_allclose(here, there, atol=1e-14)


def test_ridges_have_their_heights():
    assert samples.ridge_height(0, 0, hill=0.5) == 0.5
    valley = np.pi / 24
    low = samples.ridge_height(0.6 * np.cos(valley), 0.6 * np.sin(valley), relief=0.1)
    assert samples.ridge_height(0.6, 0, relief=0.1) - low == pytest.approx(0.1)


def test_sheets_have_the_heights_of_their_formulas():
    x, y, z = samples.radiating_ridges(900, ridges=7).vertices.T
    np.testing.assert_array_equal(z, samples.ridge_height(x, y, ridges=7))
    assert (x.min(), x.max(), y.min(), y.max()) == (-1, 1, -1, 1)
    x, y, z = samples.wavy_sheet(900, size=4.0, amplitude=0.3, waves=2).vertices.T
    np.testing.assert_allclose(z, 0.3 * np.sin(np.pi * x), atol=1e-15)
    assert (x.min(), x.max(), y.min(), y.max()) == (-2, 2, -2, 2)


# --- wrong arguments ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shape", "argument"),
    [
        (samples.golf_ball, {"vertices": 11}),
        (samples.golf_ball, {"vertices": 100.5}),
        (samples.golf_ball, {"vertices": float("nan")}),
        (samples.golf_ball, {"dimples": 11}),
        (samples.golf_ball, {"depth": -0.01}),
        (samples.golf_ball, {"depth": 0.2}),
        (samples.golf_ball, {"radius": 0}),
        (samples.sphere, {"vertices": 10**9}),
        (samples.sphere, {"radius": -1}),
        (samples.torus, {"vertices": 8}),
        (samples.torus, {"minor": 0}),
        (samples.wavy_sheet, {"vertices": 3}),
        (samples.wavy_sheet, {"amplitude": float("inf")}),
        (samples.radiating_ridges, {"ridges": -1}),
        (samples.radiating_ridges, {"relief": 2}),
        (samples.inscription, {"depth": -1}),
        (samples.inscription, {"wear": 1.1}),
        (samples.tablet, {"lines": 41}),
        (samples.tablet, {"vertices": 11}),
        (samples.coin, {"relief": float("nan")}),
        (samples.knapped_core, {"flakes": -1}),
    ],
)
def test_arguments_out_of_range_are_refused(shape, argument):
    (name,) = argument
    with pytest.raises(MeshdepictError, match=f"{shape.__name__}: {name}="):
        shape(**argument)


def test_dimples_without_a_lattice_are_refused_with_the_nearest():
    with pytest.raises(
        MeshdepictError, match=r"dimples=100: no icosahedral lattice .*; take 92 or 122"
    ):
        samples.golf_ball(1000, dimples=100)


def test_a_tube_thicker_than_its_circle_is_refused():
    with pytest.raises(MeshdepictError, match=r"minor=1\.0 must be smaller"):
        samples.torus(1000, minor=1.0)
