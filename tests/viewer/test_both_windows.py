"""What the windows on meshes and on volumes promise alike: who knows one knows the other."""

import signal

import numpy as np
import pytest
from PIL import Image

from meshdepict.baking.look import Look
from meshdepict.errors import MeshdepictError
from meshdepict.samples import ct_phantom
from meshdepict.viewer.controls import controls
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows import keys, volume_keys, window_events
from meshdepict.viewer.windows.camera import camera_view, same_sight
from meshdepict.viewer.windows.keys import POINTER, WELCOME, help_text
from meshdepict.viewer.windows.volume_session import VolumeSession
from meshdepict.viewer.windows.volume_window import VolumeWindow
from meshdepict.viewer.windows.window import Window

pytest.importorskip("pyvista")

SIZE = (500, 340)
WIDTH = round(SIZE[0] * 0.78)  # of the part that shows the object
TOP = slice(30, SIZE[1] * 3 // 4)  # below the message, above scale bar and axes


@pytest.fixture(scope="module")
def head():
    return ct_phantom((24, 24, 24))


@pytest.fixture(params=["mesh", "volume"])
def kind(request):
    return request.param


@pytest.fixture
def open_window(kind, ball, head, tmp_path):
    windows = []

    def open_window(method="exaggerated", **look):
        shape = ball if kind == "mesh" else head
        session = (Session if kind == "mesh" else VolumeSession)(shape, method, scales=2, **look)
        window = (Window if kind == "mesh" else VolumeWindow)(
            session, name="thing", folder=tmp_path, size=SIZE, off_screen=True, live=False
        )
        windows.append(window)
        return window

    yield open_window
    for window in windows:
        window.run(frames=0)


@pytest.fixture
def window(open_window):
    return open_window()


def picture(window):
    """What the window shows of the object, at rest: (h, w, 3)."""
    window.settle()
    return window.plotter.screenshot(return_img=True)[:, :WIDTH].astype(int)


# --- keys -------------------------------------------------------------------------------------


def test_the_same_keys_do_the_same_things():
    mesh, volume = ({s: key.action for key in k.KEYS for s in key.symbols}
                    for k in (keys, volume_keys))  # fmt: skip
    for symbol in mesh.keys() & volume.keys():
        assert mesh[symbol] == volume[symbol]
    assert {mesh[symbol] for symbol in set(mesh) - set(volume)} == {"texture"}
    assert {volume[symbol].partition("_")[0] for symbol in set(volume) - set(mesh)} == {
        "cut", "mend",
    }  # fmt: skip


def test_keys_change_and_the_window_says_so(window):
    window.actions.press("c")
    before = window.session.look_now()
    lines = window.scenery._lines.GetInput().splitlines()
    assert window.said == lines[0]
    window.actions.press("C")
    window.actions.press("c")
    assert window.scenery._lines.GetInput().splitlines() == lines
    assert window.session.look_now().words() == before.words()
    window.actions.press("o")
    assert window.said == "perspective"
    assert not window.camera.parallel_projection
    window.actions.press("l")
    assert window.session.light_fixed_to == "eye"


def test_what_to_press_is_on_screen_from_the_start_and_all_keys_on_h(window):
    assert window.scenery._welcome.GetInput() == WELCOME
    assert window.scenery._welcome.GetVisibility()
    assert not window.scenery._help.GetVisibility()
    window.actions.press("h")
    assert window.scenery._help.GetVisibility()
    text = window.scenery._help.GetInput()
    for words in (*help_text(window.actions.keys)[1].splitlines(), *(does for _, does in POINTER)):
        assert words in text


def test_bare_is_the_object_alone(window):
    window.actions.press("b")
    assert window.picture_size == SIZE
    scenery = window.scenery
    for part in (scenery._welcome, scenery._message, scenery._ruler._actor):
        assert not part.GetVisibility()
    window.actions.press("b")
    assert window.picture_size == (WIDTH, SIZE[1])


# --- what stands round the object -------------------------------------------------------------


def test_the_title_has_the_name(window):
    assert window.plotter.render_window.GetWindowName() == "thing - meshdepict"


def test_a_window_without_a_name_is_called_by_its_kind(kind, ball, head):
    session = Session(ball, "lambert") if kind == "mesh" else VolumeSession(head, "lambert")
    made = (Window if kind == "mesh" else VolumeWindow)(session, size=SIZE, off_screen=True)
    assert made.name == kind
    made.run(frames=0)


def test_the_panel_has_a_control_for_every_option(open_window):
    window = open_window("radiance_scaling")
    known = {control.name for control in controls("radiance_scaling") if control.kind != "text"}
    panel, found = window.scenery.panel, set()
    for _ in range(3):
        found |= set(panel.names)
        window.actions.press("Tab")
    assert found == known
    number = [control.name for control, _ in panel._lists].index("curvature") + 1
    window.actions.press(str(number))
    assert window.session.options["curvature"] == "view"


def test_sliders_shade_anew(window):
    before = picture(window)
    window.scenery.panel.slide("exaggeration", 60)
    assert window.session.options == {"exaggeration": 60}
    assert np.abs(picture(window) - before)[TOP].max() > 10
    window._set("exaggeration", None)
    np.testing.assert_allclose(picture(window)[TOP], before[TOP], atol=1)


def test_the_scale_bar_is_as_long_as_it_says_in_the_shape_s_unit(window, kind):
    for zoom in (1.0, 3.7, 0.2):
        window.camera.parallel_scale *= zoom
        window.draw()
        ruler = window.scenery._ruler
        left, right, *_ = ruler._bar.bounds
        length, unit = ruler._label.GetInput().split()
        scale = camera_view(window.camera, window.session.shape).parallel_scale
        per_pixel = 2 * scale / SIZE[1]
        assert (right - left) * per_pixel == pytest.approx(float(length), abs=per_pixel)
        assert unit == "mm" if kind == "volume" else unit.startswith("unit")


def test_axes_and_the_light_are_shown_as_the_eye_sees_them(window):
    assert window.plotter.renderer.axes_enabled
    towards = camera_view(window.camera, window.session.shape).towards_eye
    eye = np.array(window.scenery.gizmo.renderer.GetActiveCamera().GetPosition())
    np.testing.assert_allclose(eye / np.linalg.norm(eye), towards, atol=1e-9)
    before = window.scenery._lines.GetInput()
    window.actions.press("Right")
    window.settle()
    assert "light: azimuth" in before
    assert window.scenery._lines.GetInput() != before


# --- before and after -------------------------------------------------------------------------


def test_the_wipe_parts_before_and_after(window):
    after = picture(window)
    window.actions.press("w")
    half, middle = picture(window), WIDTH // 2
    np.testing.assert_allclose(half[TOP, middle + 6 :], after[TOP, middle + 6 :], atol=1)
    assert np.abs(half[TOP, : middle - 6] - after[TOP, : middle - 6]).max() > 20
    window.take("wipe", (middle, 100))
    window.drag((WIDTH - 1, 100))
    window.let_go()
    before = picture(window)
    np.testing.assert_allclose(half[TOP, : middle - 6], before[TOP, : middle - 6], atol=1)
    assert window.grip((WIDTH - 1, 50)) == "wipe"
    assert window.grip((middle, 50)) is None
    for _ in range(3):
        window.actions.press("bracketleft")
    assert window.scenery.wipe.place == pytest.approx(1 - 1 / WIDTH - 0.06)
    window.actions.press("w")
    np.testing.assert_allclose(picture(window)[TOP], after[TOP], atol=1)


# --- the eye ----------------------------------------------------------------------------------


def test_flying_looks_at_the_point_under_the_pointer(window):
    shape, eye = window.session.shape, camera_view(window.camera, window.session.shape)
    at = (WIDTH // 2 + 20, SIZE[1] // 2 + 30)
    window.plotter.iren.interactor.SetEventInformation(*at, 0, 0, "f", 0, "f")
    window.actions.press("f")
    there = camera_view(window.camera, shape)
    np.testing.assert_allclose(there.towards_eye, eye.towards_eye, atol=1e-9)
    pixel = 2 * eye.parallel_scale / SIZE[1]
    shift = (there.focus - eye.focus) @ eye.frame.T
    np.testing.assert_allclose(shift[:2], np.array([20, 30]) * pixel, atol=1.5 * pixel)
    assert 0 < shift[2] < shape.diagonal / 2  # on the side that is seen
    window.plotter.iren.interactor.SetEventInformation(2, 2, 0, 0, "f", 0, "f")
    window.actions.press("f")
    assert "there is none" in window.said


def test_reset_goes_back_to_the_beginning(window):
    before, eye = picture(window), camera_view(window.camera, window.session.shape)
    for symbol in ("c", "m", "w", "l", "Right", "v"):
        window.actions.press(symbol)
    window.actions.press("r")
    assert same_sight(camera_view(window.camera, window.session.shape), eye, window.session.shape)
    assert not window.scenery.wipe.on
    assert window.session.light_fixed_to == "object"
    np.testing.assert_allclose(picture(window)[TOP], before[TOP], atol=1)


# --- what is taken away -----------------------------------------------------------------------


def test_a_recipe_bakes_what_the_window_shows(window, tmp_path):
    window.session.set(exaggeration=31.0)
    for symbol in ("Right", "Up", "t", "s"):
        window.actions.press(symbol)
    look = Look.load(tmp_path / "thing-exaggerated.toml")
    baked = look.bake(window.session.shape)
    shown = window.session.baked()
    np.testing.assert_array_equal(baked.intensity, shown.intensity)
    path = baked.picture(tmp_path / "again.png", size=window.picture_size)
    with Image.open(path) as one, Image.open(tmp_path / "thing-exaggerated.png") as two:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(two))


def test_files_get_the_name_and_replace_nothing(window, kind, tmp_path):
    for _ in range(2):
        for symbol in ("s", "a", "t"):
            window.actions.press(symbol)
    own = ".ply" if kind == "mesh" else ".vti"
    names = {f"thing-exaggerated{n}{s}" for n in ("", "-2") for s in (".png", ".toml", own)}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert window.said == "saved thing-exaggerated-2.toml"


def test_a_folder_that_cannot_be_written_is_said(window, tmp_path):
    window.folder = tmp_path / "nowhere"
    for symbol in ("t", "s", "a"):
        window.actions.press(symbol)
        assert "nowhere" in window.said


# --- motion and the end -----------------------------------------------------------------------


def test_frames_that_are_late_are_left_out(window, monkeypatch):
    window.turn_light(0.1, 0)
    drawn = []
    monkeypatch.setattr(window, "draw", lambda **how: drawn.append(how))
    window._took = 100.0
    window.turn_light(0.1, 0)
    window.camera_moved()
    assert drawn == []
    assert window._due is not None
    window._due = 0.0
    window.tick()
    assert drawn == [{}]


def test_what_cannot_be_shaded_is_said_and_taken_back(open_window):
    window = open_window("light_warping")
    before = window.session.baked().intensity
    window._set("scale", 7)
    window.settle()
    assert "scale=7" in window.said
    np.testing.assert_array_equal(window.session.baked().intensity, before)


def test_smoothing_is_announced(open_window, monkeypatch):
    window, told = open_window("lambert"), []
    update = window.scenery.update
    monkeypatch.setattr(
        window.scenery, "update", lambda said, why: (told.append(said), update(said, why))
    )
    window.session._spaces.clear()
    if hasattr(window.session, "_grids"):
        window.session._grids.clear()
    window.pace.drawing = 0.01
    window.session.use("exaggerated")
    window.object.touch()
    window.settle()
    assert told[0].startswith("smoothing normals: ")
    assert told[-1] == ""


def test_a_fault_ends_the_window_and_is_raised(window):
    window.fault = ZeroDivisionError()
    with pytest.raises(ZeroDivisionError):
        window.run(frames=1)
    window.fault = None


def test_a_sentence_in_an_event_is_shown(window, monkeypatch):
    def refused(*_):
        raise MeshdepictError("the light is out")

    monkeypatch.setattr(window, "turn_light", refused)
    interactor = window.plotter.iren.interactor
    interactor.SetEventInformation(100, 100, 0, 0, "\0", 0, None)
    interactor.InvokeEvent("RightButtonPressEvent")
    interactor.SetEventInformation(130, 120, 0, 0, "\0", 0, None)
    interactor.InvokeEvent("MouseMoveEvent")
    assert window.said == "the light is out"


def test_control_c_ends_the_window(window, monkeypatch):
    monkeypatch.setattr(window_events, "check_display", lambda plotter: None)
    usual = signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(window.plotter.iren, "start", lambda: signal.raise_signal(signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        window.run()
    assert signal.getsignal(signal.SIGINT) is usual
    window.fault = None
