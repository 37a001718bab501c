"""Integral invariants: planes, spheres and edges whose balls are known, and the sum itself."""

from __future__ import annotations

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.shapes.mesh import Mesh
from meshdepict.sums.ball_shares import ball_shares, exact_shares


@pytest.fixture(scope="module")
def globe() -> Mesh:
    return samples.sphere(10_000)


@pytest.mark.parametrize("radius", [0.25, 0.5, 1.0])
def test_a_ball_on_a_unit_sphere_holds_half_less_three_sixteenths_of_its_radius(
    globe: Mesh, radius: float
) -> None:
    (found,) = ball_shares(globe.vertices, globe.normals, globe.areas, [radius])
    np.testing.assert_allclose(found, 0.5 - 3 * radius / 16, atol=2e-4)


def test_seen_from_inside_a_sphere_is_a_hollow(globe: Mesh) -> None:
    (found,) = ball_shares(globe.vertices, -globe.normals, globe.areas, [0.5])
    np.testing.assert_allclose(found, 0.5 + 3 * 0.5 / 16, atol=2e-4)


def test_on_a_plane_it_is_half_also_at_its_border(rng: np.random.Generator) -> None:
    points = np.append(rng.random((500, 2)), np.full((500, 1), 3.0), axis=1)
    normals = np.tile([0, 0, 1.0], (500, 1))
    found = ball_shares(points, normals, np.full(500, 1 / 500), [0.05, 0.3, 10])
    np.testing.assert_array_equal(found, 0.5)


def test_beside_a_right_angle_a_piece_of_the_ball_is_cut_off() -> None:
    """At s from the edge of a quarter of space: ½ less half of the cap beyond."""
    t = (np.arange(160) + 0.5) / 80 - 1
    x, y = (grid.ravel() for grid in np.meshgrid(t[t < 0], t))
    level = np.stack([x, y, 0 * x], axis=1), np.tile([0, 0, 1.0], (len(x), 1))
    wall = np.stack([0 * x, y, x], axis=1), np.tile([1.0, 0, 0], (len(x), 1))
    points, normals = (np.concatenate(parts) for parts in zip(level, wall, strict=True))
    areas = np.full(len(points), 1 / 80**2)
    s, r = 4.5 / 80, 0.4
    here = np.flatnonzero(np.isclose(points[:, 0], -s) & (np.abs(points[:, 1]) < 0.5))
    cut = (r - s) ** 2 * (2 * r + s) / (8 * r**3)
    (found,) = ball_shares(points, normals, areas, [r])
    np.testing.assert_allclose(found[here], 0.5 - cut, atol=2e-3)
    (found,) = ball_shares(points, -normals, areas, [r])
    np.testing.assert_allclose(found[here], 0.5 + cut, atol=2e-3)


def test_the_sum_is_that_of_the_definition_and_the_points_own_area(globe: Mesh) -> None:
    few = globe.vertices[:400], globe.normals[:400], globe.areas[:400]
    exact = exact_shares(*few, 0.3)
    (found,) = ball_shares(*few, [0.3])
    # κ = 1 on the unit sphere.
    own = 0.621 * np.sqrt(few[2]) / 4
    near = np.linalg.norm(few[0] - few[0][:, None], axis=2) < 0.3
    inside = near.sum(axis=1) > 30
    np.testing.assert_allclose(found[inside], (exact - own)[inside], atol=2e-4)


def test_radii_come_in_any_order_and_agree_with_each_alone(ball: Mesh) -> None:
    given = ball.vertices, ball.normals, ball.areas
    radii = np.array([0.2, 0.08, 0.1]) * ball.diagonal
    together = ball_shares(*given, list(radii))
    for radius, share in zip(radii, together, strict=True):
        np.testing.assert_allclose(ball_shares(*given, [radius])[0], share, atol=1e-5)


def test_turning_scaling_and_moving_change_nothing_and_order_moves_along(
    ball: Mesh, rng: np.random.Generator
) -> None:
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    order = rng.permutation(len(ball.vertices))
    (found,) = ball_shares(ball.vertices, ball.normals, ball.areas, [0.1])
    (moved,) = ball_shares(
        7 * ball.vertices[order] @ turn.T + 1e3, ball.normals[order] @ turn.T,
        49 * ball.areas[order], [0.7],
    )  # fmt: skip
    np.testing.assert_allclose(moved, found[order], atol=1e-5)


def test_points_on_top_of_each_other_and_alone_have_a_share() -> None:
    points = np.zeros((3, 3))
    points[2] = 100
    found = ball_shares(points, np.tile([0, 0, 1.0], (3, 1)), np.ones(3), [1.0, 0.1])
    np.testing.assert_array_equal(found, 0.5)
