"""Pictures: the right size, the object in them whole, and where they come from written inside."""

import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import PATIENCE
from PIL import Image

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.drawing.picture_files import check_picture, read_picture_provenance


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


def test_edges_are_clean_on_every_ground(bar, tmp_path):
    """No fringe: laid on a ground, the transparent picture is the one drawn on that ground."""
    clear = bar.picture(tmp_path / "clear.png", size=(90, 40), background="transparent")
    with Image.open(clear) as image:
        assert image.mode == "RGBA"
        alpha = np.asarray(image)[..., 3]
        assert (alpha[0] == 0).all()
        assert set(np.unique(alpha)) <= {round(255 * hits / 9) for hits in range(10)}
        assert len(np.unique(alpha)) > 5
        for ground in ("white", "paper", "#00ff40"):
            path = bar.picture(tmp_path / "ground.png", size=(90, 40), background=ground)
            expected = pixels(path)
            laid = Image.new("RGBA", image.size, tuple(expected[0, 0]))
            laid.alpha_composite(image)
            got = np.asarray(laid.convert("RGB")).astype(int)
            assert np.abs(got - expected).max() <= 2  # three roundings to a byte
    inside = np.asarray(Image.open(clear))[alpha == 255][:, :3]
    assert inside.max() <= bar.colors.max()


def test_a_size_on_paper_says_its_dots_per_inch(bar, tmp_path):
    path = bar.picture(tmp_path / "bar.png", size="30x10mm", dpi=254)
    with Image.open(path) as image:
        assert image.size == (300, 100)
        assert image.info["dpi"] == pytest.approx((254, 254), abs=0.02)  # whole dots per metre
    with Image.open(bar.picture(tmp_path / "bar.png", size="30x10")) as image:
        assert "dpi" not in image.info


def test_the_same_scale_for_every_object(tmp_path):
    """20 pixels per unit: a ball of radius 1 is 40 across, wherever it is, and one of 2 is 80."""
    for radius, away in ((1, 0), (2, 1000)):
        ball = samples.sphere(2000)
        mesh = md.Mesh(ball.vertices * radius + away, ball.faces)
        for view in ("front", md.View((3, 4, 9), (0, 0, 0), (0, 1, 0), parallel_scale=7.0)):
            baked = md.bake(mesh, "half_lambert", light="north", exposure=0.5, view=view)
            path = baked.picture(tmp_path / "ball.png", pixels_per_unit=20)
            assert drawn(path) == pytest.approx((40 * radius, 40 * radius), abs=2)
            height, width, _ = pixels(path).shape
            assert (width, height) == pytest.approx((42 * radius + 2,) * 2, abs=1)
            path = baked.picture(tmp_path / "ball.png", pixels_per_unit=20, size=(200, 120))
            assert drawn(path) == pytest.approx((40 * radius, 40 * radius), abs=2)
            assert pixels(path).shape == (120, 200, 3)


def test_what_is_too_large_for_its_scale_is_refused(bar, tmp_path):
    with pytest.raises(MeshdepictError, match=r"takes 600x200 pixels, more than the 500x500"):
        bar.picture(tmp_path / "bar.png", pixels_per_unit=100, size=(500, 500))
    with pytest.raises(MeshdepictError, match=r"at 10000 pixels per unit: 1 to 16384"):
        bar.picture(tmp_path / "bar.png", pixels_per_unit=10_000)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("asked", [{"scale_bar": True}, {"pixels_per_unit": 3}])
def test_perspective_has_no_scale(tmp_path, asked):
    ball = samples.sphere(200)
    view = md.View((0, 0, 4), (0, 0, 0), (0, 1, 0), field_of_view=40.0)
    baked = md.bake(ball, "half_lambert", view=view)
    with pytest.raises(MeshdepictError, match="needs a parallel view"):
        baked.picture(tmp_path / "ball.png", **asked)


def test_the_scale_bar_is_as_long_as_it_says_and_below_the_object(bar, tmp_path):
    path = bar.picture(
        tmp_path / "bar.png", size=(400, 300), scale_bar=True, pixels_per_unit=50, unit="mm"
    )
    dark = pixels(path).max(axis=2) < 100
    strip = dark[300 - 33 :]  # three letters of eleven pixels
    row = strip[strip.sum(axis=1).argmax()]
    first = np.flatnonzero(row)[0]
    (ends,) = np.nonzero(~row[first:])
    assert ends[0] == 100  # 2 mm at 50 pixels each; the label comes after a gap
    assert not dark[300 - 34].any()
    assert dark[: 300 - 34].any()


def test_a_scale_bar_fits_any_view_and_leaves_a_view_of_one_s_own_as_it_is(bar, tmp_path):
    view = md.View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=2.0)
    baked = md.bake(bar.shape, "half_lambert", light="north", exposure=0.5, view=view)
    plain = pixels(baked.picture(tmp_path / "a.png", size=(400, 300)))
    barred = pixels(baked.picture(tmp_path / "b.png", size=(400, 300), scale_bar=True))
    np.testing.assert_array_equal(plain[:260], barred[:260])
    assert (plain[260:] != barred[260:]).any()


def test_a_poster_is_drawn_with_fewer_samples_rather_than_not_at_all():
    from meshdepict.drawing.canvas import _samples

    assert [_samples(size) for size in ((1000, 1000), (3500, 2500), (16384, 16384))] == [3, 2, 1]
    assert _samples((9000, 10)) == 1  # its window would be too wide


def test_far_from_the_origin_a_picture_is_the_same(bar, tmp_path):
    shape = md.Mesh(bar.shape.vertices + 5e5, bar.shape.faces)
    far = md.bake(shape, "half_lambert", light="north", exposure=0.5)
    near = pixels(bar.picture(tmp_path / "near.png", size=(120, 60))).astype(int)
    assert np.abs(pixels(far.picture(tmp_path / "far.png", size=(120, 60))) - near).max() <= 2


def test_other_pictures_have_none(tmp_path):
    Image.new("RGB", (4, 4)).save(tmp_path / "other.png")
    (tmp_path / "words.png").write_text("no picture")
    (tmp_path / "cut.png").write_bytes((tmp_path / "other.png").read_bytes()[:40])
    for name in ("other.png", "words.png", "cut.png", "missing.png"):
        assert read_picture_provenance(tmp_path / name) is None


@pytest.mark.parametrize(
    ("name", "size", "sentence"),
    [
        ("bar.tif", (10, 10), "end the name with .png, .jpg, .svg or .pdf"),
        ("bar", (10, 10), "end the name with .png"),
        ("bar.png", (0, 10), "a picture of 0x10 pixels"),
        ("bar.png", (10, 20_000), "a picture of 10x20000 pixels"),
    ],
)
def test_what_can_t_be_a_picture_is_refused(bar, tmp_path, name, size, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        bar.picture(tmp_path / name, size=size)
    assert not list(tmp_path.iterdir())


def test_the_name_of_a_picture_is_checked_before_any_work():
    with pytest.raises(MeshdepictError, match=r"end the name with \.png"):
        check_picture("bar.tif")


@pytest.mark.slow
def test_the_command_line_renders_without_a_display_or_a_word(tmp_path):
    """A real run: nothing on stderr, where VTK would complain about the missing X server."""
    md.io.write_mesh(tmp_path / "ball.ply", samples.golf_ball(400, dimples=12))
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    words = ["bake", "ball.ply", "--picture", "ball.png", "--size", "90x60"]
    for light in ("east", "west"):  # the second replaces the first: the picture is known as ours
        done = subprocess.run(
            [sys.executable, "-m", "meshdepict", *words, "--light", light],
            cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=PATIENCE,
            check=False,
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
