"""Blends of layers: each layer as it looks alone, whatever is blended, on shared scale spaces."""

import collections

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking import sampling
from meshdepict.baking.choices import Choices
from meshdepict.baking.combinations import COMBINATIONS
from meshdepict.baking.layers import shared_ladders
from meshdepict.baking.recipe import load_recipe, merge_recipe
from meshdepict.color import colormap
from meshdepict.color.blending import blended, stretched
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.shading import METHODS, declaration
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField
from meshdepict.viewer.session import Session

COLUMNS, ROWS = np.meshgrid(np.arange(40.0), np.arange(30.0))


@pytest.fixture(scope="module")
def small():
    return md.samples.golf_ball(600, dimples=12, depth=0.05)


@pytest.fixture(scope="module")
def hills():
    return HeightField(4 * np.sin(COLUMNS / 4) * np.cos(ROWS / 5) + COLUMNS / 9)


@pytest.fixture(scope="module")
def image():
    """Normals of waves."""
    slopes = np.stack([np.cos(COLUMNS / 4), np.sin(ROWS / 5), np.full(COLUMNS.shape, 2.0)], axis=2)
    return GBuffer.from_images(slopes / np.linalg.norm(slopes, axis=2, keepdims=True))


def display(shape, method, **chosen):
    """What a method shows alone, as display values."""
    baked = md.bake(shape, method, **chosen)
    linear = declaration(METHODS[method]).linear
    return linear_to_srgb(baked.intensity) if linear else baked.intensity


@pytest.mark.parametrize("method", METHODS)
def test_a_single_layer_is_the_bake(small, hills, method):
    needs = declaration(METHODS[method]).needs
    few = {"rays": 4} if "rays" in needs else {}
    shape = hills if "heights" in needs else small
    alone = md.bake(shape, method, **few)
    layered = md.bake(shape, blend=[(method, "normal", 1, few)])
    np.testing.assert_array_equal(layered.colors, alone.colors)
    assert layered.look.method == method


@pytest.mark.parametrize("shape", ["small", "hills", "image"])
def test_layers_are_laid_on_as_display_values(shape, request):
    shape = request.getfixturevalue(shape)
    baked = md.bake(shape, blend="toon:multiply:0.5,slope:overlay:0.3:0.2..1,lambert", light="west")
    by_hand = display(shape, "lambert", light="west")
    slope = stretched(display(shape, "slope", light="west"), 0.2, 1)
    by_hand = blended(slope, by_hand, "overlay", opacity=0.3)
    by_hand = blended(display(shape, "toon", light="west"), by_hand, "multiply", opacity=0.5)
    np.testing.assert_allclose(baked.intensity, by_hand, atol=1e-6)
    np.testing.assert_array_equal(
        baked.colors, np.repeat(np.round(255 * by_hand)[:, None], 3, axis=1)
    )


@pytest.mark.parametrize(
    "blend",
    [
        "light_alignment:normal:0.5,normal_enhancement:screen:0.5,exaggerated",
        "exaggerated:overlay,light_alignment:multiply:0.3,mean_curvature",
    ],
)
def test_layers_of_other_ladders_look_as_they_do_alone(small, blend):
    baked = md.bake(small, blend=blend)
    by_hand = None
    for layer in reversed(md.Look(blend=blend).layers):
        alone = display(small, layer.method)
        by_hand = (
            alone if by_hand is None else blended(alone, by_hand, layer.mode, opacity=layer.opacity)
        )
    np.testing.assert_allclose(baked.intensity, by_hand, atol=1e-6)


def test_one_scale_space_serves_layers_that_read_the_same(small, monkeypatch):
    made = collections.Counter()
    known = sampling.scale_space

    def counted(*given, scales, ratio, **more):
        made[scales] += 1
        return known(*given, scales=scales, ratio=ratio, **more)

    monkeypatch.setattr(sampling, "scale_space", counted)
    baked = md.bake(small, blend="slope,mean_curvature,radiance_scaling,exaggerated")
    assert made == {9: 1}
    assert baked.space.last == 9
    made.clear()
    baked = md.bake(small, blend="slope:multiply,aspect")
    assert made == {0: 1}
    baked = md.bake(small, blend="slope,mean_curvature,lambert")
    assert baked.space.smoothed <= {0, 1}  # nothing that nobody reads


def test_which_ladders_are_shared():
    def ladders(blend, **chosen):
        look = Choices(blend=blend, **chosen)
        return shared_ladders([look.of_layer(layer).of_kind("mesh") for layer in look.layers])

    root, wider = 2**0.5, 1.7
    assert ladders("lambert,exaggerated,slope") == [(9, root)] * 3
    assert ladders("mean_curvature,exaggerated") == [(9, root)] * 2
    assert ladders("light_alignment,exaggerated") == [(5, wider), (9, root)]
    assert ladders("normal_enhancement,exaggerated") == [
        Choices("normal_enhancement").ladder, (9, root)
    ]  # fmt: skip
    assert ladders("light_alignment,exaggerated", scales=4, ratio=1.5) == [(4, 1.5)] * 2


def test_a_finished_scale_space_serves_all_layers(small):
    space = md.scale_space(small, scales=3)
    baked = md.bake(space, blend="slope:multiply:0.5,exaggerated", exaggeration=20)
    alone = md.bake(space, "exaggerated", exaggeration=20)
    np.testing.assert_allclose(
        baked.intensity, blended(display(small, "slope"), alone.intensity, "multiply", opacity=0.5)
    )
    assert baked.space is space


def test_options_are_those_of_the_method_and_lights_those_of_layers(small):
    look = md.Look("toon", blend="toon:multiply,lambert", bins=3, light="west")
    assert look.bake(small).provenance["options"] == "bins=3"
    by_hand = blended(
        display(small, "toon", bins=3, light="west"),
        display(small, "lambert", light="west"),
        "multiply",
    )
    np.testing.assert_allclose(look.bake(small).intensity, by_hand, atol=1e-6)
    lit = md.Look(blend=[md.Look("lambert", light="east"), "lambert:multiply:0.5"], light="west")
    np.testing.assert_allclose(
        lit.bake(small).intensity, display(small, "lambert", light="east"), atol=1e-6
    )


def test_colours_blend_and_grey_blends_take_a_colour_map(small):
    baked = md.bake(small, blend="slope:luminosity:0.5,gooch")
    assert baked.intensity.shape == (len(small.vertices), 3)
    mapped = md.bake(small, blend="slope,lambert", colormap="sepia")
    np.testing.assert_array_equal(
        mapped.colors, colormap("sepia")[md.bake(small, "slope").colors[:, 0]]
    )
    layer = {"method": "slope", "colormap": "sepia"}
    np.testing.assert_array_equal(md.bake(small, blend=[layer]).colors, mapped.colors)


def test_what_a_blend_looks_like_makes_it_again(small, hills):
    blend = "light_alignment:normal:0.5,light_warping:screen:0.3,exaggerated"
    for shape in (small, hills):
        baked = md.bake(shape, blend=blend, tint="earth")
        again = baked.look.bake(shape)
        np.testing.assert_array_equal(again.colors, baked.colors)
        assert again.provenance == baked.provenance


def test_a_recipe_holds_all_layers(small, tmp_path):
    look = md.Look(
        "toon",
        blend=["toon:multiply:0.5:0.1..1", {"method": "lambert", "light": (10, 30)}],
        bins=3,
        tint="swiss:0..1",
        view="left",
    )
    path = look.save(tmp_path / "look.toml")
    again = md.Look.load(path)
    np.testing.assert_array_equal(again.bake(small).colors, look.bake(small).colors)
    assert again.layers[0].options["bins"] == 3
    assert again.tint == "swiss:0..1"
    baked = look.bake(small)
    baked.look.save(path, force=True)
    np.testing.assert_array_equal(md.Look.load(path).bake(small).colors, baked.colors)


def test_files_of_layers_lie_beside_their_recipe(small, tmp_path):
    from PIL import Image

    (tmp_path / "in").mkdir()
    picture = tmp_path / "in" / "sphere.png"
    Image.fromarray(np.full((16, 16, 3), 130, np.uint8)).save(picture)
    layer = {"method": "lit_sphere", "options": {"sphere": str(picture)}}
    path = md.Look(blend=[layer]).save(tmp_path / "in" / "look.toml")
    assert str(tmp_path) not in path.read_text()
    md.Look.load(path).bake(small)
    (tmp_path / "out").mkdir()
    with pytest.raises(MeshdepictError, match="only files in its own folder"):
        md.Look(blend=[layer]).save(tmp_path / "out" / "look.toml")
    text = path.read_text().replace("sphere.png", "../sphere.png")
    path.write_text(text)
    with pytest.raises(MeshdepictError, match="sphere"):
        load_recipe(path)


@pytest.mark.parametrize(
    "blend",
    ["[5]", '[{ mode = "multiply" }]', '[{ method = "lambert", options = 3 }]', "7", "[]",
     '[{ method = "lambrt" }]', '"lambert:multply"'],
)  # fmt: skip
def test_a_recipe_with_a_wrong_blend_is_refused(tmp_path, blend):
    path = tmp_path / "look.toml"
    path.write_text(f"blend = {blend}\n")
    with pytest.raises(MeshdepictError, match=r"^[^\n]*$"):
        md.Look.load(path)


def test_what_is_said_beside_a_recipe_replaces_its_blend():
    recipe = {"method": "toon", "blend": "toon,lambert", "bins": 3, "light": "west"}
    assert merge_recipe(recipe, {"method": "phong"}) == {"method": "phong", "light": "west"}
    other = merge_recipe(recipe, {"blend": "slope"})
    assert other == {"blend": "slope", "light": "west"}
    assert merge_recipe(recipe, {"light": "east"}) == {**recipe, "light": "east"}


def test_another_method_leaves_the_blend_behind():
    look = md.Look(blend="slope:multiply,lambert", light="west")
    assert look.method == "lambert"
    other = look.replace(method="toon")
    assert (other.method, other.blend, other.light) == ("toon", None, "west")
    assert look.replace(light="east").blend == "slope:multiply,lambert"


def test_archaeologists_have_their_picture(hills):
    baked = md.bake(hills, blend="archaeological")
    sky = display(hills, "sky_view", sky="overhead", radius=10)
    openness = display(hills, "positive_openness", radius=10, least=0, most=180) * 180
    slope = 50 * (1 - display(hills, "slope", steepest=50))
    lit = display(hills, "hillshade", light=(315, 35))
    picture = (lit + 1 - slope / 50) / 2  # luminosity of a grey upon a grey, by half
    over = np.clip((openness - 68) / (93 - 68), 0, 1)
    bright = np.where(picture > 0.5, 1 - 2 * (1 - picture) * (1 - over), 2 * picture * over)
    picture = (picture + bright) / 2
    open_sky = np.clip((sky - 0.7) / 0.3, 0, 1)
    picture = 0.75 * picture + 0.25 * picture * open_sky
    np.testing.assert_allclose(baked.intensity, picture, atol=1e-5)
    assert baked.provenance["method"] == "archaeological"
    flat = md.bake(hills, blend="vat_flat")
    assert flat.provenance["light"].startswith("azimuth 315 elevation 15")
    general = md.bake(hills, blend="geomorphological")
    assert np.abs(general.intensity - baked.intensity).max() > 0.05


@pytest.mark.parametrize("name", COMBINATIONS)
def test_combinations_are_for_meshes_too(small, name):
    baked = md.bake(small, blend=name)
    assert baked.intensity.shape == (len(small.vertices),)
    assert np.ptp(baked.intensity) > 0.3


def test_blends_are_named_in_provenance(small):
    baked = md.bake(small, blend="slope:multiply:0.5,lambert")
    assert baked.provenance["method"] == "blend"
    assert baked.provenance["blend"] == "slope:multiply:0.5, lambert:normal:1"
    lit = md.bake(small, blend=[{"method": "toon", "light": (315, 15), "options": {"bins": 3}}])
    assert lit.provenance["blend"] == "toon:normal:1 (light=315,15 bins=3)"
    assert lit.provenance["light"].startswith("azimuth 315 elevation 15")
    assert "blend" not in md.bake(small).provenance
    own = md.bake(small, blend="light_warping:multiply,aspect:screen,lambert").provenance
    assert own["blend"] == (
        "light_warping:multiply:1 (light=studio), aspect:screen:1, lambert:normal:1"
    )
    assert own["light"].startswith("northwest")


def test_lights_may_be_arrays(small):
    array, numbers = np.array([0.0, 1.0, 1.0]), (0.0, 1.0, 1.0)
    for light in (array, list(numbers)):
        layer = {"method": "lambert", "light": light}
        found = md.bake(small, blend=["light_warping:multiply", layer])
        named = md.bake(small, blend=["light_warping:multiply", {**layer, "light": numbers}])
        np.testing.assert_array_equal(found.colors, named.colors)
        assert found.provenance == named.provenance
        whole = md.bake(small, blend="light_warping:multiply,lambert", light=light)
        assert "light=" not in whole.provenance["blend"]


def test_a_blend_is_lit_where_a_layer_is():
    assert md.Look(blend="lambert:multiply,slope").lit
    assert not md.Look(blend="mean_curvature:multiply,slope").lit
    assert not md.Look("slope").lit


def test_whether_a_blend_sees_the_view():
    assert md.Look(blend="phong:multiply:0.1,lambert").sees
    assert not md.Look(blend="lambert:multiply:0.1,half_lambert").sees


def test_from_the_command_line(run, ball_ply, tmp_path):
    status, out, err = run("bake", "ball.ply", "--blend", "slope:multiply:0.5,lambert")
    assert (status, err) == (0, [])
    assert "ball-blend.ply" in out[0]
    again = md.read("ball-blend.ply")
    assert again.document.provenance
    status, _, err = run("bake", "ball.ply", "--blend", "slope:multply,lambert")
    assert status == 2
    assert "did you mean 'multiply'?" in err[0]
    status, _, err = run("bake", "ball.ply", "-m", "toon", "--blend", "slope,lambert")
    assert status == 2
    assert "blend has no layer toon" in err[0]
    status, _, err = run("bake", "ball.ply", "--tint", "earth:0..1", "--force", "-o", "t.ply")
    assert (status, err) == (0, [])
    status, _, err = run("bake", "ball.ply", "--tint", "erth")
    assert status == 2
    assert "did you mean 'earth'?" in err[0]


def test_what_makes_no_sense_is_refused(small):
    with pytest.raises(MeshdepictError, match="blend has no layer phong: leave method out, or nam"):
        md.Look("phong", blend="slope,lambert")
    with pytest.raises(MeshdepictError, match="colormap2d shows one method under two lights"):
        md.Look(blend="slope", colormap2d="dusk")
    with pytest.raises(MeshdepictError, match="leave it out with blend"):
        md.bake(small, blend="slope,lambert", refine=2)
    with pytest.raises(MeshdepictError, match="the colour map 'sepia' needs one value"):
        md.bake(small, blend="gooch,lambert", colormap="sepia")
    phantom = md.samples.ct_phantom((8, 8, 8))
    for name, value in (("blend", "lambert"), ("tint", "earth")):
        with pytest.raises(MeshdepictError, match=f"{name} is about a mesh"):
            md.bake_volume(phantom, "lambert", **{name: value})
        with pytest.raises(MeshdepictError, match=f"views and movies have no {name}"):
            Session(small, "lambert", **{name: value})
