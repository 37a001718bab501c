"""One look for everything that takes or writes one: frozen, with one list of names and defaults."""

import inspect

import numpy as np
import pytest
from method_families import ON_MESHES

import meshdepict as md
from meshdepict.baking.choice_list import choice_fields
from meshdepict.baking.choices import Choices
from meshdepict.errors import MeshdepictError
from meshdepict.scales.making import scale_space
from meshdepict.shading import METHODS, declaration
from meshdepict.viewer.session import Session


@pytest.fixture(scope="module")
def small():
    return md.samples.golf_ball(400, dimples=12)


def test_a_look_is_frozen():
    look = md.Look("lambert", light="west")
    with pytest.raises(AttributeError):
        look.light = "east"


@pytest.mark.parametrize("name", ON_MESHES)
def test_a_look_bakes_what_bake_does(small, name):
    look = md.Look(name, light="west", view="top")
    if "rays" in declaration(METHODS[name]).needs:
        look = look.replace(rays=16)
    baked = look.bake(small)
    again = md.bake(small, name, **look.words())
    np.testing.assert_array_equal(baked.colors, again.colors)
    assert baked.provenance == again.provenance


def test_a_volume_is_baked_by_the_same_look():
    phantom = md.samples.ct_phantom((16, 18, 14))
    look = md.Look("lambert", light="west", transfer="skin")
    np.testing.assert_array_equal(
        look.bake(phantom).rgba, md.bake_volume(phantom, "lambert", **look.words()).rgba
    )


def test_what_a_bake_looks_like_makes_it_again(small):
    baked = md.bake(small, "exaggerated", light=(300, 20), scales=3, exaggeration=22)
    assert baked.look.up == "y"
    assert baked.look.scales == 3
    np.testing.assert_array_equal(baked.look.bake(small).colors, baked.colors)


def test_a_look_is_saved_and_loaded(small, tmp_path):
    look = md.Look("light_alignment", light=(300, 20), up="z", scales=3, strength=0.3)
    again = md.Look.load(look.save(tmp_path / "look.toml"))
    np.testing.assert_array_equal(look.bake(small).colors, again.bake(small).colors)
    assert again.words()["strength"] == 0.3


def test_a_recipe_of_a_volume_holds_what_is_shown(tmp_path):
    phantom = md.samples.ct_phantom((16, 18, 14))
    baked = md.bake_volume(phantom, "lambert", transfer="skin")
    look = md.Look("lambert", transfer="skin")
    again = md.Look.load(look.save(tmp_path / "look.toml"))
    assert again.transfer == "skin"
    np.testing.assert_array_equal(again.bake(phantom).rgba, baked.rgba)


def test_another_method_leaves_its_options_behind():
    look = md.Look("exaggerated", light="west", exaggeration=30)
    other = look.replace(method="toon")
    assert (other.method, other.light, dict(other.options)) == ("toon", "west", {})
    assert look.replace(light="east").options == {"exaggeration": 30}


def test_words_are_what_differs():
    assert md.Look("lambert").words() == {}
    look = md.Look("exaggerated", up="z", exaggeration=30)
    assert look.words() == {"up": "z", "exaggeration": 30.0}
    assert repr(look) == "Look('exaggerated', up='z', exaggeration=30.0)"


def test_what_equals_a_default_is_one_however_it_was_made():
    usual = {name: each.default for name, each in choice_fields().items() if name != "method"}
    fresh = {
        name: "".join(list(value)) if isinstance(value, str) else np.float64(value)
        for name, value in usual.items()
        if isinstance(value, str) or type(value) in (int, float)
    }
    assert {"view", "albedo", "tolerance", "facing"} <= set(fresh)
    assert all(value is not usual[name] for name, value in fresh.items())
    assert md.Look("lambert", **fresh).words() == {}


def test_a_light_in_numbers_is_told_from_the_default_without_comparing_its_elements():
    for light in ((0, 0, 1), np.array([0.0, 0.0, 1.0]), [(0, 0, 1), "front"]):
        words = md.Look("phong", light=light).words()
        assert set(words) == {"light"}
        assert words["light"] is light


@pytest.mark.parametrize("function", [md.bake, md.bake_volume])
def test_signatures_name_every_choice_with_its_default(function):
    known = inspect.signature(function).parameters
    for name, each in choice_fields().items():
        assert known[name].default == each.default


def test_scale_spaces_are_made_with_the_same_defaults():
    known = inspect.signature(scale_space).parameters
    for name in ("facing", "tolerance"):
        assert known[name].default == choice_fields()[name].default


def test_the_axis_that_points_up_follows_from_the_kind():
    look = Choices("lambert")
    assert [look.axis(kind) for kind in ("mesh", "image", "volume")] == ["y", "y", "z"]
    assert Choices("lambert", up="-z").axis("mesh") == "-z"


@pytest.mark.parametrize(
    ("kind", "chosen"),
    [("mesh", {"transfer": "bone"}), ("image", {"transfer": "bone"}),
     ("volume", {"colormap": "stone"}), ("volume", {"facing": 0}), ("volume", {"refine": 2}),
     ("volume", {"albedo": "keep"}), ("volume", {"colormap2d": "dusk"})],
)  # fmt: skip
def test_a_choice_about_another_kind_is_refused(kind, chosen):
    (name,) = chosen
    with pytest.raises(MeshdepictError, match=f"^{name} is about a .*leave it out"):
        Choices("lambert", **chosen).of_kind(kind)


@pytest.mark.parametrize(
    ("chosen", "sentence"),
    [({"lihgt": "west"}, "no option 'lihgt'"), ({"colormap": "stne"}, "stone"),
     ({"albedo": "lost"}, "albedo='lost' is neither"),
     ({"colormap": "stone", "colormap2d": "dusk"}, "exclude each other")],
)  # fmt: skip
def test_a_wrong_look_is_refused_when_it_is_made(chosen, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        md.Look("lambert", **chosen)


@pytest.mark.parametrize("chosen", [{"albedo": "keep"}, {"refine": 2}, {"colormap2d": "dusk"}])
def test_a_session_refuses_what_it_can_t_show(small, chosen):
    (name,) = chosen
    with pytest.raises(MeshdepictError, match=f"have no {name}"):
        Session(small, "lambert", **chosen)
