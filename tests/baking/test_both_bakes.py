"""What bakes of meshes and of volumes promise alike: pictures, files, PyVista, windows."""

import inspect

import numpy as np
import pytest
from PIL import Image
from volume_shapes import SOLID, blobs

from meshdepict.baking.baked import Baked, Depiction
from meshdepict.baking.look import bake, bake_volume
from meshdepict.baking.volumes import BakedVolume
from meshdepict.drawing import volume_scene
from meshdepict.drawing.picture import save_picture
from meshdepict.drawing.picture_files import read_picture_provenance
from meshdepict.drawing.volume_picture import plot_volume, save_volume_picture
from meshdepict.errors import MeshdepictError
from meshdepict.scales.grid_making import sample_bytes
from meshdepict.scene.environment import Environment
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.volume import Volume
from meshdepict.viewer.windows import showing
from meshdepict.viewer.windows.reopened import session_of

pv = pytest.importorskip("pyvista")

LOOK = {"light": (30, 20), "view": "isometric", "scales": 2, "exaggeration": 25.0}


@pytest.fixture(scope="module")
def bakes(ball):
    return {
        "mesh": bake(ball, "exaggerated", **LOOK),
        "volume": bake_volume(blobs(), "exaggerated", transfer=SOLID, **LOOK),
    }


@pytest.fixture(params=["mesh", "volume"])
def baked(request, bakes):
    return bakes[request.param]


def test_who_knows_one_knows_the_other():
    for name in ("picture", "show", "save", "to_pyvista", "comments"):
        one, other = getattr(Baked, name), getattr(BakedVolume, name)
        if callable(one):
            assert inspect.signature(one) == inspect.signature(other)
    for kind in (Baked, BakedVolume):
        assert issubclass(kind, Depiction)


def test_both_say_how_they_came_about(baked):
    assert "meshdepict method: exaggerated" in baked.comments
    assert baked.look.method == "exaggerated"
    assert baked.look.options["exaggeration"] == 25
    assert list(baked.to_pyvista().field_data["meshdepict"]) == baked.comments


def test_pictures_take_the_same_words(baked, tmp_path):
    path = baked.picture(
        tmp_path / "a.png", size="3x2cm", dpi=100, background="#102030", scale_bar=True
    )
    with Image.open(path) as image:
        assert image.size == (118, 79)
        assert image.getpixel((0, 0)) == (16, 32, 48)
        assert image.info["dpi"] == pytest.approx((100, 100), abs=0.1)
    assert read_picture_provenance(path) == baked.comments
    save = save_picture if baked.shape.kind == "mesh" else save_volume_picture
    again = save(
        baked, tmp_path / "b.png", size="3x2cm", dpi=100, background="#102030", scale_bar=True
    )
    assert again.read_bytes() == path.read_bytes()
    large = baked.picture(tmp_path / "c.png", pixels_per_unit=40 / baked.shape.diagonal)
    with Image.open(large) as image:
        assert max(image.size) < 50


def test_wrong_pictures_are_refused_by_both(baked, tmp_path):
    for name, words, sentence in (
        ("a.tif", {}, r"end the name with \.png"),
        ("a.png", {"size": "big"}, "'big' is not WIDTHxHEIGHT"),
        ("a.png", {"background": "pnik"}, "did you mean 'pink'"),
    ):
        with pytest.raises(MeshdepictError, match=sentence):
            baked.picture(tmp_path / name, **words)
    assert not list(tmp_path.iterdir())


def test_the_unit_of_a_shape_is_on_its_scale_bar(ball, tmp_path):
    mesh = Mesh(ball.vertices, ball.faces, length_unit="mm")
    volume = blobs()
    volume = Volume(volume.values, spacing=volume.spacing, length_unit="mm")
    for baked in (bake(mesh, "lambert"), bake_volume(volume, "lambert", transfer=SOLID)):
        kind = baked.shape.kind
        pictures = {
            unit: baked.picture(tmp_path / f"{kind}-{unit}.png", scale_bar=True, unit=unit)
            for unit in ("", "mm", "cm")
        }
        assert pictures[""].read_bytes() == pictures["mm"].read_bytes()
        assert pictures[""].read_bytes() != pictures["cm"].read_bytes()


# --- show -------------------------------------------------------------------------------------


def test_show_with_keywords_is_a_plain_plot(baked, monkeypatch):
    drawn = []
    monkeypatch.setattr(
        pv.Plotter, "show", lambda plotter: drawn.append(plotter.screenshot(return_img=True))
    )
    baked.show(off_screen=True, window_size=(120, 90))
    assert drawn[0].shape == (90, 120, 3)
    assert (drawn[0] < 250).any()


def test_a_plain_plot_looks_as_the_picture(baked, tmp_path):
    plotter = showing._plot(baked, off_screen=True, window_size=(120, 120))
    shown = plotter.screenshot(return_img=True).astype(int)
    plotter.close()
    with Image.open(baked.picture(tmp_path / "a.png", size=(120, 120))) as image:
        drawn = np.asarray(image).astype(int)
    there = (drawn < 250).any(axis=2)
    assert 0.05 < there.mean() < 0.8
    # But for edges and fine relief: the picture of a mesh has nine samples in a pixel.
    assert ((shown < 250).any(axis=2) == there).mean() > 0.97
    assert np.median(np.abs(shown - drawn)[there]) <= (4 if baked.shape.kind == "mesh" else 1)


def test_a_plain_plot_needs_no_shader_of_this_program(bakes, monkeypatch):
    monkeypatch.setattr(volume_scene, "_LIGHT", "no GLSL")
    plotter = plot_volume(bakes["volume"], off_screen=True, window_size=(60, 60))
    assert (plotter.screenshot(return_img=True) < 250).any()
    plotter.close()


def test_show_opens_a_window_with_the_look_of_the_bake(baked, monkeypatch):
    opened = []
    monkeypatch.setattr(showing, "check_display", lambda: None)
    monkeypatch.setattr(showing.LitWindow, "run", lambda window: opened.append(window))
    window_on = showing.window_on
    monkeypatch.setattr(
        showing, "window_on", lambda session, **how: window_on(session, off_screen=True, **how)
    )
    baked.show(window_size=(200, 150))
    (window,) = opened
    window.finish()
    window.plotter.close()
    session = window.session
    assert window.name == baked.shape.kind
    assert session.method == "exaggerated"
    assert session.options["exaggeration"] == 25
    assert session.space is baked.space
    np.testing.assert_array_equal(session.baked().intensity, baked.intensity)
    session.look("back")
    session.shine((80, 10))
    assert baked.view.name == "isometric"
    assert session.baked().space is baked.space
    assert (session.baked().intensity != baked.intensity).any()


@pytest.mark.parametrize("how", ["slabs", "panorama", "no transfer function"])
def test_a_volume_that_cannot_be_lit_anew_is_shown_as_it_is(how, bakes, monkeypatch):
    if how == "slabs":
        memory = 400 * sample_bytes(2)
        baked = bake_volume(blobs(), "lambert", transfer=SOLID, memory=memory)
    elif how == "panorama":
        sky = Environment(np.ones((4, 8, 3)))
        baked = bake_volume(bakes["volume"].space, "phong", light=sky)
    else:
        from meshdepict.scales.grid_making import grid_space

        volume = blobs()
        space = grid_space(volume, np.zeros(1), 2.0, where=volume.values > 120)
        baked = bake_volume(space, "lambert")
    with pytest.raises(MeshdepictError, match=r"lit anew|turned by hand"):
        session_of(baked)
    shown = []
    monkeypatch.setattr(showing, "check_display", lambda: None)
    plot = showing._plot
    monkeypatch.setattr(showing, "_plot", lambda baked, window_size: plot(baked, off_screen=True))
    monkeypatch.setattr(pv.Plotter, "show", lambda plotter: shown.append(plotter))
    baked.show()
    (plotter,) = shown
    assert (plotter.screenshot(return_img=True) < 250).any()
    plotter.close()


def test_without_a_display_neither_opens(baked, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(MeshdepictError, match="there is no display"):
        baked.show()
