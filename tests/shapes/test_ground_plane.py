"""The ground under objects: level, below all of them, and of closed triangles that look up."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictError
from meshdepict.scene.upright import UPS, upright
from meshdepict.shapes.joined import JoinedMesh


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(300)


@pytest.mark.parametrize("up", UPS)
def test_it_is_a_level_disc_below_all_that_stands_on_it(torus, up):
    ground = md.ground_under(torus, up=up)
    axis = upright(up)[:, 1]
    heights, level = torus.vertices @ axis, ground.vertices @ axis
    np.testing.assert_allclose(level, level[0], atol=1e-9)
    gap = heights.min() - level[0]
    assert 0 < gap < 2e-4 * torus.diagonal
    np.testing.assert_allclose(ground.normals, np.broadcast_to(axis, ground.normals.shape))
    middle = (torus.centre - ground.vertices.mean(axis=0)) @ (np.eye(3) - np.outer(axis, axis))
    np.testing.assert_allclose(middle, 0, atol=1e-9)


def test_its_triangles_cover_the_disc_once():
    ground = md.ground_under(md.samples.sphere(50), size=2)
    a, b, c = (ground.vertices[corner] for corner in ground.faces.T)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    radius = 2 * md.samples.sphere(50).diagonal
    assert area == pytest.approx(np.pi * radius**2, rel=1e-4)
    edges = np.sort(ground.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    rim = np.flatnonzero(
        np.isclose(np.linalg.norm(ground.vertices - ground.middle, axis=1), radius)
    )
    assert (count == 1).sum() == len(rim)
    assert count.max() == 2
    assert ground.open_faces.all()


def test_it_grows_and_moves_with_what_stands_on_it(torus):
    near = md.ground_under(torus)
    moved = md.Mesh(3 * torus.vertices + 1000.0, torus.faces, length_unit="mm")
    far = md.ground_under(moved)
    np.testing.assert_allclose(far.vertices, 3 * near.vertices + 1000.0, rtol=1e-12)
    assert far.length_unit == "mm"


def test_it_lies_under_the_lowest_of_several(torus):
    lower = md.Mesh(torus.vertices - np.array((5, 3, 0)), torus.faces)
    ground = md.ground_under([torus, lower])
    assert ground.vertices[:, 1].max() < lower.vertices[:, 1].min()
    assert ground.middle[0] == pytest.approx((torus.centre[0] + lower.centre[0]) / 2)


def test_pictures_show_its_middle_with_a_soft_edge(torus):
    ground = md.ground_under(torus)
    away = np.linalg.norm(ground.vertices - ground.middle, axis=1) / torus.diagonal
    assert (ground.coverage[away < 0.4] == 1).all()
    assert not ground.coverage[away > 1].any()
    order = np.argsort(away)
    assert (np.diff(ground.coverage[order]) <= 1e-6).all()
    assert np.abs(np.diff(ground.coverage[order])).max() < 0.05
    joined = JoinedMesh([torus, ground])
    assert (joined.coverage[: len(torus.vertices)] == 1).all()
    assert len(joined.outline) < len(joined.vertices)


def test_a_point_has_a_ground_too():
    flat = md.Mesh(np.full((3, 3), 7.0), [[0, 1, 2]])
    assert np.isfinite(md.ground_under(flat).vertices).all()


def test_what_cannot_have_a_ground_is_refused(torus):
    with pytest.raises(MeshdepictError, match="ground_under needs the mesh that stands on it"):
        md.ground_under([])
    with pytest.raises(MeshdepictError, match="ground_under needs the mesh that stands on it"):
        md.ground_under(md.HeightField(np.eye(3)))
    for size in (0.5, 1000, "wide"):
        with pytest.raises(MeshdepictError, match="is not a number of diagonals from 1 to 100"):
            md.ground_under(torus, size=size)
    with pytest.raises(MeshdepictError, match="mirror='yes' is neither True nor False"):
        md.ground_under(torus, mirror="yes")
    with pytest.raises(MeshdepictError, match="up='w' is not one of"):
        md.ground_under(torus, up="w")
