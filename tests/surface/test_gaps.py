"""Corners that differ by rounding are one point for shading, and stay two in the mesh."""

import numpy as np
import pytest
from conftest import rotation

from meshdepict import Mesh, MeshdepictWarning, bake
from meshdepict.io import read_mesh
from meshdepict.surface.gaps import closed_gaps
from meshdepict.surface.icosahedron import icosphere

BALL = icosphere(600)
GAPS = "corners at open edges differ from their neighbours' by rounding"


def soup(points, faces):
    """Every triangle by itself."""
    return points[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)


def shaken(points, size, rng):
    return points + rng.uniform(-size, size, points.shape)


def test_surfaces_without_gaps_are_left_alone():
    assert closed_gaps(*BALL) is None
    assert closed_gaps(*soup(*BALL)) is None  # bit for bit the same corners
    assert closed_gaps(np.eye(3), np.array([[0, 1, 2]])) is None
    points, faces = BALL
    assert closed_gaps(points, faces[points[faces, 2].max(axis=1) < 0.5]) is None  # a wide opening


@pytest.mark.parametrize("size", [1e-7, 1e-6, 3e-6])
def test_corners_apart_by_rounding_are_brought_together(rng, size):
    points, faces = soup(*BALL)
    closed = closed_gaps(shaken(points / 2, size / 2, rng), faces)
    assert closed is not None
    assert len(np.unique(closed.points, axis=0)) == len(BALL[0])
    assert closed.corners == len(points)
    assert 0 < closed.widest <= size * np.sqrt(3)
    np.testing.assert_allclose(closed.points, points / 2, atol=4 * size)


def test_gaps_wider_than_rounding_stay_open(rng):
    points, faces = soup(*BALL)
    assert closed_gaps(shaken(points / 2, 1e-3, rng), faces) is None


def test_small_faces_are_not_mended_away():
    """Corners as far apart as others' gaps are, but of faces no larger than that, stay two."""
    fine = BALL[0] * 1e-6, BALL[1]
    points = np.concatenate((fine[0], fine[0][BALL[1][0]] + 3e-6, BALL[0] / 2))
    n = len(BALL[0])
    faces = np.concatenate((fine[1][5:], [[n, n + 1, n + 2]], BALL[1][5:] + n + 3))
    assert closed_gaps(points, faces) is None


def test_more_corners_than_are_linked_at_once_are_still_one_point(rng):
    """A fan of fifty triangles by themselves: fifty corners at its hub."""
    angle = np.linspace(0, 2 * np.pi, 51)
    rim = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    triangles = np.stack((np.zeros((50, 3)), rim[:-1], rim[1:]), axis=1)
    points = shaken(triangles.reshape(-1, 3), 1e-7, rng) / 3
    closed = closed_gaps(points, np.arange(150).reshape(-1, 3))
    assert closed is not None
    assert len(np.unique(closed.points, axis=0)) == 51


@pytest.mark.parametrize("offset", [0, 4000])
def test_a_soup_with_gaps_is_shaded_like_a_surface(rng, offset):
    # Far away, single precision itself is as coarse as the gaps.
    points = (BALL[0] @ rotation(rng).T + offset).astype("f4")
    whole = Mesh(points, BALL[1])
    corners, faces = soup(points, BALL[1])
    torn = Mesh(shaken(corners, 2e-6, rng).astype("f4") if not offset else np.nextafter(
        corners, rng.choice(np.float32([-9e9, 9e9]), corners.shape)), faces)  # fmt: skip
    assert len(torn.vertices) == 3 * len(faces)  # the file's, not to be touched
    with pytest.warns(MeshdepictWarning, match=GAPS):
        found = torn.normals
    # As the normals of triangles with edges of 0.15 turn by corners off by 2e-6, or by one step.
    tolerance = 1e-4 if not offset else 0.02
    np.testing.assert_allclose(found, whole.normals[BALL[1]].reshape(-1, 3), atol=tolerance)


@pytest.mark.parametrize("turned", [0.3, 1.0])
def test_windings_in_a_soup_with_gaps_are_mended(rng, turned):
    points, faces = soup(*BALL)
    which = rng.random(len(faces)) < turned
    given = np.where(which[:, None], faces[:, ::-1], faces)
    torn = Mesh(shaken(points, 1e-6, rng), given)
    with pytest.warns(MeshdepictWarning, match=f"winding of {which.sum():,} faces.*{GAPS}"):
        np.testing.assert_array_equal(torn.orientation.flipped, which)


@pytest.mark.filterwarnings(f"ignore:.*{GAPS}")
def test_the_soup_after_a_public_report_is_shaded_like_the_whole(data):
    folder = data / "cases" / "soup-with-tiny-gaps"
    good, torn = (read_mesh(folder / name) for name in ("stl_ok.stl", "stl_soup_gaps.stl"))
    assert len(torn.vertices) > 5 * len(good.vertices)
    for method in ("lambert", "exaggerated", "mean_curvature"):
        ours = bake(torn, method).colors[torn.faces].astype(int)
        theirs = bake(good, method).colors[good.faces].astype(int)
        assert np.mean(np.abs(ours - theirs)) < 1  # of 255; apart, it was 17
        # Seven corners at a pole part from the other 33: their normals differ by more than 90°.
        assert np.percentile(np.abs(ours - theirs), 95) <= 2
