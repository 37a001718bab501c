"""The window off screen: events go in as a window system sends them, pictures come out."""

import sys

import numpy as np
import pytest

from meshdepict import bake
from meshdepict.baking.recipe import load_recipe
from meshdepict.drawing import display
from meshdepict.errors import MeshdepictError
from meshdepict.shading import METHODS
from meshdepict.shapes.mesh import Mesh
from meshdepict.viewer.live.live_shading import LiveShading
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows import preview as preview_module
from meshdepict.viewer.windows.camera import camera_view, same_sight
from meshdepict.viewer.windows.keys import KEYS
from meshdepict.viewer.windows.window import Window

pytest.importorskip("pyvista")

SIZE = (640, 430)
WIDTH = round(SIZE[0] * 0.78)  # of the part that shows the object


@pytest.fixture
def session(ball):
    return Session(ball, "lambert", scales=2)


@pytest.fixture
def open_window(tmp_path):
    windows = []

    def open_window(session, **given):
        windows.append(
            Window(session, name="ball", folder=tmp_path, size=SIZE, off_screen=True, **given)
        )
        return windows[-1]

    yield open_window
    for window in windows:
        window.run(frames=0)


@pytest.fixture
def window(open_window, session):
    return open_window(session, live=False)


class Hand:
    """Sends what a window system sends."""

    def __init__(self, window):
        self.interactor = window.plotter.iren.interactor

    def key(self, symbol, *, at=(5, 5)):
        self.interactor.SetEventInformation(*at, 0, 0, symbol[0], 0, symbol)
        for event in ("KeyPressEvent", "CharEvent", "KeyReleaseEvent"):
            self.interactor.InvokeEvent(event)

    def drag(self, start, end, *, button="Left", control=0):
        self.interactor.SetEventInformation(*start, control, 0, "\0", 0, None)
        self.interactor.InvokeEvent("MouseMoveEvent")
        self.interactor.InvokeEvent(f"{button}ButtonPressEvent")
        for share in (0.5, 1):
            at = [round(a + share * (b - a)) for a, b in zip(start, end, strict=True)]
            self.interactor.SetEventInformation(*at, control, 0, "\0", 0, None)
            self.interactor.InvokeEvent("MouseMoveEvent")
        self.interactor.InvokeEvent(f"{button}ButtonReleaseEvent")


@pytest.fixture
def hand(window):
    return Hand(window)


def picture(window, *, rest=True):
    """What the window shows of the object: (h, w, 3)."""
    if rest:
        window.settle()
    image = window.plotter.screenshot(return_img=True)
    return image[:, :WIDTH].astype(int)


def moved(window):
    """Where the camera is now."""
    return camera_view(window.camera, window.session.shape)


# --- what is shown --------------------------------------------------------------------------


def test_the_window_shows_the_colours_of_the_bake(window, session):
    window.scenery.bare = True
    window.draw()
    window.plotter.renderer.axes_widget.EnabledOff()
    window.plotter.render_window.SetMultiSamples(0)
    window.plotter.render_window.Render()
    image = window.plotter.screenshot(return_img=True)
    shown = np.unique(image[..., 0][(image != 255).any(axis=2)])
    assert shown.max() <= session.colors.max()
    assert shown.min() >= session.colors.min()
    assert len(shown) > 100  # a ball has most of the grey levels


def test_the_window_begins_with_a_parallel_view_that_shows_all(window):
    assert window.camera.parallel_projection
    image = picture(window)
    hit = (image < 250).any(axis=2)
    assert not hit[:, 0].any()
    assert not hit[0].any()


def test_a_mesh_without_faces_is_refused_before_a_window_opens():
    with pytest.raises(MeshdepictError, match="face"):
        Window(Session(Mesh(np.eye(3), np.empty((0, 3), int))), off_screen=True)


# --- the pointer ----------------------------------------------------------------------------


@pytest.mark.parametrize(("button", "control"), [("Right", 0), ("Left", 1)])
def test_a_drag_with_control_or_the_right_button_turns_the_light(
    window, hand, session, button, control
):
    eye, light, before = moved(window), session.light, picture(window)
    hand.drag((200, 200), (286, 200), button=button, control=control)
    # 86 of 430 pixels: a fifth of half a turn to the right, about the view's up
    expected = Session(session.shape, "lambert")
    expected.drag_light((0.1, 0))
    expected.drag_light((0.1, 0))
    np.testing.assert_allclose(session.light.direction, expected.light.direction, atol=1e-12)
    assert not np.array_equal(session.light.direction, light.direction)
    assert same_sight(moved(window), eye, session.shape)
    assert np.abs(picture(window) - before).max() > 50


def test_a_plain_drag_turns_the_object_and_not_the_light(window, hand, session):
    eye, light = moved(window), session.light
    hand.drag((200, 200), (260, 230))
    assert not same_sight(moved(window), eye, session.shape)
    assert session.light is light
    window.settle()
    assert same_sight(session.view, moved(window), session.shape)


def test_a_timer_moves_nothing_while_the_pointer_holds_the_object(window, hand, session):
    at = hand.interactor.SetEventInformation
    at(200, 200, 0, 0, "\0", 0, None)
    hand.interactor.InvokeEvent("LeftButtonPressEvent")
    at(230, 200, 0, 0, "\0", 0, None)
    hand.interactor.InvokeEvent("MouseMoveEvent")
    eye = moved(window)
    hand.interactor.InvokeEvent("TimerEvent")
    assert same_sight(moved(window), eye, session.shape)
    hand.interactor.InvokeEvent("LeftButtonReleaseEvent")


def test_after_a_drag_the_pointer_holds_nothing(window, hand, session):
    hand.drag((200, 200), (260, 230), button="Right")
    light = session.light
    hand.interactor.SetEventInformation(300, 300, 0, 0, "\0", 0, None)
    hand.interactor.InvokeEvent("MouseMoveEvent")
    assert session.light is light


def test_a_light_fixed_to_the_eye_goes_with_the_camera(window, hand, session):
    hand.key("l")
    before = session.light.direction @ session.view.frame.T
    hand.drag((200, 200), (300, 240))
    window.settle()
    np.testing.assert_allclose(session.light.direction @ session.view.frame.T, before, atol=1e-9)
    hand.key("l")
    light = session.light
    hand.drag((200, 200), (300, 240))
    window.settle()
    assert session.light is light


def test_methods_that_see_follow_the_camera_when_it_stops(window, hand, session):
    session.use("phong")
    window.object.touch()
    window.settle()
    before = session.colors
    hand.drag((200, 200), (300, 240))
    window.settle()
    np.testing.assert_array_equal(
        session.colors,
        bake(session.space, "phong", light=session.light, view=moved(window)).colors,
    )
    assert not np.array_equal(session.colors, before)


def test_the_whole_picture_comes_when_the_hand_rests(window, hand, monkeypatch):
    hand.drag((200, 200), (260, 230), button="Right")
    drawn = []
    monkeypatch.setattr(window, "draw", lambda **how: drawn.append(how))
    hand.interactor.InvokeEvent("TimerEvent")  # too soon
    assert drawn == []
    window._due -= 1
    hand.interactor.InvokeEvent("TimerEvent")
    hand.interactor.InvokeEvent("TimerEvent")
    assert drawn == [{}]


# --- keys -----------------------------------------------------------------------------------


def test_every_key_has_an_action(window, tmp_path):
    for key in KEYS:
        if "method" not in key.action and key.action != "close":
            window.actions.press(key.symbols[0])
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["ball-lambert.ply", "ball-lambert.png", "ball-lambert.toml"]


def test_keys_of_vtk_and_pyvista_do_nothing_of_theirs(window, hand):
    mesh = next(iter(window.object._meshes.values()))
    eye = moved(window)
    for symbol in ("w", "w", "s", "p", "u", "j", "3", "plus", "minus"):
        hand.key(symbol)
    assert mesh.actor.GetProperty().GetRepresentationAsString() == "Surface"
    assert mesh.actor.GetProperty().GetPointSize() == 1
    assert same_sight(moved(window), eye, window.session.shape)


def test_an_unknown_key_gets_a_hint(window, hand):
    hand.key("x")
    assert window.said == "x does nothing here: h shows the keys"
    hand.key("h")
    assert window.said == ""
    assert window.scenery.helping


def test_methods_go_round_and_the_panel_follows(window, hand, session):
    names = list(METHODS)
    start = names.index("lambert")
    hand.key("m")
    assert session.method == names[(start + 1) % len(names)]
    hand.key("M")
    assert session.method == "lambert"
    assert {*window.scenery.panel.names} == {"exposure", "shadows", "bounces", "rays", "denoise"}


def test_colour_maps_and_views_go_round(window, hand, session):
    before = picture(window)
    hand.key("c")
    assert session.colormap == "sepia"
    assert np.ptp(picture(window), axis=2).mean() > np.ptp(before, axis=2).mean() + 5
    hand.key("C")
    assert session.colormap is None
    hand.key("v")
    assert session.view.name == "back"
    assert same_sight(moved(window), window._seen, session.shape)


def test_reset_goes_back_to_the_beginning(window, hand, session):
    before, eye = picture(window), moved(window)
    hand.drag((200, 200), (260, 230), button="Right")
    hand.drag((200, 200), (260, 230))
    for symbol in ("c", "m", "w", "l"):
        hand.key(symbol)
    hand.key("r")
    hand.key("h")
    hand.key("h")  # the message goes
    assert same_sight(moved(window), eye, session.shape)
    np.testing.assert_array_equal(picture(window), before)


def test_arrows_turn_the_light_by_five_degrees(window, hand, session):
    before = session.light.direction
    hand.key("Right")
    session.light.direction @ before
    up = session.view.frame[1]
    flat = [v - (v @ up) * up for v in (before, session.light.direction)]
    cosine = flat[0] @ flat[1] / np.linalg.norm(flat[0]) / np.linalg.norm(flat[1])
    assert np.degrees(np.arccos(cosine)) == pytest.approx(5, abs=1e-6)


def test_flying_looks_at_the_point_under_the_pointer(window, hand, session):
    eye = moved(window)
    hand.key("f", at=(WIDTH // 2 + 60, SIZE[1] // 2 + 40))
    there = moved(window)
    np.testing.assert_allclose(there.towards_eye, eye.towards_eye, atol=1e-9)
    assert np.linalg.norm(there.focus - session.shape.centre) == pytest.approx(1, abs=0.08)
    shift = (there.focus - eye.focus) @ eye.frame.T
    pixel = 2 * eye.parallel_scale / SIZE[1]
    np.testing.assert_allclose(shift[:2], np.array([60, 40]) * pixel, atol=1.5 * pixel)
    hand.key("f", at=(2, 2))
    assert "there is none" in window.said


def test_perspective_has_no_scale_bar(window, hand):
    assert window.scenery._ruler._actor.GetVisibility()
    hand.key("o")
    assert not window.camera.parallel_projection
    assert not window.scenery._ruler._actor.GetVisibility()


# --- options --------------------------------------------------------------------------------


def test_sliders_set_options_and_show_them(window, session):
    panel = window.scenery.panel
    panel.slide("exposure", 1.23456)
    assert session.options == {"exposure": 1.235}
    window.draw()
    widget, number = next((w, n) for c, w, _, n in panel._sliders if c.name == "exposure")
    assert number.GetInput() == "1.235"
    assert widget.GetRepresentation().GetValue() == pytest.approx(1.235)
    with pytest.raises(KeyError):
        panel.slide("exageration", 1)


def test_a_slider_is_dragged_with_the_pointer(window, hand, session):
    named = {control.name: widget for control, widget, *_ in window.scenery.panel._sliders}
    slider = named["exposure"].GetRepresentation()
    ends = slider.GetPoint1Coordinate(), slider.GetPoint2Coordinate()
    a, b = (end.GetComputedDisplayValue(window.scenery._sheet) for end in ends)
    start = (round(a[0] + 0.25 * (b[0] - a[0])), a[1])
    hand.drag(start, (round(a[0] + 0.75 * (b[0] - a[0])), a[1]))
    assert session.options["exposure"] == pytest.approx(3, abs=0.15)


def test_lists_go_round_by_digits(open_window, ball):
    session = Session(ball, "radiance_scaling", scales=2)
    window = open_window(session, live=False)
    panel = window.scenery.panel
    number = [control.name for control, _ in panel._lists].index("curvature") + 1
    window.actions.press(str(number))
    assert session.options["curvature"] == "view"
    window.actions.press("6")
    assert "has no list 6" in window.said
    assert len(panel._sliders) == 6
    first = panel.names
    window.actions.press("Tab")
    assert panel.names[0] not in first


def test_what_cannot_be_shaded_is_said_and_taken_back(open_window, ball):
    session = Session(ball, "light_warping", scales=1)
    window = open_window(session, live=False)
    colors = session.colors
    window._set("scale", 7)
    window.settle()
    assert "scale=7" in window.said
    np.testing.assert_array_equal(session.colors, colors)


# --- before and after -----------------------------------------------------------------------


def test_the_wipe_parts_before_and_after(open_window, ball):
    session = Session(ball, "exaggerated", scales=2)
    window = open_window(session, live=False)
    after = picture(window)
    session.use("lambert")
    window.object.touch()
    before = picture(window)
    session.use("exaggerated")
    window.object.touch()
    hand = Hand(window)
    hand.key("w")
    middle, half = WIDTH // 2, picture(window)
    top = slice(0, SIZE[1] * 3 // 4)  # above scale bar and axes
    np.testing.assert_array_equal(half[top, : middle - 4], before[top, : middle - 4])
    np.testing.assert_array_equal(half[top, middle + 4 :], after[top, middle + 4 :])
    hand.drag((middle, 200), (middle + 100, 210))
    assert window.scenery.wipe.place == pytest.approx((middle + 100) / WIDTH)
    moved_half = picture(window)
    np.testing.assert_array_equal(moved_half[top, : middle + 96], before[top, : middle + 96])
    hand.key("bracketleft")
    assert window.scenery.wipe.place < (middle + 100) / WIDTH
    hand.key("w")
    np.testing.assert_array_equal(picture(window), after)


def test_before_is_the_colours_of_the_mesh_where_it_has_some(open_window, ball):
    red = np.full(len(ball.vertices), 200, np.uint8)
    own = {"vertex": {"red": red, "green": red // 4, "blue": red // 8}}
    mesh = Mesh(ball.vertices, ball.faces, attributes=own)
    window = open_window(Session(mesh, "lambert"), live=False)
    window.actions.press("w")
    image = picture(window)
    np.testing.assert_array_equal(image[SIZE[1] // 2, WIDTH // 4], [200, 50, 25])


# --- big meshes -----------------------------------------------------------------------------


@pytest.fixture
def slow_window(open_window, monkeypatch, ball):
    """A window that thinks its mesh big and its frames slow."""
    monkeypatch.setattr(preview_module.Proxy, "worth", staticmethod(lambda shape: True))
    monkeypatch.setattr(preview_module.Proxy.__init__, "__kwdefaults__", {"most": 900})
    window = open_window(Session(ball, "lambert"), live=False)
    window.pace.drawing, window._took = 1.0, 0.0
    return window


def test_a_big_mesh_moves_as_a_stand_in_and_rests_as_a_whole(slow_window):
    window = slow_window
    before = picture(window)
    window.pace.drawing, window._took = 1.0, 0.0
    window.turn_light(0.2, 0)
    visible = {key for key, mesh in window.object._meshes.items() if mesh.actor.GetVisibility()}
    assert visible == {("coarse", "now")}
    coarse = picture(window, rest=False)
    whole = picture(window)
    visible = {key for key, mesh in window.object._meshes.items() if mesh.actor.GetVisibility()}
    assert visible == {("whole", "now")}
    # The stand-in is nearer to what comes than what was before.
    assert np.abs(coarse - whole).mean() < 0.5 * np.abs(before - whole).mean()


def test_frames_that_are_late_are_left_out(slow_window, monkeypatch):
    window = slow_window
    drawn = []
    monkeypatch.setattr(window, "draw", lambda **how: drawn.append(how))
    window._took = 100.0
    window.turn_light(0.1, 0)
    assert drawn == []
    assert window._due is not None
    window._took = 0.0
    window.turn_light(0.1, 0)
    assert drawn == [{"coarse": True, "fresh": True, "moving": True}]


def test_slow_shading_of_small_meshes_waits_for_rest(window, session):
    picture(window)
    window.pace.shading, window._took = 1.0, 0.0
    window.turn_light(0.3, 0)
    assert ("whole", "now") in window.object._stale
    window.settle()
    assert ("whole", "now") not in window.object._stale


# --- shaded by the card ---------------------------------------------------------------------


def test_live_shading_shows_what_baking_shows(open_window, ball):
    pytest.importorskip("meshdepict.viewer.live")
    shown = {}
    for live in (False, True):
        session = Session(ball, "exaggerated", scales=2)
        window = open_window(session, live=live)
        window.turn_light(0.2, 0.1)
        window._set("exaggeration", 25)
        shown[live] = picture(window)
        assert (window.object.why_baked == "") == live
    top = slice(0, SIZE[1] * 3 // 4)
    difference = np.abs(shown[False] - shown[True])[top]
    assert np.percentile(difference, 99) <= 3


def test_what_the_card_cannot_shade_is_baked_and_said(open_window, ball):
    pytest.importorskip("meshdepict.viewer.live")
    window = open_window(Session(ball, "toon"), live=True)
    assert "toon" in window.object.why_baked
    assert "shaded by the processor" in window.scenery._lines.GetInput()


# --- what is taken away ---------------------------------------------------------------------


def test_a_recipe_from_the_window_bakes_what_it_shows(window, hand, session, tmp_path):
    from PIL import Image

    hand.drag((200, 200), (260, 230))
    hand.drag((200, 200), (240, 180), button="Right")
    window.settle()
    hand.key("t")
    hand.key("s")
    baked = bake(session.shape, **load_recipe(tmp_path / "ball-lambert.toml"))
    np.testing.assert_array_equal(baked.colors, session.colors)
    path = baked.picture(tmp_path / "baked.png", size=window.scenery.picture_size)
    with Image.open(path) as one, Image.open(tmp_path / "ball-lambert.png") as two:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(two))
        window.scenery.bare = False
        image = picture(window)
        top = slice(0, SIZE[1] * 3 // 4)
        inner = (image < 250).all(axis=2)[top]
        off = np.abs(image[top] - np.asarray(one).astype(int)[top])[inner]
        assert np.percentile(off, 95) <= 6  # but for how edges are smoothed


def test_a_folder_that_cannot_be_written_is_said(window, hand, tmp_path):
    window.folder = tmp_path / "nowhere"
    hand.key("t")
    assert "nowhere" in window.said


def test_several_lights_have_no_recipe_and_that_is_said(open_window, ball):
    window = open_window(Session(ball, "phong", light=["north", "east"]), live=False)
    window.actions.press("t")
    assert "recipe can't hold light" in window.said


# --- its end --------------------------------------------------------------------------------


def test_a_fault_ends_the_window_and_is_raised(ball, monkeypatch):
    window = Window(Session(ball, "lambert"), size=SIZE, off_screen=True, live=False)

    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr(window, "tick", interrupted)
    window.plotter.iren.interactor.InvokeEvent("TimerEvent")
    with pytest.raises(KeyboardInterrupt):
        window.run(frames=1)


def test_smoothing_is_announced_and_the_words_go_when_it_is_done(window, session, monkeypatch):
    told = []
    update = window.scenery.update
    monkeypatch.setattr(
        window.scenery, "update", lambda said, why: (told.append(said), update(said, why))
    )
    window.pace.drawing = 0.01
    session.use("exaggerated")
    window.object.touch()
    window.settle()
    assert told[0].startswith("smoothing normals: ")
    assert told[-1] == ""


def test_a_sentence_in_an_event_is_shown(window, hand, monkeypatch):
    def refused(*_):
        raise MeshdepictError("the light is out")

    monkeypatch.setattr(window, "turn_light", refused)
    hand.drag((200, 200), (260, 230), button="Right")
    assert window.said == "the light is out"


def test_without_a_display_a_sentence_says_what_to_do(monkeypatch, session):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(MeshdepictError, match=r"DISPLAY is not set.*--browser.*apt install xvfb"):
        display.check_display()
    with pytest.raises(MeshdepictError, match="no display"):
        bake(session.shape, "lambert").show()
    monkeypatch.setenv("DISPLAY", ":9999")
    display.check_display()
    window = Window(session, size=SIZE, off_screen=True, live=False)
    with pytest.raises(MeshdepictError, match=":9999 can't be reached"):
        window.run()
    monkeypatch.setattr(sys, "platform", "darwin")
    display.check_display()


def test_without_opengl_a_sentence_names_the_packages(monkeypatch):
    class Plotter:
        closed = False

        class render_window:
            @staticmethod
            def GetClassName():
                return "vtkOSOpenGLRenderWindow"

        def close(self):
            self.closed = True

    plotter = Plotter()
    monkeypatch.setattr(display, "_OSMESA", ("libno-such-thing.so",))
    with pytest.raises(MeshdepictError, match="apt install libegl1 libgl1-mesa-dri"):
        display.check_opengl(plotter)
    assert plotter.closed
    monkeypatch.setattr(display, "_OSMESA", ("libc.so.6",))
    if sys.platform == "linux":
        display.check_opengl(plotter)


def test_show_with_keywords_is_a_plain_plot(session):
    baked = bake(session.shape, "lambert")
    assert baked.show(off_screen=True, window_size=(200, 200)) is None


def test_shadows_and_bounces_are_painted_as_the_light_moves(ball, open_window, monkeypatch):
    made = []
    monkeypatch.setattr(LiveShading, "_made", lambda self, space: made.append(space))
    session = Session(ball, "lambert", shadows=True, bounces=2, rays=16)
    window = open_window(session, live=True)
    assert "shadows=True" in window.object.why_baked
    before = picture(window)
    for shading in (0.0, 2 * window.pace.budget, 0.0):
        window.pace.shading, window._took = shading, 0.0
        window.turn_light(0.2, 0)
        assert ("whole", "now") not in window.object._stale  # no need to wait for a rest
    assert np.abs(picture(window, rest=False).astype(float) - before).mean() > 1
    assert made == []  # no frame makes what can't be shown
