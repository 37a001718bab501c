"""Attention by the pointer: the place that a method draws it to, in windows and on the page."""

import json

import numpy as np
import pytest
from chromium import tab  # noqa: F401
from test_browser import Page, Served, ball_file, served  # noqa: F401

from meshdepict import samples
from meshdepict.errors import MeshdepictError
from meshdepict.options import options_of
from meshdepict.scene.view import View
from meshdepict.shading import METHODS
from meshdepict.viewer.browser.desk import Desk
from meshdepict.viewer.controls import place_option
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.camera import camera_view
from meshdepict.viewer.windows.volume_session import VolumeSession
from meshdepict.viewer.windows.volume_window import VolumeWindow
from meshdepict.viewer.windows.window import Window

SIZE = (640, 430)
WIDTH = round(SIZE[0] * 0.78)  # of the part that shows the object
AT = (WIDTH // 2 + 60, SIZE[1] // 2 + 40)


@pytest.fixture
def opened(tmp_path):
    windows = []

    def opened(session, kind=Window, **given):
        windows.append(kind(session, folder=tmp_path, size=SIZE, off_screen=True, **given))
        return windows[-1]

    yield opened
    for window in windows:
        window.run(frames=0)


def press(window, *, at=AT, key="g"):
    window.plotter.iren.interactor.SetEventInformation(*at, 0, 0, key, 0, key)
    window.plotter.iren.interactor.InvokeEvent("KeyPressEvent")


def click(window, *, at=AT):
    interactor = window.plotter.iren.interactor
    interactor.SetEventInformation(*at, 0, 0, "\0", 0, None)
    interactor.SetAltKey(1)
    for event in ("LeftButtonPressEvent", "LeftButtonReleaseEvent"):
        interactor.InvokeEvent(event)
    interactor.SetAltKey(0)


def place_in_picture(window, point):
    """Pixels from the middle of the picture, and towards the eye in world units."""
    eye = camera_view(window.camera, window.session.shape)
    across = (np.asarray(point) - eye.focus) @ eye.frame.T
    return across[:2] / (2 * eye.parallel_scale / SIZE[1]), across[2]


# --- which methods --------------------------------------------------------------------------


def test_every_option_that_is_a_place_is_found():
    found = {name: place_option(name) for name in METHODS}
    assert {name: place for name, place in found.items() if place} == {
        "exaggerated": "focus", "light_warping": "importance", "view_curvature": "importance",
    }  # fmt: skip
    assert options_of(METHODS["exaggerated"])["focus"].accepts.place


def test_a_session_draws_attention_and_lifts_it_again(ball):
    session = Session(ball, "exaggerated", scales=2)
    plain = session.colors
    assert session.attend(np.array([0.0, 0.1, 1.0])) == "focus"
    assert session.options["focus"] == (0.0, 0.1, 1.0)
    assert (session.colors != plain).any()
    session.attend(None)
    np.testing.assert_array_equal(session.colors, plain)
    session.use("lambert")
    with pytest.raises(MeshdepictError, match=r"\(these do: exaggerated, light_warping, "):
        session.attend((0, 0, 1))


# --- windows --------------------------------------------------------------------------------


@pytest.mark.gpu
@pytest.mark.parametrize("live", [False, True])
@pytest.mark.parametrize("act", [press, click])
def test_the_point_under_the_pointer_is_the_focus(opened, ball, act, live):
    session = Session(ball, "exaggerated", scales=3)
    window = opened(session, live=live)
    window.settle()
    before = window.plotter.screenshot(return_img=True).astype(int)
    eye = camera_view(window.camera, ball)
    act(window)
    focus = np.array(session.options["focus"])
    pixels, _ = place_in_picture(window, focus)
    np.testing.assert_allclose(pixels, [60, 40], atol=1.5)
    # On the surface, on the side that is seen.
    assert np.linalg.norm(ball.vertices - focus, axis=1).min() < ball.edge_length
    assert focus @ eye.towards_eye > 0
    window.settle()
    assert np.abs(window.plotter.screenshot(return_img=True).astype(int) - before).max() > 20
    assert "focus: the point under the pointer" in window.said
    # Nothing else has moved, and beside the object attention is lifted.
    np.testing.assert_allclose(camera_view(window.camera, ball).position, eye.position)
    act(window, at=(3, 3))
    assert session.options["focus"] is None


@pytest.mark.gpu
def test_light_warping_takes_it_where_it_has_scales_to_choose_from(opened, ball):
    session = Session(ball, "light_warping", scales=4)
    window = opened(session, live=False)
    plain = session.colors
    click(window)
    pixels, _ = place_in_picture(
        window, [float(x) for x in session.options["importance"].split(",")]
    )
    np.testing.assert_allclose(pixels, [60, 40], atol=1.5)
    assert (session.colors != plain).any()
    alone = Session(ball, "light_warping")
    window = opened(alone, live=False)
    click(window)
    assert "make more with scales=5" in window.said
    assert alone.options.get("importance") is None


@pytest.mark.gpu
def test_other_methods_say_which_do(opened, ball):
    window = opened(Session(ball, "lambert"), live=False)
    for act in (press, click):
        act(window)
        assert "lambert draws no attention to a point" in window.said


@pytest.mark.gpu
def test_the_window_on_a_volume_does_so_too(opened):
    volume = samples.ct_phantom((32, 32, 32))
    session = VolumeSession(volume, "exaggerated", scales=2)
    window = opened(session, VolumeWindow)
    press(window, at=(WIDTH // 2, SIZE[1] // 2))
    pixels, _ = place_in_picture(window, session.options["focus"])
    np.testing.assert_allclose(pixels, [0, 0], atol=1.5)


# --- the page -------------------------------------------------------------------------------


def test_a_desk_takes_a_point_and_says_what_is_none(ball):
    session = Session(ball, "exaggerated", scales=2)
    desk = Desk(session, "ball")
    assert desk.look()["place"] == "focus"
    assert desk.apply([["attend", [0, 0, 1]]]) == ""
    assert session.options["focus"] == (0.0, 0.0, 1.0)
    for wrong in ([0, 1], [0, 1, "x"], [None, 1, 2], "here", 5):
        assert desk.apply([["attend", wrong]])
        assert session.options["focus"] == (0.0, 0.0, 1.0)
    assert desk.apply([["attend", None]]) == ""
    assert session.options["focus"] is None
    desk.apply([["method", "lambert"]])
    assert desk.look()["place"] == ""
    assert "draws no attention" in desk.apply([["attend", [0, 0, 1]]])


@pytest.fixture
def page(tab, served):  # noqa: F811
    page = Page(tab, served)
    yield page
    assert tab.errors == []
    page.click("reset")


def test_a_click_on_the_page_sets_the_focus(page, ball_file):  # noqa: F811
    from meshdepict.io import read_mesh

    mesh = read_mesh(ball_file)
    left, top, width, height = page.tab.js(
        "(b => [b.x, b.y, b.width, b.height])"
        "(document.querySelector('canvas').getBoundingClientRect())"
    )

    def alt_click(x, y):
        for kind, buttons in (("mousePressed", 1), ("mouseReleased", 0)):
            page.tab.call(
                "Input.dispatchMouseEvent", type=kind, x=left + x, y=top + y, button="left",
                buttons=buttons, clickCount=1, modifiers=1,
            )  # fmt: skip

    shown = "document.getElementById('option-focus').value"
    before = page.tab.canvas()
    after = page.after(lambda: alt_click(width / 2 + 50, height / 2 - 30), "browser-focus")
    assert np.abs(after.astype(int) - before).mean() > 1
    focus = np.array([float(part) for part in page.tab.js(shown).split(",")])
    half = View.fitted("front", mesh).parallel_scale / min(1, width / height)
    pixel = 2 * half / height
    np.testing.assert_allclose(
        (focus - mesh.centre)[:2], [50 * pixel, 30 * pixel], atol=1.5 * pixel
    )
    assert focus[2] > 0
    assert np.linalg.norm(mesh.vertices - focus, axis=1).min() < mesh.edge_length
    assert "Alt+click: focus" in page.tab.js("document.querySelector('.help').innerText")
    np.testing.assert_array_equal(page.after(lambda: alt_click(2, 2)), before)
    assert page.tab.js(shown) == ""
    page.after(lambda: page.set("method", "lambert", "change"))
    page.tab.wait("!document.querySelector('.help').innerText.includes('Alt')")
    assert json.loads(page.tab.js("JSON.stringify(window.pickPoint({}, 1, 1))")) is None
