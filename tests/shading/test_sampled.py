"""As many rays as light takes: what ends the search, what is recorded, and what it costs."""

from typing import Annotated

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading
from meshdepict.baking.layer_list import Layer
from meshdepict.baking.look import Look
from meshdepict.baking.recipe import load_recipe
from meshdepict.errors import MeshdepictError
from meshdepict.files import limits
from meshdepict.options import Range, options_of
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.view import View
from meshdepict.shading import METHODS, sampled
from meshdepict.shading.method import method
from meshdepict.transport import transfer
from meshdepict.transport.rays import MOST_RAYS
from meshdepict.viewer.session import Session

SIDE = (-1.0, 0.2, 0.3)
HIDING = [name for name in METHODS if "bounces" in options_of(METHODS[name])]


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Busy machines find the same numbers as others."""
    monkeypatch.setattr(sampled, "AUTO_SECONDS", 1e3)


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(900)


@pytest.fixture
def space(torus):
    return md.scale_space(torus, scales=1)


@pytest.fixture
def asked(monkeypatch):
    """The number of rays of every transfer that was traced."""
    calls = []
    real = transfer.traced_transfer
    monkeypatch.setattr(
        transfer, "traced_transfer", lambda *a, **k: calls.append(k["rays"]) or real(*a, **k)
    )
    return calls


# --- a number or a word -----------------------------------------------------------------------


@method(source="nobody")
def numbered(
    space, light, *, count: Annotated[int | str, Range(1, 9, help="how many", words=("all",))] = 3
):
    """Shade evenly, as many as asked for."""
    return np.full(space.count, 0.1 * (9 if count == "all" else count), np.float32)


def test_an_option_may_be_a_number_or_a_word(ball):
    space = md.scale_space(ball, scales=0)
    assert str(options_of(numbered)["count"].accepts) == "1 … 9 | all"
    assert options_of(numbered)["count"].kind is int
    np.testing.assert_allclose(numbered(space, "north", count="all"), 0.9)
    np.testing.assert_allclose(numbered(space, "north", count="4"), 0.4)
    assert 'count : int or "all"' in numbered.__doc__
    for wrong in ("every", "10", "ALL", ""):
        with pytest.raises(MeshdepictError, match=r"is not a number in its range \(1 … 9 \| all\)"):
            numbered(space, "north", count=wrong)


# --- what ends the search ---------------------------------------------------------------------


@pytest.mark.parametrize("name", HIDING)
def test_every_method_finds_its_rays_and_shades_as_by_that_number(space, name):
    shade = METHODS[name]
    found = shade(space, SIDE, shadows=True, bounces=2, rays="auto")
    chosen = space.light_errors.found
    assert chosen.error == space.light_errors[chosen.rays]
    assert chosen.error < sampled.UNSEEN
    assert not chosen.ended
    np.testing.assert_array_equal(
        found, shade(space, SIDE, shadows=True, bounces=2, rays=chosen.rays)
    )


def test_rays_double_until_what_they_err_cannot_be_seen(space, asked, monkeypatch):
    monkeypatch.setattr(sampled, "UNSEEN", 0.5)
    shading.lambert(space, SIDE, shadows=True, bounces=2, rays="auto")
    chosen = space.light_errors.found
    assert asked == [64 * 2**k for k in range(len(asked))]
    assert len(asked) > 1
    assert chosen.rays == asked[-1]
    assert space.light_errors[asked[-2]] >= 0.5 > chosen.error
    # Another light begins at the beginning, and traces nothing that was traced.
    shading.lambert(space, (1, 0.2, 0.3), shadows=True, bounces=2, rays="auto")
    assert len(asked) == len(set(asked))


def test_rays_are_no_more_than_time_allows(space, asked, monkeypatch):
    monkeypatch.setattr(sampled, "UNSEEN", 0.0)
    monkeypatch.setattr(sampled, "AUTO_SECONDS", 0.0)
    shading.lambert(space, SIDE, bounces=1, rays="auto")
    assert asked == [64]
    assert space.light_errors.found.ended == "time"
    assert str(space.light_errors.found).endswith("grey levels when time was up")


def test_rays_are_no_more_than_memory_allows(space, asked, monkeypatch):
    monkeypatch.setattr(sampled, "UNSEEN", 0.0)
    try:
        limits.set_max_memory(16 * 300 * space.count)  # 256 rays, and not 512
        shading.lambert(space, SIDE, bounces=1, rays="auto")
    finally:
        limits.set_max_memory(None)
    assert asked == [64, 128, 256]
    assert space.light_errors.found.ended == "memory"
    assert str(space.light_errors.found).endswith("grey levels when memory was full")


def test_rays_are_no_more_than_there_are(monkeypatch):
    monkeypatch.setattr(sampled, "UNSEEN", 0.0)
    monkeypatch.setattr(sampled, "FIRST_RAYS", MOST_RAYS)
    point = md.Mesh(np.eye(3), [[0, 1, 2]])
    space = md.scale_space(point, scales=0)
    shading.lambert(space, SIDE, bounces=1, rays="auto")
    assert space.light_errors.found[::2] == (MOST_RAYS, "most")


def test_where_nothing_is_sampled_there_is_nothing_to_find(space, asked):
    plain = shading.lambert(space, SIDE, rays="auto")
    np.testing.assert_array_equal(plain, shading.lambert(space, SIDE))
    assert space.light_errors.found is None
    shading.lambert(space, SIDE, shadows=True, rays="auto")  # a direction is one ray
    assert space.light_errors.found == (64, 0.0, "")
    assert not asked


def test_precomputed_light_takes_a_number(space):
    white = Environment(np.ones((8, 16, 3), np.float32))
    for illumination in ("irradiance", "occlusion"):
        with pytest.raises(MeshdepictError, match="takes a number of rays, 256 for instance"):
            shading.radiance_scaling(space, white, illumination=illumination, rays="auto")


# --- what is recorded -------------------------------------------------------------------------

LIT = {"light": Light(SIDE), "shadows": True, "bounces": 2, "rays": "auto"}


def test_a_bake_records_the_number_and_makes_the_same_again(torus, folder):
    baked = md.bake(torus, "lambert", **LIT)
    number = baked.look.options["rays"]
    assert f"rays={number}" in baked.provenance["options"].split()
    assert baked.provenance["rays auto"].startswith(f"{number}, ")
    baked.look.save(folder / "look.toml")
    assert load_recipe(folder / "look.toml")["rays"] == number
    again = Look.load(folder / "look.toml").bake(torus)
    np.testing.assert_array_equal(again.intensity, baked.intensity)
    assert "rays auto" not in again.provenance


def test_layers_find_a_number_each(torus):
    layers = (Layer("lambert", options={k: LIT[k] for k in ("shadows", "bounces", "rays")}),)
    baked = md.bake(torus, blend=(*layers, Layer("exaggerated")), light=SIDE)
    assert isinstance(baked.look.layers[0].options["rays"], int)


def test_pixels_and_refined_meshes_take_the_number_of_the_whole(torus):
    buffer = md.GBuffer.of(torus, View.fitted("front", torus), size=(40, 40))
    assert isinstance(md.bake(buffer, "lambert", **LIT).look.options["rays"], int)
    refined = md.bake(md.samples.torus(200), "lambert", refine=20, **LIT)
    assert isinstance(refined.look.options["rays"], int)


def test_the_side_that_is_seen_finds_a_number_too(torus):
    baked = md.bake(torus, "lambert", two_sided=True, **LIT)
    assert isinstance(baked.look.options["rays"], int)


def test_terrain_finds_a_number(rng):
    field = md.HeightField(rng.random((20, 20)) * 3)
    baked = md.bake(field, "lambert", **LIT)
    assert isinstance(baked.look.options["rays"], int)


def test_a_session_offers_it_and_its_recipe_has_the_number(torus):
    session = Session(torus, "lambert", shadows=True, bounces=1, rays="auto")
    control = next(each for each in session.controls if each.name == "rays")
    assert control.words == ("auto",)
    assert session.value(control) == "auto"
    number = session.baked().look.options["rays"]
    assert session.recorded().options["rays"] == number
    session.set(rays=32)
    assert session.recorded().options["rays"] == 32


def test_the_closing_line_says_which_number_and_how_sure(run, ball_ply):
    status, out, _ = run(
        "bake", "ball.ply", "-m", "lambert", "--set", "shadows=true", "--set", "bounces=1",
        "--set", "rays=auto",
    )  # fmt: skip
    assert status == 0
    assert "rays auto: 64, " in out[0]
    assert " grey levels" in out[0]
