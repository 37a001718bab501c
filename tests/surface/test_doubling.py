"""Faces with both windings: one side is shaded, and walls between bodies stay inside."""

import numpy as np
import pytest
from windings import BALL, CUBE, both, inside_out, moved, opened, sheet

from meshdepict import Mesh, MeshdepictWarning, bake
from meshdepict.surface.doubling import other_sides
from meshdepict.surface.triangles import enclosed_volume

TWICE = "faces are there twice, with both windings: one side of them is shaded"


def doubled(mesh, *, apart=False):
    """Add every face once more with the other winding, on vertices of its own or not."""
    points, faces = mesh
    if apart:
        return both(mesh, inside_out(mesh))
    return points, np.concatenate((faces, faces[:, ::-1]))


def test_copies_of_one_winding_and_single_faces_have_no_other_side():
    points, faces = BALL
    assert other_sides(points, faces) is None
    assert other_sides(points, np.concatenate((faces, faces, np.roll(faces, 1, axis=1)))) is None
    flat = np.array([[0, 0, 1], [0, 1, 0]])  # without a side
    assert other_sides(points, flat) is None


@pytest.mark.parametrize("apart", [False, True])
def test_the_later_of_two_sides_is_found_whatever_its_first_corner(rng, apart):
    points, faces = doubled(BALL, apart=apart)
    half = len(faces) // 2
    faces[half:] = np.roll(faces[half:], 1, axis=1)
    np.testing.assert_array_equal(other_sides(points, faces), np.arange(2 * half) >= half)
    part = faces[: half + 30]  # some faces only
    np.testing.assert_array_equal(other_sides(points, part), np.arange(half + 30) >= half)


def test_a_wall_between_two_bodies_is_no_doubled_surface():
    """Two boxes on top of each other: what is seen of them must not lean on what touches."""
    for two in (both(CUBE, moved(CUBE, (0, 0, 1))), both(CUBE, moved(CUBE, (1, 0, 0)))):
        points, faces = two
        assert np.ptp(points, axis=0).max() == pytest.approx(2 * np.ptp(CUBE[0], axis=0).max())
        assert other_sides(points, faces) is None
        unique, label = np.unique(points, axis=0, return_inverse=True)
        assert other_sides(unique, label.reshape(-1)[faces]) is None  # with shared corners


def test_a_doubled_fin_on_a_body_is_one():
    """It ends at edges of the body, but not all round."""
    a, b = BALL[1][0, :2]
    points = np.concatenate((BALL[0], [2 * BALL[0][a]]))
    fin = [[a, b, len(points) - 1], [b, a, len(points) - 1]]
    found = other_sides(points, np.concatenate((BALL[1], fin)))
    assert np.flatnonzero(found).tolist() == [len(BALL[1]) + 1]


SURFACES = {
    "closed": BALL,
    "inside out": inside_out(BALL),
    "open": opened(BALL, 0.5),
    "sheet": sheet(12, lambda x, y: 0.1 * np.sin(5 * x + y)),
}


@pytest.mark.parametrize(
    ("name", "apart"),
    [*((name, False) for name in SURFACES), ("closed", True), ("inside out", True)],
)
@pytest.mark.filterwarnings("ignore:winding of")
def test_a_doubled_surface_is_shaded_like_a_single_one(name, apart):
    points, faces = SURFACES[name]
    single = Mesh(points, faces)
    twice = Mesh(*doubled((points, faces), apart=apart))
    with pytest.warns(MeshdepictWarning, match=f"{len(faces):,} {TWICE}"):
        found = twice.normals
    for part in np.split(found, 2 if apart else 1):
        np.testing.assert_allclose(part, single.normals, atol=1e-12)
    for method in ("lambert", "exaggerated", "radiance_scaling", "light_alignment"):
        colors = bake(twice, method).colors[: len(points)].astype(int)
        # A level: sums of twice as many terms are rounded otherwise.
        assert np.abs(colors - bake(single, method).colors).max() <= 1


def test_the_sides_of_an_open_sheet_with_vertices_of_their_own_are_both_shaded():
    for mesh in (SURFACES["sheet"], opened(BALL, 0.1)):
        assert other_sides(*doubled(mesh, apart=True)) is None
    points, faces = opened(BALL, 0.95)  # as good as closed: the inside is hardly seen
    assert other_sides(*doubled((points, faces), apart=True)).sum() == len(faces)


def test_the_file_keeps_both_windings_also_when_they_are_mended():
    points, faces = doubled(inside_out(BALL))
    mesh = Mesh(points, faces)
    with pytest.warns(MeshdepictWarning, match=f"was inside out; {len(BALL[1]):,} {TWICE}"):
        mended = mesh.rewound()
    np.testing.assert_array_equal(mesh.faces, faces)
    half = len(BALL[1])
    np.testing.assert_array_equal(np.sort(mended.faces[:half]), np.sort(faces[:half]))
    assert enclosed_volume(points, mended.faces[:half]) > 4
    assert enclosed_volume(points, mended.faces[half:]) < -4


def test_a_real_scan_with_doubled_faces_is_shaded_like_the_scan(bunny):
    twice = Mesh(bunny.vertices, np.concatenate((bunny.faces, bunny.faces[:, ::-1])))
    with pytest.warns(MeshdepictWarning, match=TWICE):
        colors = bake(twice, "exaggerated").colors.astype(int)
    assert np.abs(colors - bake(bunny, "exaggerated").colors).max() <= 1
