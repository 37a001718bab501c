"""The light that a method declares: taken where nobody names one, and never otherwise."""

import numpy as np
import pytest
from method_families import ON_MESHES

import meshdepict as md
from meshdepict import samples, shading
from meshdepict.baking.recipe import load_recipe
from meshdepict.scene.names import as_lighting
from meshdepict.scene.rig import Rig
from meshdepict.shading import METHODS, declaration
from meshdepict.viewer.session import Session

every_method = pytest.mark.parametrize("method", ON_MESHES)


@pytest.fixture(scope="module")
def small():
    return samples.golf_ball(600, dimples=12, depth=0.05)


def few(method):
    return {"rays": 2} if "rays" in declaration(METHODS[method]).needs else {}


@every_method
def test_without_a_light_it_is_the_declared_one(small, method):
    declared = declaration(METHODS[method]).light
    how = {"scales": 2, "view": "left", **few(method)}
    baked = md.bake(small, method, **how)
    named = md.bake(small, method, light=declared, **how)
    np.testing.assert_array_equal(baked.colors, named.colors)
    assert baked.provenance == named.provenance
    assert baked.provenance["light"].startswith(declared)
    assert md.Look(method).light is None
    assert md.Look(method).lit_by == declared


@pytest.mark.parametrize("method", ["light_warping", "light_alignment"])
def test_a_named_light_is_obeyed(small, method):
    baked = md.bake(small, method, light="northwest", scales=2)
    assert baked.provenance["light"].startswith("northwest (")
    alone = METHODS[method](baked.space, "northwest")
    np.testing.assert_array_equal(baked.intensity, alone)
    assert np.abs(md.bake(small, method, scales=2).intensity - alone).max() > 0.05


def test_under_its_own_light_hardly_anything_is_black_or_burnt_out(ball):
    for method in ("light_warping", "light_alignment"):
        own = md.bake(ball, method).colors[:, 0]
        one = md.bake(ball, method, light="northwest").colors[:, 0]
        assert (one < 8).mean() > 0.25
        assert (own < 8).mean() < 0.02
        assert (own > 247).mean() < 0.08


def test_two_results_take_one_light(small):
    baked = md.bake(small, "light_warping", colormap2d="dusk", scales=1)
    assert baked.provenance["light"].startswith("northwest (")


def test_a_recipe_and_another_bake_have_the_same_lights(small, tmp_path):
    baked = md.bake(small, "light_warping", view="top")
    path = tmp_path / "look.toml"
    baked.look.save(path)
    assert isinstance(load_recipe(path)["light"], Rig)
    again = md.Look.load(path).bake(small)
    np.testing.assert_array_equal(again.colors, baked.colors)
    md.Look("light_warping").save(tmp_path / "open.toml")
    assert load_recipe(tmp_path / "open.toml")["light"] == "studio"
    path.write_text('method = "lambert"\nlight = { name = "stage" }\n', encoding="utf-8")
    with pytest.raises(md.MeshdepictError, match=r"look.toml: lights by name have a name, an up"):
        load_recipe(path)


def test_a_method_declares_a_light_that_there_is():
    with pytest.raises(md.MeshdepictError, match="under 'studjo'; did you mean 'studio'"):
        md.method(source="nobody", lights="several", light="studjo")
    with pytest.raises(md.MeshdepictError, match="can't be shown under 'studio'"):
        md.method(source="nobody", light="studio")  # of one light


def test_a_session_takes_each_method_s_light_until_it_is_given_one(small):
    session = Session(small, "lambert")
    session.use("light_warping")
    assert isinstance(session.light, Rig)
    session.use("exaggerated")
    assert session.light.name == "northwest"
    session.use("light_alignment")
    session.drag_light((0.2, 0.1))
    assert isinstance(session.light, Rig)  # turned as a whole
    key = session.light.lamps[0].direction
    session.use("lambert")  # which takes one: the key
    np.testing.assert_allclose(session.light.direction, key)
    session.reset()
    session.use("light_warping")
    np.testing.assert_allclose(session.light.frame, session.view.frame, atol=1e-12)
    session.shine("east")
    session.use("light_alignment")
    assert session.light.name == "east"


def test_images_and_volumes_take_it_too(small):
    pixels = md.GBuffer.of(small, "front", size=(60, 60))
    assert md.bake(pixels, "light_warping").provenance["light"].startswith("studio")
    voxels = md.bake_volume(samples.ct_phantom((16, 18, 14)), "light_alignment", scales=2)
    assert voxels.provenance["light"].startswith("key-and-fill (up 0 0 1")


def test_the_window_and_the_page_show_the_numbers_that_were_baked(small):
    session = Session(small)
    baked = md.bake(small)
    np.testing.assert_array_equal(session.colors, baked.colors)
    assert session.settled().options == {
        name: baked.look.options[name] for name in ("exaggeration", "base", "contrast")
    }
    assert session.options == {}  # still open
    np.testing.assert_array_equal(session.settled().bake(small).colors, baked.colors)


# --- ranges and grounds -------------------------------------------------------------------------


def test_ambient_occlusion_uses_the_grey_scale():
    torus = samples.torus(1_500)
    space = md.scale_space(torus, scales=0)
    plain = shading.ambient_occlusion(space, None, rays=256, darkest=0)
    shown = shading.ambient_occlusion(space, None, rays=256)
    darkest = md.bake(space, "ambient_occlusion").look.options["darkest"]
    assert 0 < darkest < 1
    np.testing.assert_allclose(shown, np.maximum((plain - darkest) / (1 - darkest), 0), atol=1e-6)
    assert (shown == 0).mean() <= 0.06
    assert np.ptp(shown) > np.ptp(plain)
    flat = md.scale_space(samples.sphere(162), scales=0)
    assert shading.ambient_occlusion(flat, None, rays=16).min() > 0.9  # open all round


def test_pictures_of_mostly_white_methods_lie_on_paper(small, tmp_path):
    from PIL import Image

    for method, options, ground in (
        ("ambient_occlusion", {"rays": 2}, (226, 221, 209)),
        ("exaggerated", {"scales": 1}, (255, 255, 255)),
    ):
        baked = md.bake(small, method, **options)
        for background, wanted in ((None, ground), ("#102030", (16, 32, 48))):
            path = baked.picture(tmp_path / "one.png", size=(40, 40), background=background)
            assert Image.open(path).convert("RGB").getpixel((0, 0)) == wanted


def test_the_rig_of_a_movie_goes_with_the_eye_or_circles():
    from meshdepict.drawing.motion import circling, turned_light
    from meshdepict.scene.view import View

    view = View((0, 0, 5), (0, 0, 0), (0, 1, 0), parallel_scale=1)
    rig = as_lighting("studio", view)
    for move in (circling, turned_light):
        there = move(rig, view, 90)
        assert isinstance(there, Rig)
        back = move(there, view, -90)
        np.testing.assert_allclose(back.frame, rig.frame, atol=1e-12)
