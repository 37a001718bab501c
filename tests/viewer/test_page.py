import re
from html.parser import HTMLParser

import numpy as np
import pytest
from chromium import tab  # noqa: F401

from meshdepict import bake, samples
from meshdepict.baking.baked import Baked
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View
from meshdepict.shapes.mesh import Mesh
from meshdepict.viewer.packing import pack_mesh, sight

PAPER = (244, 242, 238)
DRAWN = "document.querySelector('canvas')?.dataset.smooth === 'true'"


@pytest.fixture(scope="module")
def baked(ball):
    return bake(ball, scales=3)


def unpacked(packed, info):
    """Positions and faces, from the description of the bytes."""
    cut = 6 * info["vertices"]
    kind = "<u4" if info["wide"] else "<u2"
    places = np.cumsum(np.frombuffer(packed[:cut], "<u2").reshape(-1, 3), axis=0, dtype=np.uint16)
    corners = np.cumsum(np.frombuffer(packed[cut:], kind), dtype=kind)
    positions = np.array(info["low"]) + places * (np.array(info["span"]) / 65535)
    return positions, corners.reshape(-1, 3)


@pytest.mark.parametrize("count", [500, 70_000])
def test_a_packed_mesh_is_the_mesh_to_half_a_step(count):
    mesh = samples.sphere(count)
    packed, info = pack_mesh(mesh)
    assert info["wide"] == (len(mesh.vertices) > 65536)
    assert (info["vertices"], info["faces"]) == (len(mesh.vertices), len(mesh.faces))
    positions, faces = unpacked(packed, info)
    np.testing.assert_array_equal(faces, mesh.faces)
    step = np.ptp(mesh.vertices, axis=0).max() / 65535
    assert np.abs(positions - mesh.vertices).max() <= step / 2 * (1 + 1e-6)


def test_packing_keeps_flat_and_huge_meshes_finite():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    for scale in (1.0, 1e-140, 1e140):
        positions, _ = unpacked(*pack_mesh(Mesh(corners * scale, [[0, 1, 2]])))
        np.testing.assert_allclose(positions, corners * scale, atol=scale / 65535)


def test_a_view_in_perspective_becomes_the_parallel_one_of_its_focus():
    view = View((0, 0, 10), (0, 0, 2), (0, 1, 0), field_of_view=90)
    assert sight(view)["scale"] == pytest.approx(8)  # half the height at the focus, 8 away
    np.testing.assert_array_equal(sight(view)["frame"], np.eye(3))


# --- the file -----------------------------------------------------------------------------------


class Outline(HTMLParser):
    """What a browser would make of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.title, self.addresses, self.texts = [], "", [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.addresses += [value for name, value in attrs if name in ("src", "href", "action")]

    def handle_data(self, data):
        self.texts.append(data)
        if self.tags[-1:] == ["title"] and not self.title:
            self.title = data


def test_a_bake_saves_itself_as_a_page_that_loads_nothing(tmp_path, baked):
    path = baked.save(tmp_path / "ball.html")
    text = path.read_text(encoding="utf-8")
    assert path == tmp_path / "ball.html"
    assert Outline(text).addresses == []
    assert not re.search(r"https?:|//[a-z]+\.|@import|url\(", text)
    assert "default-src 'none'" in text
    assert "ball" in Outline(text).title
    for value in baked.provenance.values():
        assert any(value == piece for piece in Outline(text).texts) or not value
    assert baked.save(tmp_path / "again.HTM").suffix == ".HTM"


def test_the_same_bake_gives_the_same_page_and_replaces_an_earlier_one(tmp_path, baked):
    path = tmp_path / "ball.html"
    path.write_text("earlier")
    first = baked.save(path).read_bytes()
    assert baked.save(path).read_bytes() == first
    assert list(tmp_path.iterdir()) == [path]


def test_a_page_that_cant_be_written_is_one_sentence(tmp_path, baked):
    with pytest.raises(MeshdepictError, match="no such folder"):
        baked.save(tmp_path / "nowhere" / "ball.html")


@pytest.mark.parametrize(
    "name", ["<script>", "\"><img src=x onerror='alert(1)'>", "%%MESH%%", "&lt;"]
)
def test_names_can_put_nothing_into_a_page(tmp_path, baked, name):
    plain = Outline(baked.save(tmp_path / "ball.html").read_text(encoding="utf-8"))
    odd = Outline(baked.save(tmp_path / f"{name}.html").read_text(encoding="utf-8"))
    assert odd.tags == plain.tags
    assert odd.title == plain.title.replace("ball", name)


def test_provenance_can_put_nothing_into_a_page(tmp_path, ball):
    baked = bake(ball, "lambert")
    baked.provenance["light"] = "</dd></script><script>alert(1)</script>"
    odd = Outline(baked.save(tmp_path / "odd.html").read_text(encoding="utf-8"))
    plain = Outline(bake(ball, "lambert").save(tmp_path / "b.html").read_text(encoding="utf-8"))
    assert odd.tags == plain.tags


def test_the_bunny_is_less_than_a_megabyte(tmp_path, bunny):
    assert bake(bunny, "lambert").save(tmp_path / "bunny.html").stat().st_size < 1e6


# --- what people see ----------------------------------------------------------------------------


def shown(tab, path, name=""):  # noqa: F811
    tab.open(path.absolute().as_uri())
    tab.wait(DRAWN)
    return tab.canvas(name)[4:-4, 4:-4]  # without the frame that shows where the keys go


def painted(baked, color):
    colors = np.broadcast_to(np.uint8(color), baked.colors.shape).copy()
    return Baked(baked.shape, baked.intensity, colors, baked.provenance, baked.view)


def test_a_page_shows_its_colours_exactly_and_asks_for_nothing(tab, tmp_path, baked):  # noqa: F811
    path = painted(baked, (10, 200, 30)).save(tmp_path / "ball.html")
    canvas = shown(tab, path)
    height, width = canvas.shape[:2]
    np.testing.assert_array_equal(canvas[height // 2, width // 2], (10, 200, 30))
    np.testing.assert_array_equal(canvas[2, 2], PAPER)
    assert tab.requests == [path.absolute().as_uri()]
    assert tab.errors == []
    height += 8  # of the canvas
    # Fitted with a margin of 5 %: a ball is as high as 1 / 1.05 of the canvas.
    inside = (canvas == (10, 200, 30)).all(axis=2)
    assert inside.any(axis=1).sum() == pytest.approx(height / 1.05, abs=3)
    assert inside.any(axis=0).sum() == pytest.approx(height / 1.05, abs=3)


def test_a_page_says_that_it_is_loading_until_it_shows(tab, tmp_path, baked):  # noqa: F811
    path = baked.save(tmp_path / "ball.html")
    text = path.read_text(encoding="utf-8")
    said = text.index("Loading …")
    assert said < text.index('id="mesh"')  # megabytes that come later
    shown(tab, path)
    assert tab.js("document.body.innerText.includes('Loading')") is False


def test_a_page_shows_what_a_picture_shows(tab, tmp_path, baked):  # noqa: F811
    from PIL import Image

    canvas = shown(tab, baked.save(tmp_path / "golf-ball.html"), "page").astype(float)
    height, width = canvas.shape[:2]
    size = width + 8, height + 8
    assert tab.js("['width', 'height'].map(side => document.querySelector('canvas')[side])") == [
        *size
    ]
    with Image.open(baked.picture(tmp_path / "ball.png", size=size)) as image:
        picture = np.asarray(image.convert("RGB"))[4:-4, 4:-4].astype(float)
    y, x = np.mgrid[:height, :width]
    ball = np.hypot(x - width / 2, y - height / 2) < 0.45 * height
    # Two renderers, positions rounded otherwise: rarely more than a level apart.
    assert np.abs(canvas - picture)[ball].mean() < 0.5
    assert np.quantile(np.abs(canvas - picture)[ball], 0.99) <= 2
    assert canvas[ball].std() > 10


def test_far_from_the_origin_a_page_looks_the_same(tab, tmp_path, ball):  # noqa: F811
    near = shown(tab, bake(ball, "lambert").save(tmp_path / "near.html"))
    moved = Mesh(ball.vertices + np.array([5e5, -3e5, 4e6]), ball.faces)
    far = shown(tab, bake(moved, "lambert").save(tmp_path / "far.html"))
    assert np.abs(near.astype(int) - far).mean() < 0.5


def test_a_page_turns_by_mouse_and_keys_and_goes_home(tab, tmp_path, baked):  # noqa: F811
    first = shown(tab, baked.save(tmp_path / "ball.html"))

    def after(act):
        tab.js("document.querySelector('canvas').dataset.smooth = ''")
        act()
        tab.wait(DRAWN)
        return tab.canvas()[4:-4, 4:-4]

    tab.js("document.querySelector('canvas').focus()")
    turned = after(lambda: tab.drag((400, 250), (550, 300)))
    assert (turned != first).mean() > 0.05
    np.testing.assert_array_equal(after(lambda: tab.key("Home")), first)
    by_key = after(lambda: tab.key("ArrowRight"))
    assert (by_key != first).mean() > 0.05
    np.testing.assert_array_equal(after(lambda: tab.key("0")), first)
    zoomed = after(lambda: tab.key("+"))
    assert (zoomed == PAPER).all(axis=2).mean() < (first == PAPER).all(axis=2).mean()
    assert tab.errors == []


def test_two_fingers_zoom(tab, tmp_path, baked):  # noqa: F811
    first = shown(tab, baked.save(tmp_path / "ball.html"))
    tab.js("document.querySelector('canvas').dataset.smooth = ''")
    for kind, apart in (("touchStart", 40), ("touchMove", 60), ("touchMove", 80), ("touchEnd", 0)):
        points = [{"x": 450 + side * apart, "y": 250, "id": side} for side in (-1, 1) if apart]
        tab.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)
    tab.wait(DRAWN)
    after = tab.canvas()[4:-4, 4:-4]
    seen, before = ((picture != PAPER).any(axis=2).sum() for picture in (after, first))
    assert seen > 1.5 * before


def test_a_narrow_page_shows_the_whole_object(tab, tmp_path, baked):  # noqa: F811
    tab.resize(390, 760, mobile=True)
    try:
        canvas = shown(tab, painted(baked, (10, 200, 30)).save(tmp_path / "golf-ball.html"))
        tab.picture("page-narrow")
    finally:
        tab.resize(900, 640)
    inside = (canvas == (10, 200, 30)).all(axis=2)
    assert inside.any(axis=0).sum() == pytest.approx((canvas.shape[1] + 8) / 1.05, abs=3)
    assert inside.any(axis=1).sum() == pytest.approx((canvas.shape[1] + 8) / 1.05, abs=3)


def test_many_vertices_are_drawn_whole(tab, tmp_path):  # noqa: F811
    few, many = (
        shown(tab, painted(bake(samples.sphere(count), "lambert"), (9, 9, 9)).save(
            tmp_path / "sphere.html"))
        for count in (20_000, 70_000)
    )  # fmt: skip
    assert (few != many).any(axis=2).mean() < 0.01


def test_without_webgl_the_page_says_so(tab, tmp_path, baked):  # noqa: F811
    script = tab.call(
        "Page.addScriptToEvaluateOnNewDocument",
        source="HTMLCanvasElement.prototype.getContext = () => null",
    )
    try:
        tab.open(baked.save(tmp_path / "ball.html").absolute().as_uri())
        assert "WebGL 2" in tab.wait("document.querySelector('.fault')?.textContent")
    finally:
        tab.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script["identifier"])
