"""Recipes from strangers: what they name lies beside them, and whatever they hold is a sentence."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import samples
from meshdepict.baking.recipe import load_recipe, save_recipe
from meshdepict.color.transfer import preset
from meshdepict.errors import MeshdepictError
from meshdepict.scene.environment import Environment

ROW = bytes((2, 2, 0, 16)) + b"".join(bytes([16] + 16 * [v]) for v in (64, 64, 64, 127))
HDR = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + 8 * ROW


@pytest.fixture
def looks(folder: Path) -> Path:
    """A folder with a panorama, a sphere and a transfer function in it and below."""
    home = Path("looks")
    (home / "files").mkdir(parents=True)
    (home / "files" / "sky.hdr").write_bytes(HDR)
    Image.fromarray(np.full((8, 8, 3), 200, np.uint8)).save(home / "ball.png")
    preset("bone").to_toml(home / "mine.toml")
    (folder / "secret.hdr").write_bytes(HDR)
    return home


def wrote(looks: Path, text: str) -> Path:
    (looks / "look.toml").write_text(text)
    return looks / "look.toml"


def test_files_beside_a_recipe_are_found_from_any_folder(looks):
    path = wrote(looks, 'light = "files/sky.hdr"\nmethod = "light_warping"')
    assert load_recipe(path)["light"] == str(looks / "files" / "sky.hdr")
    assert md.bake(samples.sphere(60), **load_recipe(path)).provenance["light"].startswith("sky")
    path = wrote(looks, 'method = "lit_sphere"\n[options]\nsphere = "ball.png"')
    colors = md.bake(samples.sphere(60), **load_recipe(path)).colors
    assert (colors == 200).all()
    path = wrote(looks, 'transfer = "mine.toml"')
    assert load_recipe(path)["transfer"] == str(looks / "mine.toml")
    path = wrote(looks, 'method = "lit_sphere"\n[options]\nsphere = "metal"')
    assert load_recipe(path)["sphere"] == "metal"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('light = "../secret.hdr"', "names the panorama '../secret.hdr', which leads out"),
        ('light = "/etc/sky.HDR"', "names the panorama '/etc/sky.HDR', an absolute path"),
        ('light = "https://host/sky.hdr"', "a URL"),
        ('transfer = "../x.toml"', "names the transfer function '../x.toml', which leads out"),
        (
            'method = "lit_sphere"\n[options]\nsphere = "/etc/passwd"',
            "names the sphere '/etc/passwd', an absolute path",
        ),
    ],
)
def test_files_elsewhere_are_not_read(looks, text, words):
    with pytest.raises(MeshdepictError, match=words) as caught:
        load_recipe(wrote(looks, text))
    assert str(caught.value).startswith(str(looks / "look.toml"))


def test_what_a_person_says_is_free(run, looks, ball_ply):
    look = wrote(looks, 'light = "files/sky.hdr"\nmethod = "light_warping"\nscales = 1')
    words = ["bake", "ball.ply", "--recipe", look, "--light", Path("secret.hdr").absolute()]
    status, out, err = run(*words, "-o", "a.ply")
    assert (status, err) == (0, [])
    assert "secret" in out[0]


def test_saved_names_are_from_the_recipes_own_folder(looks):
    look = {"method": "light_warping", "light": "looks/files/sky.hdr"}
    save_recipe(looks / "saved.toml", look)
    assert 'light = "files/sky.hdr"' in (looks / "saved.toml").read_text()
    assert load_recipe(looks / "saved.toml")["light"] == str(looks / "files" / "sky.hdr")
    save_recipe(looks / "saved.toml", {"method": "lit_sphere", "sphere": looks / "ball.png"})
    assert load_recipe(looks / "saved.toml")["sphere"] == str(looks / "ball.png")


def test_a_recipe_that_could_not_be_read_again_is_not_saved(looks):
    with pytest.raises(MeshdepictError, match=r"the panorama secret\.hdr is elsewhere: copy it"):
        save_recipe(looks / "saved.toml", {"method": "light_warping", "light": "secret.hdr"})
    assert not (looks / "saved.toml").exists()


@pytest.mark.skipif(os.name != "posix", reason="needs a named pipe")
def test_a_pipe_is_no_recipe(looks):
    os.mkfifo(looks / "pipe.toml")
    with pytest.raises(MeshdepictError, match="is a named pipe, not a file"):
        load_recipe(looks / "pipe.toml")
    with pytest.raises(MeshdepictError, match="exists and is no recipe"):
        save_recipe(looks / "pipe.toml", {})


def test_the_hostile_cases_are_one_sentence_each(data, run, ball_ply):
    hostile = data / "cases" / "hostile"
    for name, sentence in (
        ("deep.toml", "nests too deep"),
        ("recipe-type.toml", "ratio='x' is not a number above 1"),
    ):
        status, out, err = run("bake", "ball.ply", "--recipe", hostile / name)
        assert (status, out, len(err)) == (2, [], 1)
        assert sentence in err[0]


@pytest.mark.parametrize(
    "text",
    [
        f"{name} = {value}"
        for name in (
            "method", "light", "view", "up", "scales", "width", "ratio", "facing", "tolerance",
            "colormap", "colormap2d", "albedo", "refine", "transfer", "two_sided", "options",
        )
        for value in (
            "true", "-1", "nan", "1e400", "'x'", "''", "[]", "[[]]", "{}", "{ a = 1 }",
            "1979-05-27", "[1, 'x']", "9" * 400, "9" * 5000,
        )
    ],
    ids=lambda text: text[:30],
)  # fmt: skip
def test_values_of_any_type_are_a_bake_or_one_sentence(folder, text):
    Path("look.toml").write_text(text)
    ball = samples.sphere(42)
    try:
        done = md.bake(ball, **{"scales": 1, **load_recipe("look.toml")})
    except MeshdepictError as error:
        said = str(error)
        done = None
    assert (done is not None and len(done.colors) == 42) or len(said.splitlines()) == 1


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", "1e400"])
def test_numbers_that_are_none(folder, number):
    Path("look.toml").write_text(f"ratio = {number}")
    with pytest.raises(MeshdepictError, match=rf"no recipe in TOML: {number} is not a finite"):
        load_recipe("look.toml")


def test_numbers_of_thousands_of_digits(folder):
    Path("look.toml").write_text("ratio = " + "9" * 5000)
    with pytest.raises(MeshdepictError, match=r"look\.toml is no recipe in TOML"):
        load_recipe("look.toml")


def test_recipes_of_version_0_1_keep_their_pictures_under_a_panorama(looks):
    """What they lack is what there was: 54 lights by median cut, highlights and all."""
    path = looks / "look.toml"
    settings = {"method": "cook_torrance", "light": str(looks / "files" / "sky.hdr")}
    ball = samples.golf_ball(1_200, dimples=42, depth=0.05)
    save_recipe(path, settings)
    assert load_recipe(path)["sampling"] == "lobes"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('sampling = "lobes"\n', ""), encoding="utf-8")
    older = load_recipe(path)
    assert older["sampling"] == "lights"
    sky = Environment.from_file(settings["light"], sampling="lights")
    found = md.bake(ball, **older)
    expected = md.bake(ball, "cook_torrance", light=sky.lights(54))
    np.testing.assert_array_equal(found.colors, expected.colors)
    assert (found.colors != md.bake(ball, **settings).colors).any()
    save_recipe(path, older, force=True)  # written again it says so
    assert load_recipe(path)["sampling"] == "lights"
    (looks / "other.toml").write_text('light = "north"')
    assert "sampling" not in load_recipe(looks / "other.toml")


def test_an_unknown_sampling_is_refused():
    with pytest.raises(MeshdepictError, match="sampling='cut' is neither 'lobes' nor 'lights'"):
        md.Look("phong", sampling="cut")
