"""Accuracy: named sets of numbers, which what somebody says wins over."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import meshdepict as md
from meshdepict import samples
from meshdepict.baking.accuracy import ACCURACIES, ADJUSTABLE, numbers_of
from meshdepict.baking.recipe import load_recipe, merge_recipe
from meshdepict.errors import MeshdepictError
from meshdepict.options import options_of
from meshdepict.shading.registry import METHODS

BALL = samples.golf_ball(600)


@pytest.mark.parametrize("method", list(METHODS))
def test_normal_is_what_is_usual(method):
    usual, normal = md.Look(method), md.Look(method, accuracy="normal")
    assert normal.words() == usual.words()
    assert normal.taken == {}
    assert [getattr(normal, name) for name in ("scales", "ratio", "tolerance")] == [
        getattr(usual, name) for name in ("scales", "ratio", "tolerance")
    ]


@pytest.mark.parametrize("method", ["exaggerated", "lambert", "ambient_occlusion"])
def test_normal_gives_the_same_bytes(method):
    usual, normal = md.bake(BALL, method), md.bake(BALL, method, accuracy="normal")
    assert np.array_equal(usual.colors, normal.colors)
    assert usual.provenance == normal.provenance


@pytest.mark.parametrize("accuracy", list(ACCURACIES))
@pytest.mark.parametrize("method", list(METHODS))
def test_an_accuracy_is_the_numbers_that_it_stands_for(method, accuracy):
    look = md.Look(method, accuracy=accuracy)
    said = md.Look(method, **look.taken)
    assert look.options == said.options
    assert look.ladder == said.ladder
    assert look.tolerance == said.tolerance
    assert set(look.taken) <= set(ADJUSTABLE)


@pytest.mark.parametrize(
    "said", [{"tolerance": 1e-4}, {"rays": 64}, {"lights": 54}, {"tolerance": 1e-5, "rays": 7}]
)
@pytest.mark.parametrize("accuracy", ["draft", "reference"])
def test_what_is_said_wins(said, accuracy):
    look = md.Look("phong", accuracy=accuracy, **said)
    for again in (look, look.replace(exposure=2), pickle.loads(pickle.dumps(look))):
        for name, value in said.items():
            assert again.options.get(name, getattr(again, name, None)) == value


def test_scales_or_ratio_win_together():
    for said in ({"scales": 7}, {"ratio": 1.5}):
        look = md.Look("exaggerated", accuracy="draft", **said)
        assert look.ladder == md.Look("exaggerated", **said).ladder


def test_numbers_for_each_scale_keep_the_scales():
    look = md.Look("exaggerated", accuracy="draft", exaggeration=(15.0,) * 10)
    assert look.ladder == md.Look("exaggerated").ladder


def test_another_accuracy_of_the_same_look():
    look = md.Look("exaggerated", accuracy="draft", exaggeration=20)
    assert look.replace(accuracy="normal").words() == {"exaggeration": 20}
    assert look.replace(method="phong", accuracy="draft").options["rays"] == 16


def test_errors_fall_from_draft_to_reference():
    light = "northwest:20"
    exact = md.bake(BALL, "lambert", light=light, shadows=True, rays=8192).colors.astype(float)
    errors = [
        np.sqrt(np.mean((md.bake(
            BALL, "lambert", light=light, shadows=True, accuracy=accuracy
        ).colors - exact) ** 2))
        for accuracy in ACCURACIES
    ]  # fmt: skip
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.5


def test_rays_that_a_method_does_not_take_stay_none():
    function = METHODS["radiance_scaling"]
    assert "rays" not in numbers_of("draft", function, {})
    assert "rays" not in numbers_of("draft", function, {"illumination": "irradiance"})
    assert numbers_of("draft", function, {"shadows": True})["rays"] == 16
    assert numbers_of("reference", function, {"illumination": "occlusion"})["rays"] == 4096


def test_occlusion_keeps_the_rays_that_its_grey_scale_needs():
    assert md.Look("ambient_occlusion", accuracy="draft").options["rays"] == 256


def test_a_method_of_ones_own_with_options_of_the_same_names():
    @md.method(source="a try")
    def stripes(space, light, *, rays: float = 3.5, lights: float = 2.0, exposure: float = 1.0):
        """Shade nothing."""
        return np.ones(len(space.points), np.float32)

    assert set(md.Look(stripes, accuracy="draft").taken) <= {"tolerance"}


def test_layers_have_numbers_of_their_own():
    blend = "sky_view:multiply:0.5,exaggerated"
    look = md.Look(blend=blend, accuracy="draft")
    sky, shaded = (look.of_layer(layer) for layer in look.layers)
    assert sky.options["rays"] == 64
    assert shaded.ladder == (5, 2.0)
    mixed = md.bake(BALL, blend=blend, accuracy="draft")
    assert mixed.provenance["accuracy"] == "draft"


def test_provenance_and_recipes_hold_the_numbers(tmp_path):
    baked = md.bake(BALL, "phong", accuracy="draft", shadows=True)
    assert baked.provenance["accuracy"] == "draft"
    assert "rays=16" in baked.provenance["options"]
    path = baked.look.save(tmp_path / "look.toml")
    read = load_recipe(path)
    assert (read["accuracy"], read["tolerance"], read["rays"]) == ("draft", 1e-2, 16)
    assert np.array_equal(md.bake(BALL, **read).colors, baked.colors)


def test_a_recipe_of_layers_gives_the_same_bytes(tmp_path):
    baked = md.bake(BALL, blend="sky_view:multiply:0.5,exaggerated", accuracy="draft")
    path = baked.look.save(tmp_path / "look.toml")
    assert np.array_equal(md.bake(BALL, **load_recipe(path)).colors, baked.colors)


def test_another_accuracy_than_the_recipes(tmp_path):
    path = md.Look("phong", accuracy="draft", shadows=True, lights=7).save(tmp_path / "look.toml")
    merged = md.Look(**merge_recipe(load_recipe(path), {"accuracy": "reference"}))
    assert merged.options["rays"] == 1024
    assert merged.options["lights"] == 7  # which the recipe's writer had said
    assert merged.tolerance == md.Look().tolerance
    usual = md.Look("phong").save(tmp_path / "usual.toml")
    assert md.Look(**merge_recipe(load_recipe(usual), {"accuracy": "draft"})).tolerance == 1e-2


def test_a_scale_space_keeps_its_own_numbers():
    space = md.scale_space(BALL)
    drafted = md.bake(space, "exaggerated", accuracy="draft")
    assert np.array_equal(drafted.colors, md.bake(space, "exaggerated").colors)
    assert md.bake(space, "sky_view", accuracy="draft").look.options["rays"] == 64


@pytest.mark.parametrize("accuracy", ["best", "Draft", 3, [1]])
def test_unknown_accuracies_are_refused(accuracy):
    with pytest.raises(MeshdepictError, match="none of draft, normal, reference"):
        md.Look(accuracy=accuracy)


def test_every_count_stays_within_its_range():
    for accuracy in ACCURACIES:
        for method in METHODS.values():
            for name, value in numbers_of(accuracy, method, {"shadows": True}).items():
                option = options_of(method).get(name)
                if option is not None:
                    assert option.accepts.low <= value <= option.accepts.high
