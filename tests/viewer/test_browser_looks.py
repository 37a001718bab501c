"""The page of ``view --browser``: a baked texture, and how the mesh was before."""

import json
import struct

import numpy as np
import pytest
from chromium import tab  # noqa: F401
from test_browser import SMOOTH, START, Page, Served
from textured_shapes import laid, picture
from textured_views import hill, looked_up, noise

import meshdepict as md
from meshdepict import samples
from meshdepict.baking.baked_texture import BakedTexture
from meshdepict.baking.own_colors import own_appearance
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh
from meshdepict.scene.names import as_view
from meshdepict.shapes.height_field import HeightField
from meshdepict.viewer.browser.desk import Desk
from meshdepict.viewer.session import Session

pytest.importorskip("trame.app", reason="trame is not installed")

SIZE = 256
SMALL = f"""
from meshdepict.viewer.session_texture import SessionTexture
SessionTexture.__init__.__kwdefaults__["size"] = {SIZE}
"""
DRESSED = "document.querySelector('canvas').dataset"


@pytest.fixture(scope="module")
def textured_file(tmp_path_factory):
    """A hill with a picture of its own."""
    mesh = laid(hill(), hill().texcoords, base=picture(noise(16, 5)))
    path = tmp_path_factory.mktemp("textured") / "hill.glb"
    write = BakedTexture.save
    baked = md.bake_texture(mesh, "lambert", size=16)
    baked.image[...] = noise(16, 5)
    return write(baked, path)


@pytest.fixture(scope="module")
def served_hill(textured_file):
    with Served(textured_file, "hill.glb", SMALL + START) as served:
        yield served


@pytest.fixture
def page(tab, served_hill):  # noqa: F811
    tab.resize(1100, 640)  # wider than high, as the views that are looked up
    page = Page(tab, served_hill)
    page.after(lambda: page.set("method", "lambert", "change"))
    yield page
    tab.resize(900, 640)
    assert tab.errors == []


def dressed(page, act, key, value):
    """Do something; return the canvas once it shows a texture, or what is compared."""
    page.tab.js("document.querySelector('canvas').dataset.smooth = ''")
    act()
    page.tab.wait(f"{DRESSED}.{key} {value}")
    page.tab.wait(SMOOTH)
    return page.tab.canvas()


def agrees(seen, appearance, *, left=0.0, right=1.0):
    """Whether a share of the canvas shows an appearance, but for edges."""
    height, width = seen.shape[:2]
    view = as_view("front", appearance.mesh)
    wanted, inner = looked_up(appearance, view, (width, height))
    inner[:4] = inner[-4:] = inner[:, :4] = inner[:, -4:] = False
    inner[:, : int(left * width) + 3] = inner[:, int(right * width) - 3 :] = False
    assert inner.mean() > 0.1
    error = np.abs(seen - wanted)[inner]
    assert np.quantile(error, 0.999) <= 2
    assert error.max() <= 4  # where shading bends, and positions are rounded


def test_a_texture_is_baked_shown_compared_and_left(page, textured_file):
    mesh = read_mesh(textured_file)
    plain = page.tab.canvas()
    baked = md.bake_texture(mesh, "lambert", size=SIZE)
    shown = dressed(page, lambda: page.click("texture"), "texture", "> 0")
    agrees(shown, baked.appearance)
    page.tab.picture("browser-texture")
    act = lambda: page.set("compared", "vertices", "change")  # noqa: E731
    half = dressed(page, act, "compared", "=== 'vertices'")
    agrees(half, md.bake(mesh, "lambert").appearances["lambert"], right=0.5)
    agrees(half, baked.appearance, left=0.5)
    left = dressed(page, lambda: page.click("texture"), "texture", "=== '0'")
    np.testing.assert_array_equal(left, plain)
    assert page.tab.js("document.getElementById('compared').value") == ""


def test_another_light_leaves_the_texture_and_the_next_one_is_baked_in_it(page, textured_file):
    dressed(page, lambda: page.click("texture"), "texture", "> 0")
    page.after(lambda: page.set("elevation", 80, "change"))
    page.tab.wait(f"{DRESSED}.texture === '0'")
    page.tab.wait("document.getElementById('texture').textContent.includes('Bake')")
    page.after(lambda: page.click("reset"))
    page.after(lambda: page.set("method", "lambert", "change"))
    shown = dressed(page, lambda: page.click("texture"), "texture", "> 0")
    agrees(shown, md.bake_texture(read_mesh(textured_file), "lambert", size=SIZE).appearance)
    page.click("texture")


def test_w_parts_it_and_the_files_own_texture(page, textured_file):
    page.tab.js("document.querySelector('canvas').focus()")
    own = own_appearance(read_mesh(textured_file))
    half = dressed(page, lambda: page.tab.key("w"), "compared", "=== 'before'")
    agrees(half, own, right=0.5)
    page.tab.picture("browser-before")
    dressed(page, lambda: page.tab.key("w"), "compared", "=== ''")


# --- without a browser --------------------------------------------------------------------------


def small(session):
    """A desk whose textures are baked in no time."""
    desk = Desk(session, "thing")
    desk.looks._textures._size = 64
    return desk


def unpacked(data):
    (length,) = struct.unpack("<I", data[:4])
    return json.loads(data[4 : 4 + length])


def test_a_texture_is_shown_until_the_colours_change(ball):
    desk = small(Session(ball, "lambert"))
    assert desk.looks.number == 0
    assert desk.apply([["texture", True]]) == ""
    first = desk.looks.number
    assert first > 0
    assert desk.look()["texture"].startswith("texture, 512")
    assert [each["name"] for each in desk.look()["comparisons"]] == ["vertices", "before"]
    assert desk.apply([["view", np.eye(3).tolist(), [0, 0, 0], 1.0]]) == ""
    assert desk.looks.number == first  # lambert looks the same from everywhere
    np.testing.assert_array_equal(desk.looks.texture.view.frame, np.eye(3))
    assert desk.apply([["light", [0, 1, 0]]]) == ""
    assert (desk.looks.number, desk.looks.texture, desk.look()["texture"]) == (0, None, "")
    with pytest.raises(MeshdepictError, match="no texture any more"):
        desk.looks.packed("texture")
    assert desk.apply([["texture", True]]) == ""
    assert desk.looks.number not in (0, first)
    again = md.bake_texture(ball, "lambert", light=desk.session.light, size=512)
    np.testing.assert_array_equal(desk.looks.texture.image, again.image)
    assert desk.apply([["texture", False]]) == ""
    assert desk.looks.number == 0


def test_files_hold_the_texture_while_it_is_shown(ball, tmp_path):
    desk = small(Session(ball, "lambert"))
    desk.apply([["texture", True]])
    for kind in ("glb", "html", "png"):
        assert isinstance(desk.shown(kind), BakedTexture)
    path = tmp_path / "ball.glb"
    path.write_bytes(desk.save("glb", desk.shown("glb"), (60, 60)))
    assert read_mesh(path).textures is not None
    assert b"picture-0" in desk.save("html", desk.shown("html"), (60, 60))
    assert desk.save("ply", desk.shown("ply"), (60, 60)).startswith(b"ply")
    desk.apply([["texture", False]])
    path.write_bytes(desk.save("glb", desk.shown("glb"), (60, 60)))
    assert read_mesh(path).textures is None


def test_before_is_the_files_own_else_lambert(ball):
    desk = small(Session(ball, "exaggerated", scales=2))
    assert desk.look()["own"] is False
    assert unpacked(desk.looks.packed("before"))["parts"] == []
    textured = laid(hill(2), hill(2).texcoords, base=picture(noise(16, 5)))
    desk = small(Session(textured, "lambert"))
    assert (desk.look()["own"], desk.look()["comparisons"][0]["words"]) == (
        True, "its own texture",
    )  # fmt: skip
    assert unpacked(desk.looks.packed("before"))["parts"][0]["picture"] == 0


def test_terrain_has_no_texture():
    y, x = np.mgrid[:6, :8]
    desk = small(Session(HeightField(np.sin(x / 3.0) + y), "lambert"))
    assert desk.look()["texture"] is None
    assert "this is terrain" in desk.apply([["texture", True]])
    assert desk.looks.number == 0


def test_coordinates_that_cant_be_baked_in_are_replaced():
    mesh = samples.sphere(200)
    folded = laid(mesh, np.tile([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]], (len(mesh.faces), 1, 1)))
    desk = small(Session(folded, "lambert"))
    assert desk.apply([["texture", True]]) == ""
    assert "new" in desk.looks.texture.provenance["texture"]
