"""Rays turn open vessels outwards and leave sheets alone."""

import numpy as np
import pytest
from windings import BALL, CUBE, both, flips, inside_out, moved, opened, sheet, tube, turned

from meshdepict.surface.edges import cleaned
from meshdepict.surface.icosahedron import icosphere
from meshdepict.surface.orientation import _foretold, orient
from meshdepict.surface.sidedness import _spread, looks_inward


@pytest.mark.parametrize("height", [0.98, 0.9])  # openings of about 1 % and 5 % of the area
@pytest.mark.parametrize("company", [False, True])
def test_vessels_with_a_small_opening_are_turned_outwards(height, company):
    vessel = opened(icosphere(3000), height)
    others = [moved(sheet(3), (5, 5, 5))] if company else []
    assert not flips(both(vessel, *others)).any()
    mesh = both(inside_out(vessel), *others)
    expected = np.arange(len(mesh[1])) < len(vessel[1])
    np.testing.assert_array_equal(flips(mesh), expected)
    assert orient(*mesh).message.endswith("turned: 1 open part faced inwards")


def test_tubes_are_turned_outwards_if_they_are_long():
    # A ray from within a tube of length L and radius 1 leaves it with probability of about 1/L.
    assert not flips(tube(30)).any()
    assert flips(inside_out(tube(30))).all()
    for mesh in (tube(3), inside_out(tube(3))):
        assert not flips(mesh).any()


@pytest.mark.parametrize(
    "mesh",
    [
        sheet(),
        sheet(30, lambda x, y: 0.1 * np.sin(20 * x) * np.cos(15 * y)),
        sheet(30, lambda x, y: 0.7 * ((x - 0.5) ** 2 + (y - 0.5) ** 2)),  # a valley
        opened(icosphere(1000), 0.0),  # a bowl: half of its inside sees the sky
        (CUBE[0], CUBE[1][2:]),  # a box without a lid
    ],
)
@pytest.mark.parametrize("company", [False, True])
def test_sheets_and_bowls_stay_as_wound(mesh, company):
    others = [moved(sheet(3), (5, 5, 5))] if company else []
    assert not flips(both(mesh, *others)).any()
    assert not flips(both(inside_out(mesh), *others)).any()


def test_open_part_within_a_closed_one_tells_nothing():
    inner = moved(opened(icosphere(1000), 0.9), 0, 0.4)
    for given in (inner, inside_out(inner)):
        # Its front or back sees only the closed wall, and rays from neither side get away.
        assert not flips(both(BALL, given)).any()


def test_panels_of_a_body_that_do_not_touch_look_outwards():
    # The sides of a box, each a part by itself with a narrow gap to the next: rays find the inside.
    panels = [(CUBE[0] + 1e-3 * (CUBE[0][CUBE[1][k]].mean(axis=0) - 0.5), CUBE[1][k : k + 2])
              for k in range(0, 12, 2)]  # fmt: skip
    mesh = both(*panels)
    assert not flips(mesh).any()
    expected = np.zeros(12, bool)
    expected[[2, 3, 8, 9]] = True
    found = orient(mesh[0], turned(mesh[1], expected))
    np.testing.assert_array_equal(found.flipped, expected)
    assert found.message == "winding of 4 faces was turned: 2 open parts faced inwards"


@pytest.mark.parametrize("height", [0.999, 0.99, 0.95, 0.9, 0.8, 0.5, 0.0, -0.5])
def test_foretold_verdicts_are_those_of_the_rays(height):
    points, faces = moved(opened(icosphere(5000), height), 0, 0.5)
    corners = points[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(cross, axis=1) / 2
    volume = np.einsum("ij,ij->", corners[:, 0], cross) / 6
    edges = cleaned(points, faces).edges
    for turn in (False, True):
        which = np.full(len(faces), turn)
        foretold = _foretold(points, edges, which, areas.sum(), -volume if turn else volume)
        asked = looks_inward(points, turned(faces, which), np.zeros(len(faces), int), areas)
        if 0.8 <= height <= 0.95:
            assert foretold is None  # openings between 1 % and 20 % of the area: rays decide
        else:
            assert foretold.tolist() == asked.tolist()


def test_a_volume_smaller_than_the_openings_foretells_nothing():
    points, faces = moved(opened(icosphere(5000), 0.999), 0, 0.5)
    points = points * (1, 1, 1e-3)
    edges = cleaned(points, faces).edges
    assert _foretold(points, edges, np.zeros(len(faces), bool), np.pi / 2, 5e-4) is None


def test_rays_leave_from_all_over_each_patch():
    # Faces of area 1, 2, 3, … in two interleaved patches; those of area 0 or of no patch never.
    areas = np.arange(20.0)
    number = np.arange(20) % 2
    asked = np.arange(2, 20)
    shares = (np.arange(18_000) + 0.5)[None] / 18_000
    chosen = _spread(asked, number[asked], areas[asked], np.repeat(shares, 2, axis=0))
    for patch in (0, 1):
        own = asked[number[asked] == patch]
        count = np.bincount(chosen[patch], minlength=20)
        expected = 18_000 * areas[own] / areas[own].sum()
        np.testing.assert_allclose(count[own], expected, atol=1.01)  # even: to one ray
        assert count.sum() == count[own].sum()


def test_of_very_many_parts_the_largest_are_asked():
    points, faces = icosphere(42)
    vessel = points, faces[1:, ::-1]
    sizes = np.linspace(0.2, 0.4, 1030)
    mesh = both(*(moved(vessel, (k % 32, k // 32, 0), size) for k, size in enumerate(sizes)))
    expected = np.repeat(np.arange(1030) >= 6, len(faces) - 1)
    np.testing.assert_array_equal(flips(mesh), expected)
