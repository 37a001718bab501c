"""Texture: waves are scaled by their frequency, whatever lies in holes, offsets and corners."""

from __future__ import annotations

import numpy as np
import pytest

from meshdepict.heights.fractional_laplacian import filled, texture


def wave(shape: tuple[int, int], halves: tuple[int, int]) -> np.ndarray:
    """A standing wave that mirrors at the edges."""
    rows, cols = (
        np.cos(np.pi * k * (np.arange(n) + 0.5) / n) for n, k in zip(shape, halves, strict=True)
    )
    return rows[:, None] * cols


@pytest.mark.parametrize("detail", [0.0, 0.8, 2.0])
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_a_wave_is_scaled_by_its_frequency(detail: float, offset: float) -> None:
    z = wave((48, 70), (3, 5))
    frequency = np.hypot(np.pi * 3 / (48 * 3.0), np.pi * 5 / (70 * 2.0))
    found = texture(z + offset, None, (2.0, 3.0), detail=detail)
    np.testing.assert_allclose(found, z * frequency**detail, atol=1e-5)


def test_texture_is_linear_and_knows_no_level(rng: np.random.Generator) -> None:
    a, b = rng.normal(0, 1, (2, 40, 30))
    both = texture(2 * a - b, None, (1, 1))
    np.testing.assert_allclose(
        both, 2 * texture(a, None, (1, 1)) - texture(b, None, (1, 1)), atol=1e-5
    )
    assert abs(both.mean()) < 1e-6
    assert not texture(np.full((20, 20), 99.0), None, (1, 1)).any()


def test_texture_of_a_ridge_is_bright_along_it() -> None:
    z = -np.abs(np.arange(-30, 31.0))[:, None] * np.ones(50)
    found = texture(z, None, (1, 1))
    assert (found[30] > 1.5 * found[:30].max()).all()
    np.testing.assert_allclose(found, found[::-1], atol=1e-5)


def test_twice_the_cells_of_half_the_size_have_the_same_texture() -> None:
    coarse = texture(wave((40, 40), (3, 2)), None, (2.0, 2.0))
    fine = texture(wave((80, 80), (3, 2)), None, (1.0, 1.0))
    means = fine.reshape(40, 2, 40, 2).mean(axis=(1, 3))
    np.testing.assert_allclose(means, coarse, atol=0.01 * np.abs(coarse).max())


def test_holes_are_filled_smoothly_and_left_out(rng: np.random.Generator) -> None:
    z = wave((64, 64), (1, 1)) * 100
    valid = np.ones(z.shape, bool)
    valid[20:30, 24:36] = False
    ground = filled(np.where(valid, z, -9999), valid)
    offset = (z.max() + z.min()) / 2
    np.testing.assert_allclose(ground[valid], (z - offset)[valid], atol=1e-4)
    # Within what the land around has, and no step at the rim beyond the steepest of the hole's.
    ring = np.s_[19:31, 23:37]
    known = (z - offset)[ring][valid[ring]]
    assert known.min() <= ground[~valid].min()
    assert ground[~valid].max() <= known.max()
    found = texture(np.where(valid, z, -9999), valid, (1, 1))
    assert not found[~valid].any()
    np.testing.assert_allclose(
        found[valid], texture(z, None, (1, 1))[valid], atol=0.05 * np.abs(z).max()
    )
    far = np.s_[40:, 45:]
    np.testing.assert_allclose(found[far], texture(z, None, (1, 1))[far], atol=0.3)


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1), (2, 3)])
def test_small_rasters_and_lone_cells_have_a_texture(
    shape: tuple[int, int], rng: np.random.Generator
) -> None:
    z = rng.normal(0, 1, shape)
    assert np.isfinite(texture(z, None, (1, 1))).all()
    valid = np.zeros(shape, bool)
    valid.flat[0] = True
    assert not texture(z, valid, (1, 1)).any()
