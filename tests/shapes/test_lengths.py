"""Widths with units of length and in cells: what they are, of what, and who has none."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import HeightField, Look, MeshdepictError
from meshdepict.baking.plan import plan
from meshdepict.baking.relief import Relief
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.lengths import resolve_width
from meshdepict.shapes.mesh import Mesh
from meshdepict.voxels.length_unit import MILLIMETRES

OBLONGS = (2.5, 0, 0, 0, -4, 0)


@pytest.fixture(scope="module")
def ground():
    row, column = np.mgrid[:40, :30]
    return HeightField(3 * np.sin(row / 3.0) + 2 * np.cos(column / 4.0), transform=OBLONGS)


def in_unit(unit):
    ball = md.samples.golf_ball(400, dimples=12)
    return Mesh(100 * ball.vertices, ball.faces, length_unit=unit)


@pytest.mark.parametrize(
    ("width", "metres"),
    [
        ("5m", 5), (" 5 m ", 5), ("5 metres", 5), ("5", 5), ("0.005km", 5), ("500cm", 5),
        ("5e0m", 5), (".5e1 m", 5), ("10ft", 3.048), ("3cells", 7.5), ("1 cell", 2.5),
        ("0.5cells", 1.25), ("1%", None),
    ],
)  # fmt: skip
def test_terrain_has_metres_and_cells(ground, width, metres):
    expected = ground.diagonal / 100 if metres is None else metres
    assert resolve_width(width, ground) == pytest.approx(expected, rel=1e-15)
    assert md.scale_space(ground, width=width).widths[1] == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("own", MILLIMETRES)
def test_a_unit_is_so_many_of_the_shapes_own(own):
    """Said in either unit, it is the same length in millimetres."""
    ball = in_unit(own)
    for said, millimetres in MILLIMETRES.items():
        found = resolve_width(f"3{said}", ball, averages=False)
        assert found * MILLIMETRES[own] == pytest.approx(3 * millimetres, rel=1e-12)


def test_volumes_and_pictures_know_theirs_too():
    head = md.samples.ct_phantom((24, 24, 24))
    assert resolve_width("2cm", head) == pytest.approx(20)
    view = md.View.fitted("front", in_unit("cm"))
    picture = GBuffer.of(in_unit("cm"), view, size=(40, 40))
    assert resolve_width("50mm", picture) == pytest.approx(5)
    depths = GBuffer(view, picture.mask, picture.normals, picture.depths)
    with pytest.raises(MeshdepictError, match="nothing says what the lengths of this image are"):
        resolve_width("50mm", depths)


def test_a_length_stands_beside_pixels_as_any_other_does(ground):
    eye = md.View.fitted("front", ground, height_px=100)
    pixel = resolve_width("1px", ground, eye)
    assert resolve_width("2m,3px", ground, eye) == pytest.approx(max(2, 3 * pixel))
    assert resolve_width("1px,9cells", ground, eye) == pytest.approx(max(22.5, pixel))


@pytest.mark.parametrize("width", ["5 parsecs", "m", "cells", "-5m", "0cells", "5m,3cells", "5mm2"])
def test_of_terrain_what_is_no_length_is_told_what_is_one(ground, width):
    with pytest.raises(
        MeshdepictError,
        match=rf"width='{width}' is not a positive length, such as 5 or '5m' \(metres\), '3cells'",
    ):
        resolve_width(width, ground)


def test_units_want_an_object_that_knows_its_own(ball):
    with pytest.raises(MeshdepictError, match=r"'5mm' has a unit \(mm\).*lengths of this mesh are"):
        resolve_width("5mm", ball)
    with pytest.raises(MeshdepictError, match="'3cells' counts cells, and this mesh has none"):
        md.bake(ball, width="3cells")


@pytest.mark.usefixtures("folder")
def test_every_door_takes_them(ground):
    """Bakes, looks, recipes, windows of terrain and what a bake will cost: the same widths."""
    expected = [0, *(7.5 * 2 ** (k / 2) for k in range(4))]
    look = Look("exaggerated", scales=4, width="3cells")
    look.save("look.toml")
    for found in (
        md.bake(ground, scales=4, width="7.5m").space.widths,
        look.bake(ground).space.widths,
        Look.load("look.toml").bake(ground).space.widths,
        Relief(ground, look).widths,
        plan(ground, look).widths,
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_window_counts_the_whole_rasters_cells():
    """In degrees cells are narrower in the north: those in the middle of all count."""
    place = (0.001, 0, 10, 0, -0.001, 60)
    row, column = np.mgrid[:64, :48]
    north = HeightField(np.sin(row / 5.0) * column, transform=place, degrees=True)
    look = Look("exaggerated", width="3cells")
    relief = Relief(north, look)
    assert relief.widths[1] == pytest.approx(3 * north.edge_length, rel=1e-15)
    top = north.window(slice(0, 20), slice(None))
    assert top.edge_length < north.edge_length


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("relief hills.asc --width wide", "width='wide' is not a positive length, such as 5 or"),
        ("relief hills.asc --width 5s", "width='5s' is not a positive length, such as 5 or"),
        ("bake ball.ply --width 3cells", "width='3cells' counts cells"),
        ("bake ball.ply --width 3mm", "width='3mm' has a unit (mm)"),
    ],
)
@pytest.mark.usefixtures("ball_ply")
def test_a_wrong_one_is_one_sentence(run, folder, command, message):
    from height_files import asc, hills

    (folder / "hills.asc").write_bytes(asc(hills()))
    status, out, err = run(*command.split())
    assert (status, out) == (2, [])
    assert message in err[-1]
    assert not list(folder.glob("*-exaggerated*"))


@pytest.mark.parametrize("width", ["30m", "3cells", "0.03km", "30"])
def test_the_relief_command_says_them_in_metres(run, folder, width):
    from height_files import asc, hills

    (folder / "hills.asc").write_bytes(asc(hills()))
    status, out, _ = run("relief", "hills.asc", "-o", "hills.png", "--scales", 3, "--width", width)
    assert status == 0
    assert "3 scales, widths 30 to 60 m" in out[-1]
