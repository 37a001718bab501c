"""Recipes: the same file gives the same bytes."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.recipe import load_recipe, merge_recipe, save_recipe
from meshdepict.errors import MeshdepictError


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"method": "lambert", "light": (300.0, 20.0), "view": "top", "up": "z"},
        {"method": "exaggerated", "exaggeration": 22.5, "focus": (0.1, 1e-9, 3.0), "scales": 4},
        {"method": "light_alignment", "strength": (0.9, 0.6, 0.4), "scales": 3, "width": "0.5%"},
        {"colormap2d": "dusk", "tolerance": 1e-3, "width": 0.25, "facing": 0},
    ],
)
def test_what_was_saved_bakes_the_same_bytes(ball, folder, settings):
    save_recipe("look.toml", settings)
    recipe = load_recipe("look.toml")
    assert settings.items() <= recipe.items()
    one, other = md.bake(ball, **settings), md.bake(ball, **recipe)
    assert one.provenance == other.provenance
    one.save("one.ply")
    other.save("other.ply")
    assert Path("one.ply").read_bytes() == Path("other.ply").read_bytes()
    save_recipe("again.toml", recipe)
    assert Path("again.toml").read_bytes() == Path("look.toml").read_bytes()


def test_a_recipe_holds_todays_defaults(folder):
    save_recipe("look.toml", {"method": "exaggerated"})
    held = tomllib.loads(Path("look.toml").read_text(encoding="utf-8"))
    assert held["scales"] == 9
    assert held["ratio"] == 2**0.5
    assert held["light"] == "northwest"
    assert held["options"]["emphasis"] == -0.5
    assert "exaggeration" not in held["options"]  # follows the shape
    assert "width" not in held
    assert "focus" not in held["options"]


def test_lights_become_numbers(folder):
    light = md.Light((1, 2, 3), "lamp")
    save_recipe("look.toml", {"light": light})
    assert load_recipe("look.toml")["light"] == tuple(light.direction)
    save_recipe("look.toml", {"light": np.array([0.0, 0.0, 1.0])})
    assert load_recipe("look.toml")["light"] == (0.0, 0.0, 1.0)
    disc = md.Light((1, 2, 3), "lamp", spread=12.5)
    save_recipe("look.toml", {"light": disc})
    again = md.scene.as_light(load_recipe("look.toml")["light"])
    assert (tuple(again.direction), again.spread) == (tuple(disc.direction), 12.5)


def test_texts_of_any_letters_are_kept(folder):
    width = '5 "\\ \n\t\x7f é 𝄞'
    save_recipe("look.toml", {"width": width})
    assert load_recipe("look.toml")["width"] == width


def test_what_is_given_comes_before_the_recipe():
    recipe = {"method": "exaggerated", "light": "south", "exaggeration": 3.0}
    assert merge_recipe(recipe, {"light": "north"}) == {**recipe, "light": "north"}
    # The options of one method mean nothing to another.
    assert merge_recipe(recipe, {"method": "lambert"}) == {"method": "lambert", "light": "south"}


def test_on_the_command_line(run, ball_ply):
    look = ["--light", "300,20", "--set", "exaggeration=22", "--scales", 3]
    assert run("bake", "ball.ply", "-o", "a.ply", "--save-recipe", "look.toml", *look)[0] == 0
    assert run("bake", "ball.ply", "-o", "b.ply", "--recipe", "look.toml")[0] == 0
    assert Path("a.ply").read_bytes() == Path("b.ply").read_bytes()
    # An explicit word counts, even where it says what would be the default.
    more = ["--light", "northwest", "--set", "emphasis=0"]
    assert run("bake", "ball.ply", "-o", "c.ply", "--recipe", "look.toml", *more)[0] == 0
    text = "\n".join(md.io.read_provenance("c.ply"))
    for part in ("light: northwest", "exaggeration=22", "emphasis=0", "scales: 3"):
        assert part in text
    assert run("bake", "ball.ply", "--recipe", "look.toml", "-m", "lambert")[0] == 0
    assert "light: azimuth 300" in "\n".join(md.io.read_provenance("ball-lambert.ply"))


def test_a_recipe_without_inputs_is_baked_on_the_golf_ball(run, folder):
    save_recipe("look.toml", {"method": "half_lambert"})
    assert run("bake", "--recipe", "look.toml", "--quiet")[0] == 0
    assert Path("golf-ball-half_lambert.ply").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("method = ", "look.toml is no recipe in TOML"),
        ("lights = 'north'", "recipes have no 'lights'; did you mean 'light'?"),
        ("options = 3", r"options must be a table, \[options\]"),
        ("method = 'lambertian'", "no method is called 'lambertian'; did you mean 'lambert'?"),
        ("[options]\nexageration = 3", "exaggerated has no option 'exageration'"),
        ("[options]\nexaggeration = 'steep'", "exaggeration='steep' is not a number"),
    ],
)
def test_wrong_files_are_refused_in_one_sentence(folder, text, message):
    Path("look.toml").write_text(text)
    with pytest.raises(MeshdepictError, match=message):
        load_recipe("look.toml")


def test_files_that_cannot_be_read(folder):
    with pytest.raises(MeshdepictError, match=r"none.toml can't be read: No such file"):
        load_recipe("none.toml")
    Path("look.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(MeshdepictError, match="is no recipe: it is no text"):
        load_recipe("look.toml")


def test_other_files_are_not_replaced(run, ball_ply):
    Path("look.toml").write_text("mine = 1")
    words = ["bake", "ball.ply", "--save-recipe", "look.toml"]
    status, _, err = run(*words)
    assert status == 2
    assert "look.toml exists and is no recipe" in err[0]
    assert Path("look.toml").read_text() == "mine = 1"
    assert run(*words, "--force")[0] == 0
    assert run(*words)[0] == 0  # a recipe may be


def test_what_no_file_can_hold_is_refused(folder):
    from meshdepict.scene.material import Phong

    material = Phong(shininess=5)
    with pytest.raises(MeshdepictError, match="a recipe can't hold material="):
        save_recipe("look.toml", {"method": "radiance_scaling", "material": material})
    assert not Path("look.toml").exists()


@pytest.mark.parametrize("projection", [{"field_of_view": 40}, {"parallel_scale": 2.5}])
def test_a_view_of_ones_own_comes_back(folder, projection):
    view = md.View((0, 1, 5), (0, 0.5, 0), (0, 1, 0), height_px=700, **projection)
    save_recipe("look.toml", {"view": view})
    found = load_recipe("look.toml")["view"]
    for name in ("position", "focus", "up", "height_px", "field_of_view", "parallel_scale"):
        np.testing.assert_array_equal(getattr(found, name), getattr(view, name))


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ("focus = [0, 0, 0], positon = [0, 0, 5]", "a view has no 'positon'; did you mean"),
        ("focus = [0, 0, 0], up = [0, 1, 0]", "missing 1 required positional argument"),
        ("position = [0, 0, 0], focus = [0, 0, 0], up = [0, 1, 0]", "are the same point"),
    ],
)
def test_a_view_that_is_none_gets_a_sentence(folder, fields, sentence):
    (folder / "look.toml").write_text(f"view = {{ {fields} }}")
    with pytest.raises(MeshdepictError, match=f"look.toml: .*{sentence}"):
        load_recipe("look.toml")
