from itertools import pairwise

import numpy as np
import pytest
from conftest import angle_between, rotation

from meshdepict import samples, scale_space, smooth_normals
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.scales import mesh_scales
from meshdepict.scene.view import View
from meshdepict.shapes.lengths import resolve_width
from meshdepict.shapes.mesh import Mesh


def exact_ladder(mesh, widths, facing, chosen=None):
    """METHODS §1 written out: every vertex against every other, one scale after the other.

    Returns the normals (scales, n, 3) and the resultants' share ‖m‖/ΣAG of the mass.
    """
    x, area, n = mesh.vertices - mesh.vertices.mean(axis=0), mesh.areas, mesh.normals
    chosen = np.arange(len(x)) if chosen is None else chosen
    reference = n[chosen]
    rungs, shares = [], []
    squared = ((x[chosen, None] - x[None]) ** 2).sum(axis=-1)
    for width in widths:
        gaussian = area * np.exp(-squared / (2 * width**2))
        weight = gaussian * (1 + reference @ n.T) / 2 if facing else gaussian
        m = weight @ n
        length = np.linalg.norm(m, axis=1)
        keep = length < 1e-6 * weight.sum(axis=1)
        reference = np.where(keep[:, None], reference, m / np.where(length > 0, length, 1)[:, None])
        rungs.append(reference)
        mass = gaussian.sum(axis=1)
        shares.append(length / np.where(mass > 0, mass, 1))
    return np.array(rungs), np.array(shares)


@pytest.mark.slow
@pytest.mark.parametrize("facing", [0, 1])
@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-4, 1e-6, 1e-7])
def test_normals_are_within_the_tolerance(ball, facing, tolerance, rng):
    space = scale_space(ball, scales=13, facing=facing, tolerance=tolerance)
    chosen = np.sort(rng.choice(len(ball.vertices), 80, replace=False))
    exact, shares = exact_ladder(ball, space.widths[1:], facing, chosen)
    angles = angle_between(space.normals[1:, chosen], exact)
    bound = shares >= 1e-3
    assert bound.mean() > 0.9
    assert angles[bound].max() <= tolerance


@pytest.mark.filterwarnings("ignore:.*are there twice")
@pytest.mark.parametrize("facing", [0, 1])
@pytest.mark.parametrize("name", ["bunny_69k", "gears_19k", "dragon_203k", "beetle_2k"])
def test_normals_of_real_scans_are_within_the_tolerance(data, name, facing, rng):
    from meshdepict.io import read_mesh

    mesh = read_mesh(data / "mesh" / f"{name}.ply", winding="keep")
    space = scale_space(mesh, scales=11, facing=facing, tolerance=1e-4)
    chosen = np.sort(rng.choice(len(mesh.vertices), 25, replace=False))
    exact, shares = exact_ladder(mesh, space.widths[1:], facing, chosen)
    angles = angle_between(space.normals[1:, chosen], exact)
    assert angles[shares >= 1e-3].max() <= 1e-4


def test_the_first_set_are_the_original_normals(ball):
    space = scale_space(ball, scales=2)
    np.testing.assert_allclose(space.normals[0], ball.normals, atol=1e-7)
    assert space.widths[0] == 0
    np.testing.assert_allclose(space.widths[1:], ball.edge_length * np.array([1, np.sqrt(2)]))


def test_normals_are_unit_finite_and_read_only(ball):
    space = scale_space(ball, scales=5)
    assert space.normals.shape == (6, len(ball.vertices), 3)
    assert space.normals.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(space.normals, axis=2), 1, atol=2e-7)
    with pytest.raises(ValueError, match="read-only"):
        space.normals[0, 0, 0] = 1


def test_a_sphere_keeps_its_normals_at_every_width(sphere):
    space = scale_space(sphere, scales=12, tolerance=1e-4)
    # By symmetry; what is left is the triangulation's unevenness (it falls with resolution).
    assert angle_between(space.normals, sphere.vertices).max() < 0.02


def test_a_narrow_width_changes_nothing(ball):
    space = scale_space(ball, scales=1, width=ball.edge_length / 20)
    assert angle_between(space.normals[1], ball.normals).max() < 1e-4


@pytest.mark.filterwarnings("ignore:width")
def test_widths_beyond_all_sense(ball):
    narrow = scale_space(ball, scales=2, width=1e-310)
    assert angle_between(narrow.normals[1:], ball.normals).max() < 1e-4
    wide = scale_space(ball, scales=2, width=1e300)
    assert np.isfinite(wide.normals).all()


@pytest.mark.filterwarnings("ignore:width")
def test_without_facing_the_widest_scale_points_one_way():
    sheet = samples.wavy_sheet(2_000)
    space = scale_space(sheet, scales=1, width=1e4 * sheet.diagonal, facing=0)
    total = sheet.areas @ sheet.normals
    assert angle_between(space.normals[1], total / np.linalg.norm(total)).max() < 1e-4


def two_sided_sheet(gap=0.02):
    """A thin closed slab: two parallel sheets much closer than they are wide."""
    upper = samples.wavy_sheet(2_000)
    n = len(upper.vertices)
    vertices = np.vstack([upper.vertices, upper.vertices - [0, 0, gap]])
    return Mesh(vertices, np.vstack([upper.faces, upper.faces[:, ::-1] + n]), winding="keep"), n


def test_a_thin_sheet_keeps_its_two_sides():
    slab, n = two_sided_sheet()
    space = scale_space(slab, scales=9)
    up = space.normals[:, :, 2]
    assert (up[:, :n] > 0).all()
    assert (up[:, n:] < 0).all()


def test_without_facing_a_thin_sheet_cancels():
    slab, n = two_sided_sheet()
    space = scale_space(slab, scales=9, facing=0)
    assert not (space.normals[-1, :n, 2] > 0).all() or not (space.normals[-1, n:, 2] < 0).all()


def test_turning_scaling_moving_and_permuting_change_nothing(ball, rng):
    space = scale_space(ball, scales=6)
    turn, order = rotation(rng), rng.permutation(len(ball.vertices))
    rank = np.argsort(order)
    # Moved by 5e6 diameters the coordinates keep 9 digits: 1e-9 of a diameter, 1e-7 of an edge.
    moved = Mesh((3.0 * ball.vertices @ turn.T)[order] + 5e6, rank[ball.faces])
    again = scale_space(moved, scales=6)
    np.testing.assert_allclose(again.widths, 3 * space.widths, rtol=1e-6)
    assert angle_between(again.normals, (space.normals @ turn.T)[:, order]).max() < 2e-4


@pytest.mark.parametrize("factor", [1e-140, 1e-20, 1e20, 1e140])
def test_tiny_and_huge_units(factor):
    ball = samples.golf_ball(600)
    plain = scale_space(ball, scales=4)
    scaled = scale_space(Mesh(ball.vertices * factor, ball.faces), scales=4)
    assert angle_between(plain.normals, scaled.normals).max() < 1e-4


def test_smooth_normals_is_the_last_rung_of_the_ladder(ball):
    width = 5 * ball.edge_length
    rungs = 5  # 5/√2^4 = 1.25 edges is the last one above an edge
    space = scale_space(ball, scales=rungs, width=width * 2 ** (-(rungs - 1) / 2))
    np.testing.assert_array_equal(smooth_normals(ball, width), space.normals[-1])


def test_smooth_normals_below_an_edge_takes_one_rung(ball):
    width = ball.edge_length / 3
    np.testing.assert_array_equal(
        smooth_normals(ball, width), scale_space(ball, scales=1, width=width).normals[-1]
    )


def test_isolated_and_empty_vertices_stay_defined():
    ball = samples.golf_ball(600)
    vertices = np.vstack([ball.vertices, [[1.2, 0, 0]], [[1e3, 0, 0]]])
    mesh = Mesh(vertices, ball.faces)
    space = scale_space(mesh, scales=6, width=0.2)
    np.testing.assert_array_equal(space.normals[:, -1], np.broadcast_to((0, 0, 1), (7, 3)))
    # Near the surface it is smoothed like any other vertex.
    assert space.normals[-1, -2, 0] > 0.5


def test_a_cavity_stays_a_cavity():
    outer, inner = samples.sphere(600), samples.sphere(600, radius=0.8)
    n = len(outer.vertices)
    mesh = Mesh(
        np.vstack([outer.vertices, inner.vertices]),
        np.vstack([outer.faces, inner.faces[:, ::-1] + n]),
    )
    radial = np.einsum("snk,nk->sn", scale_space(mesh, scales=6).normals, mesh.vertices)
    assert (radial[:, :n] > 0).all()
    assert (radial[:, n:] < 0).all()


def test_no_scales_compute_no_sums(ball, monkeypatch):
    monkeypatch.setattr(mesh_scales, "NormalSums", None)
    space = scale_space(ball, scales=0)
    assert space.normals.shape == (1, len(ball.vertices), 3)
    assert list(space.widths) == [0]


def test_progress_ends_at_the_total(ball):
    calls = []
    scale_space(ball, scales=3, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (3, 3)
    assert all(a <= b for (a, _), (b, _) in pairwise(calls))


def test_view_curvature_is_computed_once_per_scale_foreshortening_and_view(ball, monkeypatch):
    from meshdepict.curvature import view as module

    space, compute, calls = scale_space(ball, scales=2), module.view_tensor, []
    monkeypatch.setattr(
        module, "view_tensor", lambda *given, **more: calls.append(1) or compute(*given, **more)
    )
    found = space.view_curvature("front", 1)
    assert space.view_curvature("front", 1) is found
    assert space.view_curvature(View.fitted("front", ball), 1) is found  # equal, not the same
    assert len(calls) == 1
    larger = View.fitted("front", ball, height_px=500)
    for number, (view, scale, power) in enumerate(
        [("front", 2, 1), ("front", 1, 0.4), ("left", 1, 1), (larger, 1, 1), ("front", 1, 1)], 2
    ):
        other = space.view_curvature(view, scale, foreshortening=power)
        assert other is space.view_curvature(view, scale, foreshortening=power)
        assert len(calls) == number
        assert any((a != b).any() for a, b in zip(found, other, strict=True)) == (number < 6)
    with pytest.raises(ValueError, match="read-only"):
        found.ku[0] = 0


@pytest.mark.parametrize(
    ("width", "expected"), [(0.5, 0.5), ("0.5", 0.5), ("10%", 0.1), (" 10 % ", 0.1), (None, 0.01)]
)
def test_widths_are_lengths_shares_or_an_edge(width, expected):
    class Shape:
        diagonal, edge_length = 1.0, 0.01

    assert resolve_width(width, Shape()) == pytest.approx(expected)


def test_a_width_beyond_the_shape_is_said(ball):
    class Shape:
        diagonal, edge_length = 1.0, 0.01

    with pytest.warns(MeshdepictWarning, match="more than the object's diagonal of 1: .* is 0.01"):
        assert resolve_width("120%", Shape()) == 1.2
    assert resolve_width("100%", Shape()) == 1


@pytest.mark.parametrize("width", [0, -1, "0%", "wide", float("nan"), float("inf"), [1], "%"])
def test_a_width_that_is_no_length(ball, width):
    with pytest.raises(MeshdepictError, match="not a positive length"):
        scale_space(ball, scales=1, width=width)


@pytest.mark.filterwarnings("ignore:width")
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scales": -1}, "scales=-1 is not a whole number"),
        ({"scales": 2.5}, "scales=2.5 is not a whole number"),
        ({"scales": True}, "scales=True"),
        ({"ratio": 1.0}, "ratio=1.0 is not a number above 1"),
        ({"ratio": float("nan")}, "ratio=nan"),
        ({"facing": 2}, "facing=2 is neither 0"),
        ({"tolerance": 0.0}, "tolerance=0.0 is not an angle"),
        ({"tolerance": 1.0}, "tolerance=1.0"),
        ({"scales": 64, "ratio": 10, "width": 1e300}, "grow beyond all numbers"),
    ],
)
def test_parameters_out_of_range(ball, options, message):
    with pytest.raises(MeshdepictError, match=message):
        scale_space(ball, **options)
