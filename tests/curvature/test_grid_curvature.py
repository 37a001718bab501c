"""Curvature of surfaces of equal values: balls, rods and hollows with exact answers."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import rotation
from scipy.special import erf

from meshdepict.scales.grid_making import grid_space
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.shapes.volume import Volume

RADIUS = 9.0
WIDTHS = np.array([0.0, 1.3, 2.0])


def body(distance, spacing=(1.0, 1.0, 1.0), turn=None, *, bright: bool = True) -> GridSpace:
    """The scale space near the surface of a body given by its distance, soft like a scan's."""
    turn = np.eye(3) if turn is None else turn
    spacing = np.array(spacing)
    counts = np.ceil(34 / spacing).astype(int)
    origin = -turn @ (spacing * (counts - 1) / 2)
    place = {"spacing": spacing, "origin": origin, "direction": turn}
    x, y, z = np.meshgrid(*(np.arange(n) for n in counts), indexing="ij")
    frame = Volume(np.arange(counts.prod()).reshape(counts[::-1]), **place)
    d = distance(frame.to_world(np.stack([x, y, z], -1).transpose(2, 1, 0, 3)))
    values = 1000 * (0.5 - 0.5 * erf(d / 2.5)) * (1 if bright else -1)
    return grid_space(Volume(values, **place), WIDTHS, 2**0.5, where=np.abs(d) < 1.5)


def ball(at: np.ndarray) -> np.ndarray:
    return np.linalg.norm(at, axis=-1) - RADIUS


@pytest.mark.parametrize("bright", [True, False])
@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (0.9, 1.2, 0.7)])
def test_a_ball_has_one_over_its_radius(spacing, bright: bool, rng: np.random.Generator) -> None:
    space = body(ball, spacing, rotation(rng), bright=bright)
    radius = np.linalg.norm(space.points, axis=1)
    sign = 1 if bright else -1  # a bubble is concave
    # Surfaces of equal values stay balls under any Gaussian, whatever its width.
    for scale, error in ((0, 0.35), (1, 2e-3), (2, 2e-3)):
        found = space.curvature(scale)
        np.testing.assert_allclose(sign * found.k1 * radius, 1, atol=error)
        np.testing.assert_allclose(sign * found.k2 * radius, 1, atol=error)


def test_a_rod_bends_across_its_axis_alone(rng: np.random.Generator) -> None:
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)

    def rod(at: np.ndarray) -> np.ndarray:
        across = at - (at @ axis)[..., None] * axis
        return np.linalg.norm(across, axis=-1) - RADIUS

    space = body(rod)
    # The rod goes through the border, which mirrors it: only the middle is a rod.
    middle = (np.abs(space.points) < 16 - 4 * WIDTHS[2]).all(axis=1)
    assert middle.sum() > 100
    across = space.points - (space.points @ axis)[:, None] * axis
    radius = np.linalg.norm(across, axis=1)[middle]
    found = space.curvature(2)
    np.testing.assert_allclose(found.k1[middle] * radius, 1, atol=2e-3)
    np.testing.assert_allclose(found.k2[middle] * radius, 0, atol=2e-3)
    np.testing.assert_allclose(np.abs(found.d2[middle] @ axis), 1, atol=1e-4)
    normals = space.normals[2]
    np.testing.assert_allclose(np.cross(found.d1, found.d2), normals, atol=1e-5)


def test_curvature_is_bounded_by_the_voxels(rng: np.random.Generator) -> None:
    noise = Volume(rng.normal(size=(12, 13, 14)), spacing=(0.5, 0.5, 0.5))
    found = grid_space(noise, WIDTHS, 2**0.5).curvature(0)
    assert np.abs(found.k1).max() == 2.0
    assert (np.abs(found.k1) >= np.abs(found.k2)).all()


def test_where_there_is_no_gradient_there_is_no_curvature() -> None:
    values = np.zeros((20, 20, 20))
    values[9:11, 9:11, 9:11] = 1
    space = grid_space(
        Volume(values), np.array([0, 2.0]), 2**0.5, where=np.ones(values.shape, bool)
    )
    far = space.gradient == 0
    assert far.any()
    assert (space.curvature(0).k1[far] == 0).all()
    assert np.isfinite(space.view_curvature("front", 0).ku).all()
