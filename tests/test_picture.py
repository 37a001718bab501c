"""Pictures: the right size, the object in them whole, and where they come from written inside."""

import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.viewer.picture import check_picture, read_picture_provenance


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def drawn(path):
    """(width, height) of what isn't background."""
    there = (pixels(path) < 250).any(axis=2)
    rows, columns = np.flatnonzero(there.any(axis=1)), np.flatnonzero(there.any(axis=0))
    return np.ptp(columns) + 1, np.ptp(rows) + 1


@pytest.fixture(scope="module")
def bar():
    """A long ellipsoid, three times as wide as high, in a dark shade."""
    ball = samples.sphere(2000)
    mesh = md.Mesh(ball.vertices * (3, 1, 1), ball.faces)
    return md.bake(mesh, "half_lambert", light="north", exposure=0.5)


@pytest.mark.parametrize("size", [(120, 120), (240, 80), (60, 120)])
def test_the_object_fills_a_picture_of_any_proportions(bar, tmp_path, size):
    path = bar.picture(tmp_path / "bar.png", size=size)
    image = pixels(path)
    assert image.shape == (size[1], size[0], 3)
    # 5 % remain round it, in the tighter direction.
    fit = min(size[0] / 3, size[1])
    assert drawn(path) == pytest.approx((3 * fit / 1.05, fit / 1.05), abs=2)


def test_a_view_of_one_s_own_stays_as_it_is(bar, tmp_path):
    mesh = bar.shape
    for view in (
        md.View.fitted("front", mesh, aspect=3.0),
        md.View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=1.05),
    ):
        baked = md.bake(mesh, "half_lambert", light="north", exposure=0.5, view=view)
        path = baked.picture(tmp_path / "bar.png", size=(300, 100))
        assert drawn(path) == pytest.approx((300 / 1.05, 100 / 1.05), abs=2)


def test_perspective_shows_less_of_what_is_near(tmp_path):
    ball = samples.sphere(2000)
    view = md.View((0, 0, 2), (0, 0, 0), (0, 1, 0), field_of_view=90.0)
    baked = md.bake(ball, "half_lambert", light="north", exposure=0.5, view=view)
    path = baked.picture(tmp_path / "ball.png", size=(200, 200))
    # The outline's tangent cone has tan = 1/√3 where tan 45° is the picture's edge.
    assert drawn(path) == pytest.approx((200 / 3**0.5,) * 2, abs=2)


def test_the_colors_are_the_baked_ones(tmp_path):
    sheet = md.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [[0, 1, 2, 3]])
    baked = md.bake(sheet, "half_lambert", light=(1, 0, 0), colormap="sepia")
    image = pixels(baked.picture(tmp_path / "sheet.png", size=(50, 50)))
    assert (image[25, 25] == baked.colors[0]).all()
    assert (image[0, 0] == 255).all()


def test_the_provenance_is_written_inside(bar, tmp_path):
    path = bar.picture(tmp_path / "bar.png", size=(20, 20))
    assert read_picture_provenance(path) == bar.comments


def test_other_pictures_have_none(tmp_path):
    Image.new("RGB", (4, 4)).save(tmp_path / "other.png")
    (tmp_path / "words.png").write_text("no picture")
    (tmp_path / "cut.png").write_bytes((tmp_path / "other.png").read_bytes()[:40])
    for name in ("other.png", "words.png", "cut.png", "missing.png"):
        assert read_picture_provenance(tmp_path / name) is None


@pytest.mark.parametrize(
    ("name", "size", "sentence"),
    [
        ("bar.jpg", (10, 10), "end the name with .png"),
        ("bar", (10, 10), "end the name with .png"),
        ("bar.png", (0, 10), "a picture of 0x10 pixels"),
        ("bar.png", (10, 20_000), "a picture of 10x20000 pixels"),
    ],
)
def test_what_can_t_be_a_picture_is_refused(bar, tmp_path, name, size, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        bar.picture(tmp_path / name, size=size)
    with pytest.raises(MeshdepictError, match=sentence):
        check_picture(tmp_path / name, size)
    assert not list(tmp_path.iterdir())


def test_the_command_line_renders_without_a_display_or_a_word(tmp_path):
    """A real run: nothing on stderr, where VTK would complain about the missing X server."""
    md.io.write_mesh(tmp_path / "ball.ply", samples.golf_ball(400, dimples=12))
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    words = ["bake", "ball.ply", "--picture", "ball.png", "--size", "90x60"]
    for light in ("east", "west"):  # the second replaces the first: the picture is known as ours
        done = subprocess.run(
            [sys.executable, "-m", "meshdepict", *words, "--light", light],
            cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
        (line,) = done.stdout.splitlines()
        assert ", picture ball.png, " in line
        assert "\x1b" not in line
    image = pixels(tmp_path / "ball.png")
    assert image.shape == (60, 90, 3)
    assert len(np.unique(image)) > 20  # shades
    assert any(
        text.startswith("meshdepict light: west")
        for text in read_picture_provenance(tmp_path / "ball.png")
    )


def test_the_pictures_of_others_are_not_replaced_unless_forced(tmp_path, monkeypatch, capsys):
    from meshdepict.cli import main

    monkeypatch.chdir(tmp_path)
    md.io.write_mesh("ball.ply", samples.sphere(42))
    Image.new("RGB", (4, 4)).save("ball.png")
    before = (tmp_path / "ball.png").read_bytes()
    words = ["bake", "ball.ply", "-m", "lambert", "--picture", "ball.png", "--size", "20x20"]
    assert main(words) == 2
    assert "ball.png exists and was not written by meshdepict" in capsys.readouterr().err
    assert (tmp_path / "ball.png").read_bytes() == before
    assert main([*words, "--force"]) == 0
    assert main(words) == 0
    assert read_picture_provenance("ball.png")


def test_several_pictures_go_into_a_folder(tmp_path, monkeypatch, capsys):
    from meshdepict.cli import main

    monkeypatch.chdir(tmp_path)
    (tmp_path / "pictures").mkdir()
    for name in ("a.ply", "b.ply"):
        md.io.write_mesh(name, samples.sphere(42))
    words = ["bake", "a.ply", "b.ply", "-m", "lambert", "--picture", "pictures", "--size", "20x20"]
    assert main(words) == 0
    names = {path.name for path in (tmp_path / "pictures").iterdir()}
    assert names == {"a-lambert.png", "b-lambert.png"}
    capsys.readouterr()
