"""Polygons: the accepted forms, and triangles that cover each polygon once, wound as it is."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import pytest
from conftest import rotation

from meshdepict.errors import MeshdepictError
from meshdepict.surface.polygons import Polygons, as_polygons, strip_triangles, triangulate


def area_vectors(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def newell(points: np.ndarray) -> np.ndarray:
    return np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0) / 2


def star(rng: np.random.Generator, size: int) -> np.ndarray:
    """A simple polygon in the plane, counter-clockwise, mostly concave."""
    angle = (np.arange(size) + rng.uniform(0, 0.9, size)) * 2 * np.pi / size
    radius = rng.uniform(0.1, 1, size)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), np.zeros(size)), axis=1)


def comb(size: int) -> np.ndarray:
    """A simple polygon whose teeth no fan can cover."""
    teeth = size // 2
    x = np.arange(teeth, dtype=float)
    top = np.stack((x, np.where(x % 2, 1.0, 0.1), 0 * x), axis=1)
    x = np.arange(size - teeth, dtype=float)
    return np.concatenate((np.stack((x, 0 * x - 0.05, 0 * x), axis=1), top[::-1]))


def one(points: np.ndarray, corners: list[int] | None = None) -> np.ndarray:
    """Triangulate a single polygon."""
    listed = list(range(len(points))) if corners is None else corners
    return triangulate(np.asarray(points, float), as_polygons([listed]))[0]


def assert_covers(points: np.ndarray, triangles: np.ndarray) -> None:
    """Each triangle faces as the polygon does, and their areas sum to its area."""
    normal = newell(points)
    along = area_vectors(points, triangles) @ normal / np.linalg.norm(normal)
    rounding = 1e-12 * np.ptp(points, axis=0).max() ** 2
    assert along.min() >= -rounding
    assert along.sum() == pytest.approx(np.linalg.norm(normal), rel=1e-9)


# --- accepted forms -----------------------------------------------------------------------------


def test_all_forms_of_the_same_faces_agree():
    table = [[0, 1, 2, 3], [3, 2, 4, 5]]
    expected = as_polygons(np.array(table))
    for form in (table, np.array(table, np.uint32), [np.array(face) for face in table], expected):
        found = as_polygons(form)
        assert found.connectivity.tolist() == [0, 1, 2, 3, 3, 2, 4, 5]
        assert found.offsets.tolist() == [0, 4, 8]
        assert found.connectivity.dtype == found.offsets.dtype == np.int64


def test_ragged_faces():
    found = as_polygons([[0, 1, 2], np.array([2, 1, 3, 4]), (0, 1, 2, 3, 4)])
    assert found.offsets.tolist() == [0, 3, 7, 12]
    assert found.connectivity.tolist() == [0, 1, 2, 2, 1, 3, 4, 0, 1, 2, 3, 4]


def test_no_faces_is_no_polygon():
    assert as_polygons([]).offsets.tolist() == [0]
    assert as_polygons(np.empty((0, 3), int)).connectivity.shape == (0,)


def test_the_callers_arrays_stay_the_callers():
    connectivity, offsets = np.array([0, 1, 2]), np.array([0, 3])
    for given in (Polygons(connectivity, offsets), connectivity.reshape(1, 3)):
        for part in as_polygons(given):
            assert not np.shares_memory(part, connectivity)
            assert not np.shares_memory(part, offsets)


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        (np.array([[0.0, 1.0, 2.0]]), "whole numbers, not float64"),
        ([[0, 1, 2], [0.5, 1, 2, 3]], "whole numbers, not float64"),
        (np.array([[True, False, True]]), "whole numbers, not bool"),
        (np.array([0, 1, 2]), r"not shape \(3,\)"),
        (np.array([[0, 1]]), r"not shape \(1, 2\)"),
        ([[0, 1, 2], 7], "list of index lists"),
        (Polygons(np.array([0, 1, 2]), np.array([0, 2])), "offsets"),
        (Polygons(np.array([0, 1, 2]), np.array([0, 4, 3])), "offsets"),
        (Polygons(np.array([0, 1, 2]), np.array([], int)), "offsets"),
    ],
)
def test_other_forms_are_refused(faces, message):
    with pytest.raises(MeshdepictError, match=message):
        as_polygons(faces)


# --- triangles ----------------------------------------------------------------------------------


def test_triangles_stay_as_they_are():
    faces = np.array([[2, 1, 0], [0, 1, 3]])
    triangles, owner = triangulate(np.zeros((4, 3)), as_polygons(faces))
    assert triangles.tolist() == faces.tolist()
    assert owner.tolist() == [0, 1]


def test_mixed_polygons_keep_their_order_and_owner(rng):
    shapes = [star(rng, size) for size in (3, 5, 4, 12, 3, 4)]
    points = np.concatenate(shapes)
    starts = np.cumsum([0, *map(len, shapes)])
    faces = [list(range(a, b)) for a, b in pairwise(starts)]
    triangles, owner = triangulate(points, as_polygons(faces))
    assert owner.tolist() == [0] + [1] * 3 + [2] * 2 + [3] * 10 + [4] + [5] * 2
    for index, shape in enumerate(shapes):
        assert_covers(shape, triangles[owner == index] - starts[index])


def test_corners_of_less_than_three_indices_are_skipped():
    polygons = as_polygons([[0, 1], [0, 1, 2], [1], [], [0, 1, 2, 3]])
    triangles, owner = triangulate(np.eye(4, 3), polygons)
    assert owner.tolist() == [1, 4, 4]
    assert len(triangles) == 3


SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)


@pytest.mark.parametrize("turn", range(4))
def test_a_dart_takes_the_diagonal_inside(turn):
    dart = np.roll([[0, 0, 0], [2, 0, 0], [0.4, 0.4, 0], [0, 2, 0]], turn, axis=0)
    assert_covers(dart, one(dart))


@pytest.mark.parametrize("turn", range(4))
def test_a_flat_kite_takes_the_shorter_diagonal(turn):
    kite = np.roll([[0, 0, 0], [3, -1, 0], [6, 0, 0], [3, 1, 0]], turn, axis=0)
    shared = {frozenset(face) for face in one(kite).tolist()}
    short = {(1 + turn) % 4, (3 + turn) % 4}
    assert all(short < face for face in shared)


@pytest.mark.parametrize("size", [5, 6, 8, 17])
def test_convex_polygons_become_fans(size):
    angle = np.arange(size) * 2 * np.pi / size
    points = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    assert one(points).tolist() == [[0, k, k + 1] for k in range(1, size - 1)]


@pytest.mark.parametrize("size", [4, 5, 6, 7, 9, 14, 36])
def test_simple_polygons_are_covered_exactly_once(rng, size):
    for _ in range(30):
        points = star(rng, size) @ rotation(rng).T + rng.normal(size=3)
        assert_covers(points, one(points))
        assert_covers(points[::-1], one(points[::-1]))


@pytest.mark.parametrize("size", [8, 21, 60])
def test_combs_are_covered_exactly_once(size):
    points = comb(size)
    assert_covers(points, one(points))


def test_a_hole_with_a_bridge():
    """A square with a square hole, cut open along an edge that is walked both ways."""
    outer = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]]
    inner = [[1, 1, 0], [1, 3, 0], [3, 3, 0], [3, 1, 0]]
    points = np.array([*outer, outer[0], *inner, inner[0]], float)
    order = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    triangles = one(points, order)
    assert_covers(points, triangles)
    assert np.linalg.norm(area_vectors(points, triangles), axis=1).sum() == pytest.approx(12)


def test_points_on_a_side_get_a_proper_triangle():
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], float)
    triangles = one(points)
    assert_covers(points, triangles)
    assert np.linalg.norm(area_vectors(points, triangles), axis=1).min() > 0


def test_far_away_and_tiny_polygons_are_split_like_others(rng):
    points = np.round(star(rng, 9) * 1024) / 1024  # exact, also after moving
    expected = one(points)
    assert one(points + np.array([2.0**30, -(2.0**31), 2.0**28])).tolist() == expected.tolist()
    assert one(points * 2.0**-500).tolist() == expected.tolist()
    assert one(points * 2.0**480).tolist() == expected.tolist()


@pytest.mark.parametrize("size", [4, 5, 9])
@pytest.mark.parametrize("kind", ["point", "line", "spike"])
def test_degenerate_polygons_still_give_their_triangles(size, kind):
    points = np.zeros((size, 3))
    if kind == "line":
        points[:, 0] = np.arange(size)
    elif kind == "spike":
        points[1::2, 0] = 1
    triangles = one(points)
    assert triangles.shape == (size - 2, 3)
    assert all(len(set(face)) == 3 for face in triangles.tolist())


def test_self_crossing_and_folded_polygons_never_fail(rng):
    for size in (4, 5, 8, 13):
        points = rng.normal(size=(size, 3))
        triangles = one(points)
        assert triangles.shape == (size - 2, 3)
        # Any triangulation of a closed polygon has its area vector, whatever its shape.
        np.testing.assert_allclose(
            area_vectors(points, triangles).sum(axis=0), newell(points), atol=1e-12
        )


def test_winding_is_the_polygons(rng):
    """Along a polygon's sides the triangles run in its direction."""
    points = star(rng, 11)
    sides = {(k, (k + 1) % 11) for k in range(11)}
    for corners in (list(range(11)), list(range(11))[::-1]):
        triangles = one(points, corners)
        found = set(map(tuple, triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).tolist()))
        wanted = sides if corners[0] == 0 else {(b, a) for a, b in sides}
        assert wanted <= found


def test_quads_are_split_without_a_loop_over_them():
    side = 500
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0))
    points = np.stack((x, y, np.sin(x)), axis=2).reshape(-1, 3)
    grid = np.arange((side + 1) ** 2).reshape(side + 1, side + 1)
    quads = np.stack((grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]), axis=2)
    polygons = as_polygons(quads.reshape(-1, 4))
    start = time.process_time()
    triangles, _ = triangulate(points, polygons)
    # Measured: 0.09 s. The bound only has to catch a loop over the 250,000 polygons (about 3 s).
    assert time.process_time() - start < 1
    assert area_vectors(points, triangles)[:, 2].sum() == pytest.approx(side**2)


# --- strips -------------------------------------------------------------------------------------


def test_a_strip_alternates_its_winding():
    x = np.repeat(np.arange(4.0), 2)
    points = np.stack((x, np.tile([1.0, 0.0], 4), 0 * x), axis=1)
    triangles, owner = strip_triangles(Polygons(np.arange(8), np.array([0, 8])))
    assert len(triangles) == 6
    assert (area_vectors(points, triangles)[:, 2] > 0).all()
    assert owner.tolist() == [0] * 6


def test_joined_and_short_strips():
    strips = as_polygons([[0, 1, 2, 2, 3, 3, 4, 5], [7, 8], [], [9, 8, 7]])
    triangles, owner = strip_triangles(strips)
    assert triangles.tolist() == [[0, 1, 2], [4, 3, 5], [9, 8, 7]]  # the sixth triangle is odd
    assert owner.tolist() == [0, 0, 3]
