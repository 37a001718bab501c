"""The window off screen: the file's texture before, and a baked one on a key."""

import sys

import numpy as np
import pytest
from test_window import SIZE, WIDTH, Hand, open_window, picture  # noqa: F401
from textured_shapes import laid
from textured_shapes import picture as texture
from textured_views import hill

import meshdepict as md
from meshdepict.io import read_mesh
from meshdepict.shapes.height_field import HeightField
from meshdepict.viewer.session import Session
from meshdepict.viewer.session_texture import SessionTexture
from meshdepict.viewer.windows import showing
from meshdepict.viewer.windows.lit_window import LitWindow
from meshdepict.viewer.windows.window import Window

TOP = slice(30, SIZE[1] * 3 // 4)  # below the message, above scale bar and axes
LEFT, RIGHT = slice(0, WIDTH // 2 - 4), slice(WIDTH // 2 + 4, None)


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setitem(SessionTexture.__init__.__kwdefaults__, "size", 256)


@pytest.fixture
def mesh():
    """A hill in plain colours: left green, right blue."""
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:, :4, 1], pixels[:, 4:, 2] = 200, 100
    return laid(hill(), hill().texcoords, base=texture(pixels))


@pytest.fixture
def window(open_window, mesh):  # noqa: F811
    window = open_window(Session(mesh, "lambert"), live=False)
    window.scenery._welcome.SetInput("")
    return window


@pytest.fixture
def hand(window):
    return Hand(window)


def test_before_is_the_files_texture_at_full_resolution(window, hand):
    whole = picture(window)
    hand.key("w")
    half = picture(window)
    np.testing.assert_array_equal(half[TOP, RIGHT], whole[TOP, RIGHT])
    middle = half[SIZE[1] // 2]
    # Texels are sharp: half of the square is one colour, up to a texel beside its middle.
    colored = middle[: WIDTH // 2 - 60]
    on = (colored != 255).any(axis=1)
    assert on.sum() > 30
    assert (colored[on][2:-2] == (0, 200, 0)).all()
    hand.key("w")
    np.testing.assert_array_equal(picture(window)[TOP], whole[TOP])


def test_u_bakes_a_texture_that_w_compares_with_vertices_and_file(window, hand, mesh):
    vertices = picture(window)
    hand.key("u")
    assert "256 x 256 texels" in window.said
    shown = picture(window)
    baked = md.bake_texture(mesh, "lambert", size=256)
    np.testing.assert_array_equal(window.texture.image, baked.image)
    assert (shown[TOP] != vertices[TOP]).any()
    hand.key("w")
    assert window.said == "left of the line: at the vertices"
    half = picture(window)
    np.testing.assert_array_equal(half[TOP, LEFT], vertices[TOP, LEFT])
    np.testing.assert_array_equal(half[TOP, RIGHT], shown[TOP, RIGHT])
    hand.key("w")
    assert window.said == "left of the line: before"
    assert (picture(window)[SIZE[1] // 2, WIDTH // 2 - 60] == (0, 200, 0)).all()
    hand.key("w")
    np.testing.assert_array_equal(picture(window)[TOP], shown[TOP])
    hand.key("u")
    assert window.texture is None
    np.testing.assert_array_equal(picture(window)[TOP], vertices[TOP])


def test_another_light_leaves_the_texture_and_the_next_isnt_smoothed_again(window, hand, mesh):
    hand.key("u")
    first = window.textures.baked
    hand.key("Left")
    assert window.texture is None
    sampled = SessionTexture._sampled
    try:
        SessionTexture._sampled = None  # what isn't called can't be missed
        hand.key("u")
    finally:
        SessionTexture._sampled = sampled
    assert window.texture is not first
    wanted = md.bake_texture(mesh, "lambert", light=window.session.light, size=256)
    np.testing.assert_array_equal(window.texture.image, wanted.image)
    hand.key("m")
    assert window.texture is None
    hand.key("u")
    assert window.texture.provenance["method"] == window.session.method


def test_what_is_saved_is_what_is_seen(window, hand):
    hand.key("u")
    hand.key("v")
    hand.key("a")
    hand.key("s")
    found = read_mesh(window.folder / "ball-lambert.glb")
    assert found.textures.base_colors[0].pixels.shape == (256, 256, 3)
    assert (window.folder / "ball-lambert.png").exists()


def test_terrain_says_that_it_has_cells(open_window):  # noqa: F811
    y, x = np.mgrid[:8, :9]
    window = open_window(Session(HeightField(np.sin(x / 3.0) + y), "lambert"), live=False)
    window.actions.press("u")
    assert "this is terrain" in window.said
    assert window.texture is None


def test_show_opens_the_window_in_the_texture(mesh, monkeypatch, tmp_path):
    opened = []

    def run(window, *, frames=None):
        opened.append((window.texture, window.session.method))
        LitWindow.run(window, frames=0)

    monkeypatch.setattr(Window, "run", run)
    monkeypatch.setattr(showing, "check_display", lambda: None)
    off = {"off_screen": True, "live": False}
    monkeypatch.setattr(showing, "window_on", lambda session, **more: Window(session, **off))
    baked = md.bake_texture(mesh, "lambert", size=256)
    baked.show()
    ((shown, method),) = opened
    assert shown is baked
    assert method == "lambert"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems have displays")
def test_without_a_display_show_says_so(mesh, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    baked = md.bake_texture(mesh, "lambert", size=64)
    with pytest.raises(md.MeshdepictError, match="no display"):
        baked.show()
