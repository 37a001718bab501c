"""Pages that show textures: every pixel is looked up in the texture by ourselves, too."""

import base64
import io
import json
import re

import numpy as np
import pytest
from chromium import tab  # noqa: F401
from PIL import Image
from textured_shapes import globe, laid, picture, sheet
from textured_views import hill, islands, looked_up, noise, wrapped

import meshdepict as md
from meshdepict import samples
from meshdepict.baking.own_colors import own_appearance
from meshdepict.errors import MeshdepictError
from meshdepict.scene.names import as_view
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Texture
from meshdepict.viewer.packed_appearance import pack_appearance

DRAWN = "document.querySelector('canvas')?.dataset.smooth === 'true'"
CHOICES = "[...document.querySelectorAll('select option')].map(each => each.textContent)"
LEVELS = 2  # of 255 that the card may be off: rounding twice, and its own steps between texels


def after(tab, act):  # noqa: F811
    """What the canvas shows once something was done, without the frame for keys."""
    tab.js("document.querySelector('canvas').dataset.smooth = ''")
    act()
    tab.wait(DRAWN)
    return tab.canvas()


def opened(tab, path):  # noqa: F811
    tab.open(path.absolute().as_uri())
    tab.wait(DRAWN)
    return tab.canvas()


def compared(tab, number):  # noqa: F811
    """The canvas with another appearance on its left, nearly to its right edge."""

    def choose():
        tab.js(f"document.querySelector('select').value = '{number}'")
        tab.js("document.querySelector('select').dispatchEvent(new Event('change'))")
        tab.js("document.querySelector('canvas').focus()")
        for _ in range(30):
            tab.key("]")

    return after(tab, choose)


def agrees(seen, appearance, view):
    """Whether a canvas shows an appearance but for its frame, its edges and the line."""
    height, width = seen.shape[:2]
    wanted, inner = looked_up(appearance, view, (width, height))
    inner[:4] = inner[-4:] = inner[:, :4] = inner[:, -4:] = False
    assert inner.mean() > 0.2
    assert np.abs(seen - wanted)[inner].max() <= LEVELS


def pictures(path):
    """The pictures that a page holds."""
    found = re.findall(r'id="picture-\d+">([^<]*)<', path.read_text("utf-8"))
    return [base64.b64decode(each) for each in found]


# --- a baked texture ----------------------------------------------------------------------------


@pytest.mark.parametrize("atlas", ["own", "new"])
def test_a_page_shows_a_baked_texture_as_it_is(tab, tmp_path, atlas):  # noqa: F811
    baked = md.bake_texture(hill(), "lambert", size=256, atlas=atlas, view="front")
    path = baked.save(tmp_path / "hill.html")
    seen = opened(tab, path)
    assert tab.requests == [path.absolute().as_uri()]
    assert tab.errors == []
    wanted, inner = looked_up(baked.appearance, baked.view, (seen.shape[1], seen.shape[0]))
    inner[:4] = inner[-4:] = inner[:, :4] = inner[:, -4:] = False
    error = np.abs(seen - wanted)[inner]
    assert error.max() <= LEVELS
    assert np.ptp(seen[inner]) > 50


def test_a_texture_is_beside_its_vertices_and_the_files_own(tab, tmp_path):  # noqa: F811
    mesh = laid(hill(3), hill(3).texcoords, base=picture(noise(16, 5)))
    baked = md.bake_texture(mesh, "lambert", size=256)
    first = opened(tab, baked.save(tmp_path / "hill.html"))
    assert tab.js(CHOICES) == ["nothing", "its own texture", "lambert at the vertices"]
    agrees(compared(tab, 1), own_appearance(mesh), baked.view)
    vertices = md.bake(mesh, "lambert")
    agrees(compared(tab, 2), vertices.appearances["lambert"], baked.view)
    np.testing.assert_array_equal(after(tab, lambda: tab.key("w"))[4:-4, 4:-4], first[4:-4, 4:-4])
    agrees(after(tab, lambda: tab.key("w")), vertices.appearances["lambert"], baked.view)
    tab.picture("texture-page")
    assert tab.errors == []


def test_the_line_is_dragged_and_parts_the_picture(tab, tmp_path):  # noqa: F811
    mesh = laid(hill(3), hill(3).texcoords, base=picture(noise(16, 5)))
    whole = opened(tab, md.bake_texture(mesh, "lambert", size=256).save(tmp_path / "hill.html"))
    middle = whole.shape[1] // 2
    half = after(tab, lambda: tab.key("w"))
    np.testing.assert_array_equal(half[4:-4, middle + 2 : -4], whole[4:-4, middle + 2 : -4])
    assert (half[40:-40, middle - 90 : middle - 2] != whole[40:-40, middle - 90 : middle - 2]).any()
    box = tab.js("document.querySelector('canvas').getBoundingClientRect().y")
    moved = after(tab, lambda: tab.drag((middle, box + 100), (middle - 150, box + 120)))
    right = slice(middle - 148, -4)
    np.testing.assert_array_equal(moved[4:-4, right], whole[4:-4, right])  # and it didn't turn


def test_pictures_are_packed_as_was_said_and_stored_once(tmp_path):
    baked = md.bake_texture(globe(4), "lambert", size=64)
    for kind in ("png", "jpeg", "webp"):
        path = baked.save(tmp_path / f"{kind}.html", image=kind)
        (found,) = pictures(path)
        with Image.open(io.BytesIO(found)) as image:
            assert image.format.lower() == kind
            assert image.size == (64, 64)


def test_a_texture_of_pairs_is_shown_without_mipmaps(tmp_path):
    for atlas in ("own", "new"):
        baked = md.bake_texture(globe(4), "lambert", size=128, atlas=atlas)
        text = baked.save(tmp_path / "globe.html").read_text("utf-8")
        info = json.loads(re.search(r'id="info">([^<]*)<', text).group(1))
        assert info["appearances"][0]["parts"][0]["mipmaps"] is (atlas == "own")


def test_pairs_show_nothing_beside_their_triangles(tab, tmp_path):  # noqa: F811
    ball = islands(md.bake_texture(samples.sphere(300), "lambert", size=256, atlas="new"))
    seen = opened(tab, ball.save(tmp_path / "ball.html"))[4:-4, 4:-4]
    assert seen.min() >= 238  # paper, white, and what is between them


def test_maps_are_no_pages(tmp_path):
    baked = md.bake_texture(globe(4), size=64, map="normal")
    with pytest.raises(MeshdepictError, match=r"end the name with \.png"):
        baked.save(tmp_path / "globe.html")


def test_detail_of_a_finer_mesh_is_beside_the_coarse_ones_vertices(tmp_path):
    coarse, fine = samples.sphere(100), samples.golf_ball(1500)
    baked = md.bake_texture(coarse, "lambert", size=128, detail=fine, cage="10%")
    assert len(baked.vertices.colors) == len(coarse.vertices)
    text = baked.save(tmp_path / "ball.html").read_text("utf-8")
    assert "lambert at the vertices" in text


# --- the file's own -----------------------------------------------------------------------------


@pytest.mark.parametrize("tinted", [False, True])
@pytest.mark.parametrize(
    "wrap", [("repeat", "repeat"), ("clamp", "clamp"), ("mirror", "repeat"), ("clamp", "mirror")]
)
def test_a_page_compares_a_bake_with_the_files_texture(tab, tmp_path, wrap, tinted):  # noqa: F811
    mesh = wrapped(wrap, tinted=tinted)
    baked = md.bake(mesh, "lambert", view="front")
    opened(tab, baked.save(tmp_path / "sheet.html"))
    assert tab.js(CHOICES) == ["nothing", "its own texture"]
    agrees(compared(tab, 1), own_appearance(mesh), baked.view)
    assert tab.errors == []


def test_colours_of_ones_own_are_compared_too_and_nothing_where_there_are_none(tab, tmp_path):  # noqa: F811
    plain = sheet(3)
    red = np.full(len(plain.vertices), 200, np.uint8)
    own = {"vertex": {"red": red, "green": red // 4, "blue": red // 8}}
    mesh = Mesh(plain.vertices, plain.faces, attributes=own)
    opened(tab, md.bake(mesh, "lambert").save(tmp_path / "own.html"))
    seen = compared(tab, 1)
    assert (seen[seen.shape[0] // 2, seen.shape[1] // 2] == (200, 50, 25)).all()
    opened(tab, md.bake(plain, "lambert").save(tmp_path / "plain.html"))
    assert tab.js("document.querySelector('select')") is None


def test_a_picture_that_is_missing_is_as_if_there_were_none(tmp_path):
    mesh = laid(sheet(2), sheet(2).texcoords, base=Texture("gone.png", None))
    assert own_appearance(mesh) is None
    assert "<select" not in md.bake(mesh, "lambert").save(tmp_path / "s.html").read_text("utf-8")


def test_pictures_that_browsers_dont_show_as_they_are_become_png():
    deep = np.arange(3 * 64, dtype=np.uint16).reshape(8, 8, 3) * 300
    cases = [Texture.of_pixels(deep), Texture.of_pixels(noise(8, 1))]
    turned = io.BytesIO()
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(noise(8, 1)).save(turned, "JPEG", exif=exif)
    cases.append(Texture("turned.jpg", turned.getvalue(), "jpeg"))
    for texture in cases:
        mesh = laid(sheet(2), sheet(2).texcoords, base=texture)
        (found,) = pack_appearance(own_appearance(mesh)).pictures
        with Image.open(io.BytesIO(found)) as image:
            assert image.format == "PNG"
            wanted = texture.pixels / (257 if texture.pixels.dtype == np.uint16 else 1)
            assert np.abs(np.asarray(image) - wanted).max() <= 0.5


def test_far_away_coordinates_lie_where_they_lay():
    mesh = wrapped(("repeat", "mirror"))
    textures = mesh.textures
    far = laid(mesh, textures.texcoords + 1e5, base=textures.base_colors[0])
    near = laid(mesh, textures.texcoords, base=textures.base_colors[0])
    view = as_view("front", mesh)
    for one, other in zip(*(own_appearance(each).primitives for each in (far, near)), strict=True):
        assert np.abs(one.texcoords).max() < 70
        colors = [each.texture.lookup(each.texcoords[each.faces[:, 0]]) for each in (one, other)]
        np.testing.assert_allclose(*colors, atol=1e-4)
    assert looked_up(own_appearance(near), view, (20, 20))[1].any()
