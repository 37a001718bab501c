"""The window on a volume, off screen: light, keys, slices, files, and the session behind it."""

import numpy as np
import pytest
from volume_shapes import SOLID, WHITE, blobs

from meshdepict.baking.look import bake_volume
from meshdepict.color.transfer import PRESETS, TransferFunction
from meshdepict.drawing import volume_scene
from meshdepict.drawing.picture_files import read_picture_provenance
from meshdepict.errors import MeshdepictError
from meshdepict.io.volumes import read_volume
from meshdepict.samples import ct_phantom
from meshdepict.viewer.windows.clipping_box import ClippingBox
from meshdepict.viewer.windows.keys import action_of, help_text
from meshdepict.viewer.windows.volume_keys import KEYS
from meshdepict.viewer.windows.volume_session import VolumeSession
from meshdepict.viewer.windows.volume_window import VolumeWindow, show_volume

pytest.importorskip("pyvista")


@pytest.fixture(scope="module")
def head():
    return ct_phantom((24, 24, 24))


@pytest.fixture
def window(head, tmp_path):
    session = VolumeSession(head, scales=2)
    made = VolumeWindow(session, folder=tmp_path, size=(200, 180), off_screen=True)
    yield made
    made.plotter.close()


def seen(window):
    return window.plotter.screenshot(return_img=True).astype(int)[40:140, 30:160]


# --- the session ------------------------------------------------------------------------------


def test_a_new_light_smooths_nothing(head, monkeypatch):
    session = VolumeSession(head, scales=2)
    session.baked()
    monkeypatch.setattr("meshdepict.baking.volumes.space_of_mask", None)
    before = session.baked()
    session.drag_light((0.2, 0.1))
    assert session.baked().space is before.space
    assert (session.baked().intensity != before.intensity).any()
    session.use("lambert")  # whose scales are among those there
    assert session.baked().space is before.space


def test_transfer_functions_and_methods_keep_their_normals(head):
    session = VolumeSession(head, scales=1)
    bone = session.baked().space
    session.show("skin")
    assert session.baked().space is not bone
    assert session.baked().space.transfer.name == "skin"
    session.show("bone")
    assert session.baked().space is bone


def test_a_bake_brings_all_along():
    baked = bake_volume(blobs(), "exaggerated", transfer=SOLID, scales=2, view="left")
    session = VolumeSession(baked, scales=2)
    assert session.view is baked.view
    assert session.transfer is SOLID
    assert session.space is baked.space
    again = bake_volume(baked.space, "exaggerated", view=baked.view)
    np.testing.assert_array_equal(session.baked().rgba, again.rgba)


def test_going_back_restores_the_transfer_function(head):
    session = VolumeSession(head, scales=1)
    session.show("skin")
    session.use("lambert")
    session.reset()
    assert session.transfer.name == "bone"
    assert session.method == "exaggerated"


def test_settings_make_the_same_bake():
    session = VolumeSession(blobs(), "exaggerated", transfer=WHITE, scales=2, emphasis=0.0)
    session.drag_light((0.1, 0.0))
    again = session.look_now().bake(session.shape)
    np.testing.assert_array_equal(again.rgba, session.baked().rgba)


def test_what_can_t_be_shaded_is_refused(head):
    with pytest.raises(MeshdepictError, match="did you mean 'exaggerated'"):
        VolumeSession(head, "exagerated")
    with pytest.raises(MeshdepictError, match="no transfer function is called 'bones'"):
        VolumeSession(head, transfer="bones")
    with pytest.raises(MeshdepictError, match="not a volume"):
        VolumeSession(3)


# --- the window -------------------------------------------------------------------------------


def test_a_drag_turns_the_light_and_a_rest_draws_all_pixels(window):
    before, light = seen(window), window.session.light
    window.take("light", (100, 90))
    assert window.drag((150, 120))
    assert window.let_go()
    assert not window.drag((0, 0))
    assert not window.let_go()
    assert (window.session.light.direction != light.direction).any()
    assert np.abs(seen(window) - before).max() > 20
    window._due = 0.0
    window.tick()
    assert window._due is None
    assert window.lit._pixels == 1


def test_while_something_moves_rays_are_fewer(window):
    window._took = 0.5
    window.draw(moving=True)
    assert 2 < window.lit._pixels <= 6
    window._took = 0.01
    window.draw(moving=True)
    assert window.lit._pixels == 1


def test_a_coarse_frame_is_like_a_whole_one(window):
    whole = seen(window)
    window.lit.coarsen(2.0)
    window.plotter.render_window.Render()
    assert np.abs(seen(window) - whole).mean() < 12


def test_every_key_does_something_and_none_fails(window):
    for key in KEYS:
        if key.action != "close":
            window.actions.press(key.symbols[0])
    window.actions.press("j")
    assert "does nothing here" in window.said
    window.actions.press("Shift_L")


def test_keys_change_method_preset_and_view(window):
    window.actions.press("p")
    assert window.session.transfer.name == PRESETS[1]
    window.actions.press("P")
    window.actions.press("m")
    assert window.session.method != "exaggerated"
    window.actions.press("M")
    assert window.session.method == "exaggerated"
    window.actions.press("v")
    assert window.session.view.name == "back"
    window.actions.press("r")
    assert window.session.view.name == "front"


def test_before_is_vtks_and_after_comes_back(window):
    after = seen(window)
    window.actions.press("w")
    assert np.abs(seen(window) - after).max() > 20
    window.actions.press("w")
    assert np.abs(seen(window) - after).max() <= 1


def test_what_shows_nothing_is_said_and_undone(window):
    before = seen(window)
    nothing = TransferFunction([(5000, 0, "#ffffff"), (6000, 1, "#ffffff")], name="nothing")
    window.session.show(nothing)
    window.draw()
    assert "no voxel of the volume is shown" in window.said
    assert window.session.transfer.name == "bone"
    assert np.abs(seen(window) - before)[20:].max() <= 1  # below the message


def test_slices_are_cut_off_on_the_side_that_faces_the_eye(window):
    whole = seen(window)
    for _ in range(6):
        window.actions.press("y")
    assert window.box.low[1] == pytest.approx(0.3)  # the face, as y runs to the back
    assert np.abs(seen(window) - whole).max() > 20
    for _ in range(6):
        window.actions.press("Y")
    assert not window.box.planes()
    assert np.abs(seen(window) - whole).max() <= 1


def test_a_light_on_the_eye_goes_along(window):
    window.actions.press("l")
    light = window.session.light.direction
    window.camera.azimuth += 30
    window.camera_moved()
    assert np.abs(window.session.light.direction - light).max() > 0.1
    window.actions.press("l")
    light = window.session.light.direction
    window.camera.azimuth += 30
    window.camera_moved()
    assert (window.session.light.direction == light).all()


def test_files_are_saved_and_none_is_replaced(window, tmp_path):
    for _ in range(2):
        window.actions.press("s")
        window.actions.press("a")
    pictures = sorted(path.name for path in tmp_path.glob("*.png"))
    assert pictures == ["volume-exaggerated-2.png", "volume-exaggerated.png"]
    assert len(list(tmp_path.glob("*.vti"))) == 2
    assert "meshdepict method: exaggerated" in read_picture_provenance(tmp_path / pictures[1])


def test_live_and_baked_look_alike(head, tmp_path):
    pictures = []
    for live in (False, True):
        made = VolumeWindow(
            VolumeSession(head, "lambert"), live=live, size=(200, 180), off_screen=True
        )
        assert bool(made.lit.why_baked) is not live
        made.turn_light(0.1, 0.2)
        made.settle()
        pictures.append(seen(made))
        made.actions.press("m")  # half_lambert and others may be live, or not: none fails
        made.plotter.close()
    assert np.percentile(np.abs(pictures[0] - pictures[1]), 98) <= 4


def test_what_can_t_be_live_is_baked(head):
    made = VolumeWindow(VolumeSession(head, "gooch"), live=True, size=(120, 100), off_screen=True)
    assert "'gooch' can't be shown live" in made.lit.why_baked
    made.turn_light(0.1, 0.0)
    made.actions.press("M")
    made.session.use("lambert")
    made.settle()
    assert made.lit.why_baked == ""
    made.plotter.close()


def test_without_shaders_there_are_colours_of_voxels(head, monkeypatch):
    monkeypatch.setattr(volume_scene, "_LIGHT", "no GLSL")
    made = VolumeWindow(
        VolumeSession(head, "lambert"), live=False, size=(200, 180), off_screen=True
    )
    before = seen(made)
    assert (before < 250).any()
    made.turn_light(0.3, 0.0)
    assert np.abs(seen(made) - before).max() > 20
    made.plotter.close()


def test_the_window_runs_for_some_frames_and_needs_a_display(head, monkeypatch):
    made = show_volume(head, "lambert", frames=2, size=(100, 90))
    assert made.session.method == "lambert"
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(MeshdepictError, match="there is no display"):
        show_volume(head, "lambert")


def test_a_saved_volume_can_be_opened(window, tmp_path):
    window.actions.press("a")
    with pytest.raises(MeshdepictError):  # RGBA: no CT numbers any more
        read_volume(next(tmp_path.glob("*.vti")))


# --- keys and the box ---------------------------------------------------------------------------


def test_help_says_every_key_once():
    keys, words = help_text(KEYS)
    assert keys.count("\n") == words.count("\n")
    symbols = [symbol for key in KEYS for symbol in key.symbols]
    assert len(symbols) == len(set(symbols))
    assert action_of("x", KEYS) == "cut_x"
    assert action_of("F12", KEYS) is None


def test_a_box_keeps_a_slice_and_gives_all_back(head):
    box = ClippingBox(head)
    for _ in range(19):
        box.cut(2, (0, 0, 1))
    with pytest.raises(MeshdepictError, match="but a slice left across z"):
        box.cut(2, (0, 0, 1))
    assert len(box.planes()) == 1
    box.cut(0, (-1, 0, 0))
    assert len(box.planes()) == 2
    box.mend(0, (1, 0, 0))  # seen from the other side, too
    assert len(box.planes()) == 1
    box.reset()
    assert not box.planes()
