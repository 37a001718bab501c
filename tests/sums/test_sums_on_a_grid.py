"""Sums on a sparse grid against exact ones; bells and cells against what they are to be."""

import numpy as np
import pytest

from meshdepict import samples, threads
from meshdepict.sums import grid_sums
from meshdepict.sums.bells import RULES, bell, blur_taps, weight_table
from meshdepict.sums.block_layout import cells
from meshdepict.sums.direct_sums import exact_sums
from meshdepict.sums.gaussian import GaussianSums
from meshdepict.sums.grid_sums import PointGrid, rule_for
from meshdepict.sums.ordered_points import OrderedPoints

ALL = [pytest.param(rule, id=f"{rule.nodes} nodes") for rule in RULES]


def torus(count=3000):
    mesh = samples.torus(count)
    return mesh.vertices - mesh.vertices.mean(axis=0)


def channels(points, count=9):
    rng = np.random.default_rng(5)
    mass = rng.uniform(0.2, 1, len(points))
    return np.vstack([mass, mass * rng.uniform(-1, 1, (count - 1, len(points)))])


def grid_of(points, c, widths=()):
    return PointGrid(OrderedPoints(points, c), widths)


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
    table = weight_table(rule, 8).astype(float)
    share = np.random.default_rng(1).random(200)
    at = share * (len(table) - 1)
    low, part = at.astype(int), (at % 1)[:, None]
    assert not table[:, :, rule.nodes :].any()
    found = (table[low, 0] + part * table[low, 1])[:, : rule.nodes]
    exact = bell(np.arange(rule.nodes) - (rule.nodes / 2 - 1) - share[:, None], rule)
    # Where a bell of few nodes ends its slope has no bound; what it is there is small.
    assert np.abs(found - exact).max() < 0.1 * rule.error


def test_a_smaller_error_has_a_rule_of_more_nodes():
    assert [rule_for(error).nodes for error in (1e-1, 1e-3, 1e-4, 1e-5)] == [4, 4, 5, 6]
    assert rule_for(1e-7) is None


# --- layout -----------------------------------------------------------------------------------


def test_points_of_a_cell_share_their_block():
    key = np.random.default_rng(3).integers(0, 50, 500)
    key[100:300] = 7  # as they mostly are: one after the other
    found = cells(key, np.array([1, 5, 25]), np.zeros(3, np.int64))
    assert sorted(found.order) == list(range(500))
    np.testing.assert_array_equal(found.keys, np.unique(key))
    for begin, end, own in zip(found.starts, found.starts[1:], found.keys, strict=False):
        assert (key[found.order[begin:end]] == own).all()
        assert (np.diff(found.order[begin:end]) > 0).all()
    np.testing.assert_array_equal(found.places(0, 50) @ found.step, found.keys)


@pytest.mark.parametrize("count", [1, 15, 16, 17, 400, 4995])
def test_points_in_order_are_all_there_and_sixteen_of_them_close_together(count):
    points = torus(5000)[:count]
    found = OrderedPoints(points, channels(points, 3))
    assert sorted(found.order) == list(range(count))
    np.testing.assert_array_equal(found.points, points[found.order])
    np.testing.assert_array_equal(found.rows.T, found.channels[:, found.order].astype(np.float32))
    if count == 4995:
        whole = found.points[:4992].reshape(-1, 16, 3)
        across = np.linalg.norm(np.ptp(whole, axis=1), axis=1)
        area = samples.torus(5000).areas.mean()
        assert np.median(across) < 2 * np.sqrt(16 * area)  # a square's diagonal has √2


def test_points_at_one_place_are_put_in_order_as_well():
    points = np.zeros((3000, 3))
    assert sorted(OrderedPoints(points, channels(points, 1)).order) == list(range(3000))


# --- sums -------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", ALL)
@pytest.mark.parametrize("width", [0.1, 0.4, 1.5])
def test_sums_keep_the_error_of_their_rule(rule, width):
    points = torus()
    c = channels(points)
    found = grid_of(points, c).sums(width, rule)
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
        found = grid_of(points, c).sums(width, rule)
        assert off(found, exact_sums(points, c, width)) <= 3 * rule.error


@pytest.mark.parametrize("count", [1, 2, 4, 7, 9, 16])
def test_any_number_of_channels(count):
    points = torus(600)
    c = channels(points, count)
    found = grid_of(points, c).sums(0.2, RULES[-1])
    assert found.shape == (count, len(points))
    assert off(found, exact_sums(points, c, 0.2)) <= 1.2 * RULES[-1].error


def test_many_points_at_one_place_are_as_accurate():
    """Twenty thousand numbers of single precision, one after the other, would not be.

    All lie alike between nodes: the errors of three axes add up.
    """
    points = np.vstack([np.zeros((20_000, 3)), [[1.0, 1.0, 1.0]]])
    c = channels(points, 2)
    found = grid_of(points, c).sums(0.2, RULES[-1])
    assert off(found[:, :1], c[:, :-1].sum(axis=1, keepdims=True)) <= 3 * RULES[-1].error


def test_layers_that_are_summed_one_after_the_other_are_the_whole(monkeypatch):
    points = torus()
    c = channels(points)
    whole = grid_of(points, c).sums(0.05, RULES[-1])
    monkeypatch.setattr(grid_sums, "_MOST_BLOCKS", 40)
    shares = []
    layers = grid_of(points, c).sums(0.05, RULES[-1], done=shares.append)
    assert len(shares) > 3
    assert sum(shares) == pytest.approx(1)
    assert off(layers, whole) < 1e-6


def test_the_same_bits_on_any_number_of_threads():
    points = torus(20_000)
    c = channels(points)
    found = []
    for count in (1, 2, 5):
        threads.limit(count)
        found.append(grid_of(points, c).sums(0.03, RULES[-1]))
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
    spread = PointGrid._spread
    monkeypatch.setattr(PointGrid, "_spread", lambda *a: calls.append(1) or spread(*a))
    points = torus(20_000)
    widths = [0.4 * 2 ** (k / 2) for k in range(6)]
    grid = grid_of(points, channels(points), widths)
    for width in widths:
        assert off(
            grid.sums(width, RULES[-1]), grid_of(points, channels(points)).sums(width, RULES[-1])
        ) < 2 * RULES[-1].error  # fmt: skip
    assert len(calls) - len(widths) < len(widths)  # the second kind spreads each time


def test_targets_alone_are_gathered():
    points = torus()
    c = channels(points)
    targets = np.arange(len(points)) % 7 == 0
    grid = grid_of(points, c)
    some, all_ = grid.sums(0.2, RULES[-1], targets=targets), grid.sums(0.2, RULES[-1])
    np.testing.assert_array_equal(some[:, targets], all_[:, targets])
    assert not some[:, ~targets].any()


@pytest.mark.parametrize("axis", range(3))
def test_a_line_of_points_and_a_far_one_need_no_more_than_their_blocks(axis):
    points = np.zeros((300, 3))
    points[:, axis] = np.linspace(0, 1, 300)
    points[-1, axis] = 1e4
    c = channels(points, 2)
    found = grid_of(points, c).sums(0.05, RULES[-1])
    assert off(found, exact_sums(points, c, 0.05)) <= 3 * RULES[-1].error


def test_what_a_grid_cant_tell_costs_beyond_all_bounds():
    points = torus(500)
    grid = grid_of(points, channels(points))
    assert grid.cost(1e-9, RULES[-1], 500) == np.inf
    assert grid.cost(1e9, RULES[-1], 500) == np.inf
    assert grid.cost(0.1, RULES[-1], 500) < np.inf
