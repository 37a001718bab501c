"""Polygons of very many corners: triangles that cover them once, in a time that follows them."""

import time

import numpy as np
import pytest

from meshdepict.surface.ears import clip_large
from meshdepict.surface.polygons import Polygons, triangulate


def star(count):
    angle = np.arange(count) * (2 * np.pi / count)
    radius = np.where(np.arange(count) % 2, 1.0, 0.6)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1)


def comb(count):
    x = np.arange(count - 2) / count
    teeth = np.stack((x, np.where(np.arange(count - 2) % 2, 1.0, 0.1)), axis=1)
    return np.concatenate((teeth[::-1], [[0, 0], [1, 0]]))


def spiral(count):
    """A strip wound up: its ears are few, and at its ends."""
    turn = np.linspace(0, 20 * np.pi, count // 2)
    way = np.stack((np.cos(turn), np.sin(turn)), axis=1)
    outer = (turn / 60 + 0.1)[:, None]
    return np.concatenate((outer * way, ((outer - 0.05) * way)[::-1]))


def ragged(count):
    angle = np.arange(count) * (2 * np.pi / count)
    radius = 1 + 0.3 * np.random.default_rng(0).random(count)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1)


def straight(count):
    """A concave one with most corners along straight sides."""
    side = np.linspace(0, 1, count // 4, endpoint=False)
    zero, one = 0 * side, 0 * side + 1
    edges = [(side, 0.9 * side), (one, 0.9 + 0.1 * side), (1 - side, one), (zero, 1 - side)]
    return np.concatenate([np.stack(edge, axis=1) for edge in edges])


SHAPES = (star, comb, spiral, ragged, straight)


def doubled_areas(flat, triangles):
    a, b, c = (flat[corner] for corner in triangles.T)
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("count", [200, 5000])
def test_triangles_cover_the_polygon_once(shape, count):
    flat = shape(count)
    triangles = clip_large(flat)
    assert len(triangles) == len(flat) - 2
    areas = doubled_areas(flat, triangles)
    x, y = flat.T
    # Summed 5000 products of numbers about one.
    np.testing.assert_allclose(areas.sum(), np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    assert areas.min() > -1e-12  # none is turned, so none lies over another
    # Every side belongs to one triangle, every other edge to two in opposite directions.
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert len(np.unique(sides, axis=0)) == len(sides)
    forward = {tuple(side) for side in sides.tolist()}
    rim = {side for side in forward if side[::-1] not in forward}
    assert rim == {(k, (k + 1) % len(flat)) for k in range(len(flat))}


def test_what_crosses_itself_or_has_no_area_still_gives_all_its_triangles(rng):
    for flat in (rng.random((500, 2)), np.zeros((300, 2)), np.tile(rng.random((1, 2)), (200, 1))):
        triangles = clip_large(flat)
        assert triangles.shape == (len(flat) - 2, 3)
        assert len(np.unique(triangles)) == len(flat)
    line = np.stack((np.linspace(0, 1, 300), np.zeros(300)), axis=1)
    assert len(np.unique(clip_large(line))) == 300


@pytest.mark.parametrize("shape", SHAPES)
def test_time_follows_the_corners(shape):
    clip_large(shape(200))  # compiled
    taken = []
    for count in (25_000, 100_000):
        flat = shape(count)
        points = np.concatenate((flat, np.zeros((len(flat), 1))), axis=1)
        offsets = np.array([0, len(flat)])
        start = time.process_time()
        triangles, _ = triangulate(points, Polygons(np.arange(len(flat)), offsets))
        taken.append(time.process_time() - start)
        assert len(triangles) == len(flat) - 2
    # Four times the corners: about 4.5 measured; the square would be 16.
    assert taken[1] < 10 * max(taken[0], 0.02)


def test_many_sizes_of_polygons_cost_no_more_than_one():
    """Every size from 3 to 1000, convex: as many looks at all polygons would be 10⁹ for these."""
    sizes = np.concatenate((np.arange(3, 1000), np.full(300_000, 3)))
    offsets = np.concatenate(([0], np.cumsum(sizes)))
    angle = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    points = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    corners = np.arange(offsets[-1]) - np.repeat(offsets[:-1], sizes)
    start = time.process_time()
    triangles, owner = triangulate(points, Polygons(corners, offsets))
    assert time.process_time() - start < 2  # measured: 0.2 s
    np.testing.assert_array_equal(np.bincount(owner), sizes - 2)
    assert triangles.max() == 998
