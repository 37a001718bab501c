"""Sums over points in several places are those over all of them."""

import numpy as np
import pytest

from meshdepict.sums.shared_grid import FINEST, block_reach, gathered_sums, spread_blocks


@pytest.fixture
def shell(rng):
    points = rng.normal(size=(6_000, 3))
    points *= 0.4 / np.linalg.norm(points, axis=1)[:, None]
    points += (0.3, -2, 5)  # the origin is nobody's
    return points, np.concatenate([rng.random((1, 6_000)), rng.normal(size=(3, 6_000)) / 3])


@pytest.mark.parametrize("width", [0.05, 0.3])
def test_parts_add_up_to_the_exact_sums(shell, width):
    points, channels = shell
    part = (points[:, 0] > 0.2) + 2 * (points[:, 2] > 5.1)
    blocks = [spread_blocks(points[part == i], channels[:, part == i], width) for i in range(4)]
    for i in range(4):
        some = points[part == i][:200]
        squared = ((some[:, None] - points) ** 2).sum(axis=2)
        exact = channels @ np.exp(-squared / (2 * width**2)).T
        found = gathered_sums(some, 4, width, blocks)
        assert np.abs(found - exact).max() < FINEST.error * exact[0].max()


def test_blocks_beyond_reach_may_be_missing(shell):
    points, channels = shell
    width = 0.02
    some = points[points[:, 0] < 0.0]
    _, reach = block_reach(width)
    near = points[:, 0] < some[:, 0].max() + reach
    assert not near.all()
    one = spread_blocks(points[near], channels[:, near], width)
    other = spread_blocks(points[~near], channels[:, ~near], width)
    np.testing.assert_array_equal(
        gathered_sums(some, 4, width, [one]), gathered_sums(some, 4, width, [one, other])
    )
