"""Layers in words: what stands for a blend, and what is refused."""

import re

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.combinations import COMBINATIONS
from meshdepict.baking.layer_list import Layer, as_layers, blend_name, blend_text, kept_blend
from meshdepict.errors import MeshdepictError
from meshdepict.shading import METHODS


def facts(layers):
    return [(e.function.__name__, e.mode, e.opacity, e.stretch, dict(e.options)) for e in layers]


def test_the_first_layer_is_on_top_and_parts_have_defaults():
    found = as_layers("sky_view:multiply:0.5, exaggerated:overlay ,toon:screen:25%:0.7..1,lambert")
    assert facts(found) == [
        ("sky_view", "multiply", 0.5, None, {}),
        ("exaggerated", "overlay", 1.0, None, {}),
        ("toon", "screen", 0.25, (0.7, 1.0), {}),
        ("lambert", "normal", 1.0, None, {}),
    ]
    assert facts(as_layers("phong")) == [("phong", "normal", 1.0, None, {})]


def test_many_things_stand_for_a_layer():
    look = md.Look("phong", shininess=7, light=(10, 20), colormap="sepia")
    found = as_layers(
        [
            "toon:multiply:0.5:1..0",
            ("toon", "multiply", 0.5, {"bins": 4}),
            ["lambert"],
            METHODS["lambert"],
            {"method": "lambert", "light": [315, 15], "stretch": [0, 0.5]},
            look,
            Layer("aspect"),
        ]
    )
    assert facts(found) == [
        ("toon", "multiply", 0.5, (1.0, 0.0), {}),
        ("toon", "multiply", 0.5, None, {"bins": 4}),
        ("lambert", "normal", 1.0, None, {}),
        ("lambert", "normal", 1.0, None, {}),
        ("lambert", "normal", 1.0, (0.0, 0.5), {}),
        ("phong", "normal", 1.0, None, {"shininess": 7.0}),
        ("aspect", "normal", 1.0, None, {}),
    ]
    assert found[4].light == (315, 15)
    assert (found[5].light, found[5].colormap) == ((10, 20), "sepia")


def test_words_come_back():
    text = "toon:multiply:0.5:0.7..1, lambert:normal:1"
    assert blend_text(as_layers(text)) == text
    assert facts(as_layers(blend_text(as_layers(text)))) == facts(as_layers(text))
    layer = Layer("toon", light="west", options={"bins": 3})
    assert str(layer) == "toon:normal:1 (light=west bins=3)"
    assert kept_blend(text) is text
    assert kept_blend([layer]) == (layer,)


def test_a_layer_is_recorded_whole():
    layer = Layer("toon", mode="screen", stretch=(0.2, 0.9), options={"bins": 3})
    words = layer.recorded({"bins": 5, "sharpness": 4.0}, "west")
    assert words["light"] == "west"
    assert words["options"]["bins"] == 3
    assert words["options"]["sharpness"] == 4.0
    assert words["options"]["exposure"] == 1.0  # a default
    again = Layer(**words)
    assert facts([again])[0][:4] == facts([layer])[0][:4]
    lit = Layer("toon", light=md.Light((0, 1, 1)))
    np.testing.assert_allclose(lit.recorded({}, "west")["light"], np.array([0, 1, 1]) / 2**0.5)
    assert "light" not in layer.recorded({}, None)


@pytest.mark.parametrize("name", COMBINATIONS)
def test_combinations_are_those_of_the_toolbox(name):
    sky, openness, slope, lowest = COMBINATIONS[name]
    modes = [(e["method"], e["mode"], e["opacity"]) for e in (sky, openness, slope)]
    assert modes == [
        ("sky_view", "multiply", 0.25),
        ("positive_openness", "overlay", 0.5),
        ("slope", "luminosity", 0.5),
    ]
    assert {"mode", "opacity"}.isdisjoint(lowest)
    assert blend_name(name) == name
    assert blend_name("toon,lambert") == "blend"
    assert blend_name((Layer("toon"),)) == "blend"


def test_a_combination_is_its_layers():
    for name, layers in COMBINATIONS.items():
        found = as_layers(name)
        assert [e.function.__name__ for e in found] == [e["method"] for e in layers]


WRONG = {
    "": "blend has no layers",
    "  ": "blend has no layers",
    "sky_vew": "no combination and no method is called 'sky_vew'; did you mean 'sky_view'",
    "archaeologcal": "did you mean 'archaeological'",
    "lambert:multply": "no blend mode is called 'multply'; did you mean 'multiply'",
    "lambert:": "no blend mode is called ''",
    "lambert:multiply:3": "its opacity '3' is neither a number from 0 to 1 nor a percentage",
    "lambert:multiply:300%": "its opacity '300%'",
    "lambert:multiply:much": "its opacity 'much'",
    "lambert:multiply:nan": "its opacity 'nan'",
    "lambert:multiply:1:3": "'3' is not two numbers that differ",
    "lambert:normal:1:0..1:5": "has too many parts",
    "lambert,,phong": "has an empty layer",
    "lambert,fong": "no method is called 'fong'; did you mean 'phong'",
    "vat_flat,lambert": "no method is called 'vat_flat'",
}


@pytest.mark.parametrize(("blend", "sentence"), WRONG.items())
def test_each_wrong_word_has_one_sentence(blend, sentence):
    with pytest.raises(MeshdepictError, match=re.escape(sentence)) as caught:
        as_layers(blend)
    assert "\n" not in str(caught.value)


def test_other_wrong_things_are_refused():
    for wrong in ([], 5, {"method": "lambert"}, b"lambert"):
        with pytest.raises(MeshdepictError, match=r"neither a text such as|is no layer"):
            as_layers(wrong)
    for wrong in (5, ("lambert", "multiply", 1, {}, 2), ()):
        with pytest.raises(MeshdepictError, match="is no layer"):
            as_layers([wrong])
    with pytest.raises(MeshdepictError, match="a layer has no 'methd'; did you mean 'method'"):
        as_layers([{"methd": "lambert"}])
    with pytest.raises(MeshdepictError, match="has no method"):
        as_layers([{"mode": "multiply"}])
    with pytest.raises(MeshdepictError, match="scales is chosen for the whole blend"):
        as_layers([md.Look("lambert", scales=3)])
    with pytest.raises(MeshdepictError, match="toon has no option 'bin'; did you mean 'bins'"):
        as_layers([("toon", "normal", 1, {"bin": 3})])
    with pytest.raises(MeshdepictError, match="is no mapping of names to values"):
        as_layers([("toon", "normal", 1, 3)])
    with pytest.raises(MeshdepictError, match="no colour map 'sepa'"):
        Layer("toon", colormap="sepa")
    with pytest.raises(MeshdepictError, match="declare it with the decorator"):
        as_layers([len])
