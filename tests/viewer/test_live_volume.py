"""Volumes shaded on the graphics card: they equal bakes, and a new light passes over no voxel."""

import dataclasses

import numpy as np
import pytest
from volume_shapes import EDGE, WHITE, blobs

from meshdepict.baking.look import bake_volume
from meshdepict.color.transfer import TransferFunction
from meshdepict.drawing.canvas import place
from meshdepict.drawing.volume_scene import add_baked
from meshdepict.errors import MeshdepictError
from meshdepict.scales.making import scale_space
from meshdepict.scene.view import View
from meshdepict.viewer.live import live_methods, look, volume_shading
from meshdepict.viewer.live.volume_shading import LiveVolume

pv = pytest.importorskip("pyvista")

SIZE = (120, 120)


@pytest.fixture(scope="module")
def space():
    return bake_volume(blobs(), "exaggerated", transfer=WHITE, scales=4, tolerance=1e-3).space


def portrait(add, view, shape):
    window = pv.Plotter(off_screen=True, window_size=list(SIZE))
    window.disable_anti_aliasing()
    try:
        window.set_background("black")
        add(window)
        place(window.camera, view, shape)
        window.reset_camera_clipping_range()
        return window.screenshot(return_img=True, transparent_background=True).astype(int)
    finally:
        window.close()


def difference(space, method, *, options=None, light="northwest", view="isometric"):
    """Grey levels between a live picture and that of a bake, where both are opaque."""
    view = View.fitted(view, space.shape)
    baked = bake_volume(space, method, light=light, view=view, **(options or {}))
    live = LiveVolume(space, method, options=options, light=light, view=view)
    live.check()
    a = portrait(lambda window: add_baked(window, baked), view, space.shape)
    b = portrait(lambda window: window.renderer.AddVolume(live.actor), view, space.shape)
    # Silhouettes: bytes interpolated with 8 bits against floats.
    assert (np.abs(a[..., 3] - b[..., 3]) > 8).mean() < 0.005
    inside = (a[..., 3] == 255) & (b[..., 3] == 255)
    assert inside.sum() > 1000
    return np.abs(a - b)[inside].max(axis=1)


# Bakes are rounded at voxels, and the card interpolates their bytes with weights of 8 bits: two
# levels. Where opacity at a quarter of a step is nearly nothing, one finds it there and the other
# a quarter of a voxel further, which on balls of 4 voxels is up to 15 levels: few pixels.
@pytest.mark.parametrize("method", live_methods())
def test_live_pictures_are_those_of_bakes(space, method):
    found = difference(space, method)
    assert np.median(found) <= 1
    assert np.percentile(found, 95) <= 3
    assert np.percentile(found, 99) <= 8


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("exaggerated", {"emphasis": 0.0, "exaggeration": 30.0}),
        ("exaggerated", {"focus": (102.0, -48.0, 22.0), "radius": 3.0, "exposure": 0.8}),
        ("light_alignment", {"material": "phong"}),
        ("radiance_scaling", {"curvature": "view", "gain": 2.0}),
    ],
)
def test_so_they_are_with_other_options_and_lights(space, method, options):
    assert np.percentile(difference(space, method, options=options, light=(80, 20)), 95) <= 3


def test_so_they_are_on_a_left_handed_oblique_grid():
    shape = blobs("oblique, left-handed")
    space = bake_volume(shape, "exaggerated", transfer=WHITE, scales=3, tolerance=1e-3).space
    options = {"focus": tuple(shape.to_world((8, 13, 7))), "radius": 2.0}
    assert np.percentile(difference(space, "exaggerated", options=options), 95) <= 3


def test_lights_and_options_pass_over_no_voxel(space, monkeypatch):
    live = LiveVolume(space, "exaggerated", view="front")
    live.check()
    image = live.actor.GetMapper().GetInput()
    sheet = live.actor.GetProperty().GetTransferFunction2D()
    before = image.GetMTime(), sheet.GetMTime()
    monkeypatch.delattr("meshdepict.viewer.live.live_method.pack_normals")
    monkeypatch.setattr(volume_shading, "march", None)
    live.set_light((10.0, 20.0))
    live.set_options(exaggeration=30.0, emphasis=-1.0, exposure=0.8)
    live.set_view("left")
    live.check()
    assert (image.GetMTime(), sheet.GetMTime()) == before


def test_a_new_light_is_seen(space):
    view = View.fitted("front", space.shape)
    live = LiveVolume(space, "lambert", view=view, light="west")
    pictures = []
    for light in ("west", "east", "west"):
        live.set_light(light)
        pictures.append(
            portrait(lambda window: window.renderer.AddVolume(live.actor), view, space.shape)
        )
    west, east, again = pictures
    assert np.abs(west - east).max() > 100
    assert (west == again).all()


def test_method_and_options_can_be_asked_for(space):
    live = LiveVolume(space, "exaggerated", options={"emphasis": -1.0}, view="front")
    assert live.method == "exaggerated"
    assert live.options["emphasis"] == -1
    live.options["emphasis"] = 3  # a copy
    assert live.options["emphasis"] == -1


REFUSED = [
    ("gooch", {}, {}, "'gooch' can't be shown live .* bake it instead"),
    ("lamber", {}, {}, "did you mean 'lambert'"),
    ("exaggerated", {"principal_strength": 2.0}, {}, "principal_strength=2.0, only with 0.0; bake"),
    ("exaggerated", {"contrast": -2.0}, {}, "contrast=-2.0 is not a number in its range"),
    ("lambert", {}, {"colormap": "sepia"}, "colormap is about meshes: a volume has the colours"),
    ("phong", {}, {"light": ["east"] * 65}, "at most 64 lights, not 65; bake it instead"),
]


@pytest.mark.parametrize(("method", "options", "others", "sentence"), REFUSED, ids=str)
def test_what_can_t_be_live_is_refused(space, method, options, others, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        LiveVolume(space, method, options=options, **({"view": "front"} | others))


def test_other_shapes_transfer_functions_and_too_many_voxels_are_refused(space, ball, monkeypatch):
    with pytest.raises(MeshdepictError, match="scale space of a volume's voxels"):
        LiveVolume(scale_space(ball, scales=0), "lambert", view="front")
    edges = TransferFunction(
        [(EDGE - 1, 0, "#ffffff"), (EDGE + 1, 1, "#ffffff")],
        gradient_opacity=[(0, 0), (10, 1)],
        unit="raw",
    )
    with pytest.raises(MeshdepictError, match="transfer function of the CT number alone"):
        LiveVolume(bake_volume(blobs(), "lambert", transfer=edges).space, "lambert", view="front")
    monkeypatch.setattr(volume_shading, "_MOST", 10)
    with pytest.raises(MeshdepictError, match=r"takes 10 voxels, and .* are shown"):
        LiveVolume(space, "lambert", view="front")


def test_a_shader_that_fails_is_one_sentence(space, monkeypatch):
    broken = dataclasses.replace(look._METHODS["lambert"], glsl="vec3 shade() { oops }")
    monkeypatch.setitem(look._METHODS, "lambert", broken)
    live = LiveVolume(space, "lambert", view="front")
    with pytest.raises(MeshdepictError, match="lambert shading can't be shown live here: the shad"):
        live.check()


def test_nothing_of_the_space_changes(space):
    before = space.normals.copy(), space.shape.values.copy()
    LiveVolume(space, "exaggerated", view="front").check()
    assert (space.normals == before[0]).all()
    assert (space.shape.values == before[1]).all()
