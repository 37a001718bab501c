"""Sums on a sparse grid against exact ones; bells and cells against what they are to be."""

import numpy as np
import pytest

from meshdepict import samples, threads
from meshdepict.sums import grid_sums
from meshdepict.sums.bells import RULES, bell, blur_taps, weight_table
from meshdepict.sums.block_layout import cells, morton_order
from meshdepict.sums.direct_sums import exact_sums
from meshdepict.sums.gaussian import GaussianSums
from meshdepict.sums.grid_sums import PointGrid, rule_for

ALL = [pytest.param(rule, id=f"{rule.nodes} nodes") for rule in RULES]


def torus(count=3000):
    mesh = samples.torus(count)
    return mesh.vertices - mesh.vertices.mean(axis=0)


def channels(points, count=9):
    rng = np.random.default_rng(5)
    mass = rng.uniform(0.2, 1, len(points))
    return np.vstack([mass, mass * rng.uniform(-1, 1, (count - 1, len(points)))])


def off(found, exact):
    return np.abs(found - exact).max() / exact[0].max()


# --- bells ------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", ALL)
@pytest.mark.parametrize("wider", [1.0, 1.3, 2.0, 3.0])
def test_two_bells_and_a_blur_are_a_gaussian(rule, wider):
    """Of two points anywhere between nodes, on the line."""
    width = wider * rule.density
    taps = blur_taps(rule, width)
    nodes = np.arange(-80, 81)
    blur = np.zeros((161, 161))
    reach = len(taps) // 2
    for apart, tap in zip(range(-reach, reach + 1), taps, strict=True):
        blur += tap * np.eye(161, k=apart)
    places = np.concatenate([np.linspace(0, 1, 17), np.linspace(1, 5 * width, 200)])
    weights = bell(places[:, None] - nodes, rule)
    found = weights @ blur @ weights[:17].T
    exact = np.exp(-0.5 * ((places[:, None] - places[:17]) / width) ** 2)
    assert np.abs(found - exact).max() <= rule.error


@pytest.mark.parametrize("rule", ALL)
def test_a_table_has_the_bell_between_its_steps(rule):
    table = weight_table(rule).astype(float)
    share = np.random.default_rng(1).random(200)
    at = share * (len(table) - 1)
    low, part = at.astype(int), (at % 1)[:, None]
    found = (1 - part) * table[low] + part * table[low + 1]
    exact = bell(np.arange(rule.nodes) - (rule.nodes / 2 - 1) - share[:, None], rule)
    # Where a bell of few nodes ends its slope has no bound; what it is there is small.
    assert np.abs(found - exact).max() < 0.1 * rule.error


def test_a_smaller_error_has_a_rule_of_more_nodes():
    assert [rule_for(error).nodes for error in (1e-1, 1e-3, 1e-4, 1e-5)] == [4, 4, 5, 6]
    assert rule_for(1e-7) is None


# --- layout -----------------------------------------------------------------------------------


def test_points_along_mortons_curve_stay_in_each_cube_until_all_were_there():
    places = np.random.default_rng(2).random((3, 4000))
    order = morton_order(places)
    for across in (2, 4, 16):
        cube = ((places * across).astype(int).T @ (1, across, across**2))[order]
        entered = cube[np.flatnonzero(np.diff(cube, prepend=-1))]
        assert len(entered) == len(np.unique(entered))


def test_points_of_a_cell_share_their_block():
    block = np.random.default_rng(3).integers(-9, 9, (500, 3)).astype(np.int32)
    found = cells(block, room=2)
    assert sorted(found.order) == list(range(500))
    for begin, end, key in zip(found.starts, found.starts[1:], found.keys, strict=False):
        own = block[found.order[begin:end]]
        assert (own == own[0]).all()
        assert key == found.keys[0] + (own[0] - block[found.order[0]]) @ found.step


# --- sums -------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", ALL)
@pytest.mark.parametrize("width", [0.1, 0.4, 1.5])
def test_sums_keep_the_error_of_their_rule(rule, width):
    points = torus()
    c = channels(points)
    found = PointGrid(points, c).sums(width, rule)
    # Beside the rule's, that of single precision.
    assert off(found, exact_sums(points, c, width)) <= 1.2 * rule.error


@pytest.mark.parametrize("rule", ALL)
def test_a_plane_at_the_worst_height_between_nodes_keeps_it_too(rule):
    rng = np.random.default_rng(4)
    flat = np.column_stack([rng.random((800, 2)), np.zeros(800)])
    low = [[0, 0, -0.5]]  # begins the grid
    width = 0.1
    for height in np.arange(5) / 5 * width / rule.density:
        points = np.vstack([low, flat + np.array([0, 0, height])])
        c = channels(points, 2)
        found = PointGrid(points, c).sums(width, rule)
        assert off(found, exact_sums(points, c, width)) <= 3 * rule.error


@pytest.mark.parametrize("count", [1, 2, 4, 7, 9, 16])
def test_any_number_of_channels(count):
    points = torus(600)
    c = channels(points, count)
    found = PointGrid(points, c).sums(0.2, RULES[-1])
    assert found.shape == (count, len(points))
    assert off(found, exact_sums(points, c, 0.2)) <= 1.2 * RULES[-1].error


def test_many_points_at_one_place_are_as_accurate():
    """Twenty thousand numbers of single precision, one after the other, would not be.

    All lie alike between nodes: the errors of three axes add up.
    """
    points = np.vstack([np.zeros((20_000, 3)), [[1.0, 1.0, 1.0]]])
    c = channels(points, 2)
    found = PointGrid(points, c).sums(0.2, RULES[-1])
    assert off(found[:, :1], c[:, :-1].sum(axis=1, keepdims=True)) <= 3 * RULES[-1].error


def test_layers_that_are_summed_one_after_the_other_are_the_whole(monkeypatch):
    points = torus()
    c = channels(points)
    whole = PointGrid(points, c).sums(0.05, RULES[-1])
    monkeypatch.setattr(grid_sums, "_MOST_BLOCKS", 40)
    shares = []
    layers = PointGrid(points, c).sums(0.05, RULES[-1], done=shares.append)
    assert len(shares) > 3
    assert sum(shares) == pytest.approx(1)
    assert off(layers, whole) < 1e-6


def test_the_same_bits_on_any_number_of_threads():
    points = torus(20_000)
    c = channels(points)
    found = []
    for count in (1, 2, 5):
        threads.limit(count)
        found.append(PointGrid(points, c).sums(0.03, RULES[-1]))
    threads.limit(None)
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_a_width_is_summed_the_same_whatever_was_asked_for_before():
    points = torus(8000)
    c = channels(points)
    widths = [0.1 * 2 ** (k / 2) for k in range(8)]
    all_at_once = GaussianSums(points, c, widths)
    first = [all_at_once.at(width, error=1e-4) for width in widths]
    again = GaussianSums(points, c, widths)
    for width, sums in reversed(list(zip(widths, first, strict=True))):
        np.testing.assert_array_equal(again.at(width, error=1e-4), sums)


def test_neighbouring_widths_share_what_was_spread(monkeypatch):
    calls = []
    spread = grid_sums._spread
    monkeypatch.setattr(grid_sums, "_spread", lambda *a: calls.append(1) or spread(*a))
    points = torus(20_000)
    widths = [0.4 * 2 ** (k / 2) for k in range(6)]
    grid = PointGrid(points, channels(points), widths)
    for width in widths:
        assert off(
            grid.sums(width, RULES[-1]), PointGrid(points, channels(points)).sums(width, RULES[-1])
        ) < 2 * RULES[-1].error  # fmt: skip
    assert len(calls) - len(widths) < len(widths)  # the second kind spreads each time


def test_targets_alone_are_gathered():
    points = torus()
    c = channels(points)
    targets = np.arange(len(points)) % 7 == 0
    grid = PointGrid(points, c)
    some, all_ = grid.sums(0.2, RULES[-1], targets=targets), grid.sums(0.2, RULES[-1])
    np.testing.assert_array_equal(some[:, targets], all_[:, targets])
    assert not some[:, ~targets].any()


@pytest.mark.parametrize("axis", range(3))
def test_a_line_of_points_and_a_far_one_need_no_more_than_their_blocks(axis):
    points = np.zeros((300, 3))
    points[:, axis] = np.linspace(0, 1, 300)
    points[-1, axis] = 1e4
    c = channels(points, 2)
    found = PointGrid(points, c).sums(0.05, RULES[-1])
    assert off(found, exact_sums(points, c, 0.05)) <= 3 * RULES[-1].error


def test_what_a_grid_cant_tell_costs_beyond_all_bounds():
    points = torus(500)
    grid = PointGrid(points, channels(points))
    assert grid.cost(1e-9, RULES[-1], 500) == np.inf
    assert grid.cost(1e9, RULES[-1], 500) == np.inf
    assert grid.cost(0.1, RULES[-1], 500) < np.inf
