"""The page of ``meshdepict view --browser`` in a real browser, and all that it must refuse."""

import asyncio
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tomllib
from urllib.parse import urlsplit

import numpy as np
import pytest
from chromium import tab  # noqa: F401
from conftest import PATIENCE

from meshdepict import bake
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh, write_mesh
from meshdepict.samples import golf_ball
from meshdepict.viewer.browser import serve, server
from meshdepict.viewer.browser.desk import KINDS, Desk
from meshdepict.viewer.session import Session

trame = pytest.importorskip("trame.app", reason="trame is not installed")

START = """
import sys
from meshdepict.viewer.browser import serve
from meshdepict.viewer.session import Session
serve(Session(sys.argv[1], scales=3), open_browser=False, title=sys.argv[2],
      ready=lambda address: print("ready", address, flush=True))
print("ended")
"""


class Served:
    """A server in a process of its own, as the command starts it."""

    def __init__(self, path, title="ball.ply", start=START):
        self.path = path
        # Whatever trame is told elsewhere, only this machine is served, and only with the token.
        hostile = {"TRAME_ARGS": "--host 0.0.0.0 --authKey known", "TRAME_DEFAULT_HOST": "0.0.0.0"}
        self.process = subprocess.Popen(
            [sys.executable, "-c", start, str(path), title], env=os.environ | hostile,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.address = self.process.stdout.readline().strip()
        assert self.process.stdout.readline() == f"ready {self.address}\n"
        parts = urlsplit(self.address)
        self.host, self.port, self.token = parts.netloc, parts.port, parts.query.split("=")[1]

    def get(self, path, *, method="GET", host=None, cookie=True, **headers):
        """Ask with the browser's cookie, or without; return status, body and headers."""
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        line.putrequest(method, path, skip_host=True)  # as written: nobody tidies the path
        line.putheader("Host", host or self.host)
        if cookie:
            line.putheader("Cookie", f"meshdepict-{self.port}={self.token}")
        for name, value in headers.items():
            line.putheader(name, value)
        line.endheaders()
        answer = line.getresponse()
        found = answer.status, answer.read(), answer.headers
        line.close()
        return found

    def end(self):
        """Ctrl-C; return status, the rest of stdout, and stderr."""
        self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, out, err

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()


@pytest.fixture(scope="module")
def ball_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("served") / "ball.ply"
    write_mesh(path, golf_ball(4_000))
    return path


@pytest.fixture(scope="module")
def served(ball_file):
    with Served(ball_file) as served:
        yield served


# --- who may come in ----------------------------------------------------------------------------

PLACES = ("/", "/index.html", "/vue.global.js", "/depict/mesh", "/depict/colors", "/ws",
          "/depict/save/ply", "/depict/appearance/before", "/depict/web/app.js", "/loading.tpl",
          "/nowhere")  # fmt: skip


@pytest.mark.parametrize("path", PLACES)
def test_nothing_is_served_without_the_token(served, path):
    for query in ("", "?token=", "?token=wrong", f"?secret={served.token[:-1]}", "?token=é"):
        status, body, headers = served.get(path + query.replace("é", "%C3%A9"), cookie=False)
        assert (status, b"open the address" in body) == (403, True)
        assert headers["Set-Cookie"] is None
    assert served.get(path, cookie=False, Cookie=f"meshdepict-{served.port}=wrong")[0] == 403


def test_the_address_leads_to_the_page_and_leaves_a_cookie_that_others_dont_get(served):
    status, _, headers = served.get(f"/?token={served.token}", cookie=False)
    assert status == 302
    for promise in ("HttpOnly", "SameSite=Strict"):
        assert promise in headers["Set-Cookie"]
    status, body, headers = served.get(headers["Location"], cookie=False)
    assert status == 200
    assert b'id="app"' in body
    assert headers["Referrer-Policy"] == "no-referrer"
    assert "default-src 'self'" in headers["Content-Security-Policy"]


def test_a_reloaded_page_is_given_the_token_again(served):
    status, _, headers = served.get("/index.html")
    assert status == 302
    assert served.token in headers["Location"]
    other = served.get("/index.html?secret=x&sessionURL=ws://example.org/ws")
    assert other[2]["Location"] == headers["Location"]


@pytest.mark.parametrize("path", PLACES)
def test_other_names_and_other_pages_are_refused_even_with_the_token(served, path):
    assert served.get(path, host="example.org")[0] == 403
    assert served.get(path, host=f"example.org:{served.port}")[0] == 403
    assert served.get(path, Origin="http://example.org")[0] == 403
    assert served.get(path, method="POST")[0] == 403


@pytest.mark.parametrize(
    "path",
    ["/../../../../../../etc/passwd", "/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
     "/..%2f..%2f..%2f..%2f..%2f..%2fetc/passwd", "//etc/passwd", "/etc/passwd",
     "/depict/web/../browser/server.py", "/depict/web/..%2fbrowser%2fserver.py", "/depict/web/",
     "/depict/web/%2fetc%2fpasswd", "/depict/save/..%2f..%2fetc%2fpasswd", "/assets/",
     "/depict/save/exe", "/depict/appearance/..%2f..%2fetc%2fpasswd"],
)  # fmt: skip
def test_no_file_is_within_reach(served, path):
    status, body, _ = served.get(path)
    assert status in (403, 404)
    assert b"root:" not in body
    assert b"import" not in body


def test_the_opened_file_itself_is_not_within_reach(served):
    assert served.get(str(served.path))[0] == 404
    assert served.get(f"/{served.path.name}")[0] == 404


def test_other_addresses_of_this_machine_dont_answer(served):
    for address in ("127.0.0.2", socket.gethostbyname(socket.gethostname())):
        if address != "127.0.0.1":
            with pytest.raises(OSError, match=r"refused|unreachable|timed out"):
                socket.create_connection((address, served.port), timeout=2)


def test_the_socket_wants_the_token_too_and_not_trames_own(served):
    import aiohttp
    import msgpack
    from wslink.chunking import UnChunker, generate_chunks

    async def hello(secret):
        cookies = {f"meshdepict-{served.port}": served.token}
        async with (
            aiohttp.ClientSession(cookies=cookies) as client,
            client.ws_connect(f"ws://{served.host}/ws") as line,
        ):
            said = {"id": "system:1", "method": "wslink.hello", "args": [{"secret": secret}]}
            for chunk in generate_chunks(msgpack.packb(said), 10_000):
                await line.send_bytes(chunk)
            return UnChunker().process_chunk((await line.receive()).data)

    for secret in ("wslink-secret", "known", "", served.token[:-1]):
        assert "Authentication failed" in str(asyncio.run(hello(secret))["error"])
    assert "clientID" in asyncio.run(hello(served.token))["result"]

    async def knock(**headers):
        async with aiohttp.ClientSession(headers=headers) as client:
            await client.ws_connect(f"ws://{served.host}/ws")

    with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
        asyncio.run(knock())


# --- what can be saved --------------------------------------------------------------------------


def test_files_are_saved_from_memory(served, tmp_path):
    found = {}
    for kind, suffix in KINDS.items():
        status, body, headers = served.get(f"/depict/save/{kind}?width=120&height=90")
        assert (status, headers["X-File-Name"]) == (200, f"ball-exaggerated.{suffix}")
        found[kind] = tmp_path / headers["X-File-Name"]
        found[kind].write_bytes(body)
    expected = bake(served.path, scales=3)
    saved = read_mesh(found["ply"]).attributes["vertex"]
    colors = np.stack([saved[name] for name in ("red", "green", "blue")], axis=1)
    np.testing.assert_array_equal(colors, expected.colors)
    np.testing.assert_array_equal(
        np.frombuffer(served.get("/depict/colors")[1], np.uint8).reshape(-1, 3), expected.colors
    )
    from PIL import Image

    with Image.open(found["png"]) as image:
        assert image.size == (120, 90)
    assert tomllib.loads(found["recipe"].read_text())["method"] == "exaggerated"
    assert b"<canvas" in found["html"].read_bytes()
    assert os.listdir(served.path.parent) == ["ball.ply"]


def test_a_picture_of_an_impossible_size_is_refused_in_words(served):
    for size in ("width=0&height=9", "width=99999&height=9", "width=x&height=9"):
        status, body, _ = served.get(f"/depict/save/png?{size}")
        assert status == 400
        assert b"Traceback" not in body


# --- in a browser -------------------------------------------------------------------------------

SMOOTH = "document.querySelector('canvas')?.dataset.smooth === 'true'"
SET = """(() => {{ const control = document.getElementById({0});
  control.value = {1};
  control.dispatchEvent(new Event({2})); }})()"""


class Page:
    """The page, and what a person does on it."""

    def __init__(self, tab, served):  # noqa: F811
        self.tab = tab
        tab.open(served.address)
        tab.wait(SMOOTH)

    def revision(self):
        return int(self.tab.js("document.querySelector('canvas').dataset.revision"))

    def after(self, act, name=""):
        """Do something that changes the colours; return the new picture."""
        before = self.revision()
        self.tab.js("document.querySelector('canvas').dataset.smooth = ''")
        act()
        self.tab.wait(f"+document.querySelector('canvas').dataset.revision > {before}")
        self.tab.wait(SMOOTH)
        return self.tab.canvas(name)

    def set(self, control, value, event="input"):
        self.tab.js(SET.format(*map(json.dumps, (control, value, event))))

    def click(self, control):
        self.tab.js(f"document.getElementById({json.dumps(control)}).click()")


@pytest.fixture
def page(tab, served):  # noqa: F811
    page = Page(tab, served)
    yield page
    assert tab.errors == []
    page.click("reset")


def test_the_page_loads_and_asks_nobody_else(page, served):
    picture = page.tab.canvas()
    page.tab.resize(1200, 800)
    page.tab.wait("document.querySelector('canvas').width > 800")
    page.tab.picture("browser")
    page.tab.resize(900, 640)
    assert picture.std() > 20
    assert (picture[2, 2] == (244, 242, 238)).all()
    hosts = {urlsplit(request).netloc for request in page.tab.requests}
    assert hosts == {served.host}
    assert served.token not in page.tab.js("location.href")
    assert page.tab.js("document.title") == "ball.ply – meshdepict"


def test_a_slider_changes_the_picture_and_reset_brings_it_back(page):
    first = page.tab.canvas()
    changed = page.after(lambda: page.set("option-exaggeration", 45))
    assert np.abs(changed.astype(int) - first).mean() > 1
    assert (
        page.tab.js("document.querySelector('output[for=option-exaggeration]').innerText")[:2]
        == "45"
    )
    np.testing.assert_array_equal(page.after(lambda: page.click("reset")), first)
    assert (
        page.tab.js("document.querySelector('output[for=option-exaggeration]').innerText") == "auto"
    )


def test_many_changes_in_a_row_end_at_the_last(page):
    last = page.after(lambda: page.set("option-exaggeration", 33))
    page.tab.js("document.querySelector('canvas').dataset.smooth = ''")
    for value in (*range(1, 60, 3), 33):
        page.set("option-exaggeration", value)
    page.tab.wait(SMOOTH)
    np.testing.assert_array_equal(page.tab.canvas(), last)


def test_another_method_brings_its_own_controls(page):
    first = page.tab.canvas()
    gooch = page.after(lambda: page.set("method", "gooch", "change"), "browser-gooch")
    assert np.ptp(gooch.astype(int), axis=2).max() > 60  # colours where there was gray
    assert np.ptp(first.astype(int), axis=2).max() < 20
    assert page.tab.wait("!document.getElementById('option-exaggeration')")
    page.after(lambda: page.set("method", "radiance_scaling", "change"))
    page.tab.picture("browser-radiance-scaling")
    assert page.tab.js("document.querySelectorAll('.option').length") > 2


def test_a_word_stands_in_place_of_a_number_until_a_slider_moves(page):
    page.after(lambda: page.set("method", "lambert", "change"))
    page.after(lambda: page.set("option-shadows", "true", "change"))
    page.after(lambda: page.set("option-bounces", 1))
    said = "document.querySelector('output[for=option-rays]').innerText"
    button = "getComputedStyle(document.getElementById('auto-rays')).display"
    assert page.tab.js(said).strip() == "64"
    page.after(lambda: page.click("auto-rays"))
    page.tab.wait(f"{said}.trim() === 'auto'")
    page.tab.wait(f"{button} === 'none'")
    page.after(lambda: page.set("option-rays", 32))
    page.tab.wait(f"{said}.trim() === '32'")
    assert page.tab.js(button) != "none"


def test_the_light_follows_the_pad_and_the_keys(page):
    x, y, width, height = page.tab.js(
        "(b => [b.x, b.y, b.width, b.height])"
        "(document.querySelector('.pad').getBoundingClientRect())"
    )
    middle = np.array([x + width / 2, y + height / 2])
    first = page.tab.canvas()
    page.after(lambda: page.tab.drag(middle, middle + 0.25 * width))
    label = "document.querySelector('.pad').getAttribute('aria-label')"
    page.tab.wait(f"{label}.includes('azimuth 135°')")
    lit = page.tab.canvas("browser-light")
    assert np.abs(lit.astype(int) - first).mean() > 2
    page.after(lambda: page.set("elevation", 80, "change"))
    page.tab.js("document.querySelector('.pad').focus()")
    page.after(lambda: page.tab.key("ArrowDown"))
    assert page.tab.wait("document.getElementById('elevation').value === '75'")
    assert page.tab.js("document.getElementById('azimuth').value") == "135"


def test_a_light_that_turns_with_the_view_stays_on_the_pad(page):
    def turned():
        page.tab.js("document.querySelector('canvas').focus()")
        for _ in range(4):
            page.tab.key("ArrowLeft")

    azimuth = "document.getElementById('azimuth').value"
    before = page.tab.js(azimuth)
    page.click("follow")
    page.after(turned)
    assert page.tab.wait("document.getElementById('follow').checked")
    assert page.tab.js(azimuth) == before
    page.click("follow")
    page.tab.wait("!document.getElementById('follow').checked")
    turned()
    page.tab.wait(f"{azimuth} !== {before!r}")


def test_a_colour_map_colours_and_a_wrong_one_is_said_in_one_sentence(page):
    sepia = page.after(lambda: page.set("colormap", "sepia", "change"), "browser-sepia")
    assert np.ptp(sepia.astype(int), axis=2).max() > 40
    page.set("colormap", "sepja", "change")
    said = page.tab.wait("document.querySelector('.message')?.textContent")
    assert "did you mean 'sepia'?" in said
    page.tab.wait(SMOOTH)
    np.testing.assert_array_equal(page.tab.canvas(), sepia)


def test_a_view_of_ones_own_reaches_methods_that_follow_it_and_the_files(page, served):
    page.after(lambda: page.set("method", "radiance_scaling", "change"))
    page.after(lambda: page.tab.drag((250, 250), (310, 280)))
    recipe = tomllib.loads(served.get("/depict/save/recipe")[1].decode())
    aside = np.subtract(recipe["view"]["position"], recipe["view"]["focus"])[0]
    assert abs(aside) > 0.1  # the front view looks along z


def test_a_save_button_hands_the_browser_a_file(page, tmp_path):
    page.tab.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    page.click("save-recipe")
    path = tmp_path / "ball-exaggerated.toml"
    page.tab.until(lambda: path.exists() and path.read_text())
    assert tomllib.loads(path.read_text())["method"] == "exaggerated"


def test_a_narrow_window_has_everything_below_the_picture(page):
    page.tab.resize(420, 800, mobile=True)
    try:
        page.tab.wait("document.querySelector('canvas').width < 500")
        page.tab.picture("browser-narrow")
        assert page.tab.js("document.documentElement.scrollWidth") <= 420
    finally:
        page.tab.resize(900, 640)


def test_every_control_has_a_name(page):
    nameless = page.tab.js(
        "[...document.querySelectorAll('input, select, button, canvas, svg')].filter(e => "
        "!(e.labels?.length || e.textContent.trim() || e.getAttribute('aria-label'))).length"
    )
    assert nameless == 0


def test_a_page_that_is_closed_ends_nothing_and_ctrl_c_ends_it_cleanly(tab, ball_file):  # noqa: F811
    with Served(ball_file, title="<script>alert(1)</script>") as served:
        page = Page(tab, served)
        assert tab.js("document.querySelector('h1').innerText") == "<script>alert(1)</script>"
        page.set("method", "ambient_occlusion", "change")  # takes a moment: nobody waits for it
        tab.open("about:blank")
        page = Page(tab, served)
        assert page.tab.canvas().std() > 2  # a ball hides little from the sky
        hint = "meshdepict: open this address in a browser; Ctrl+C ends it\n"
        assert served.end() == (0, "ended\n", hint)
        assert "has ended" in tab.wait("document.querySelector('.gone')?.textContent")
        tab.picture("browser-ended")


def test_terrain_rises_with_its_slider_and_what_is_looked_at_stays(tab, tmp_path):  # noqa: F811
    def tall(picture):
        inside = picture[8:-8, 8:-8]  # of the ring that says where the keys go
        return int((inside != inside[0, 0]).any(axis=2).any(axis=1).sum())

    y, x = np.mgrid[:24, :32]
    np.save(tmp_path / "hill.npy", 20 + 3 * np.exp(-((x - 15) ** 2 + (y - 12) ** 2) / 30))
    with Served(tmp_path / "hill.npy", title="hill.npy") as served:
        page = Page(tab, served)
        full = tab.js("Math.min(...['Width', 'Height'].map(side => "
                      "document.querySelector('canvas')['client' + side]))")  # fmt: skip
        tab.js("document.querySelector('canvas').dataset.smooth = ''")
        tab.drag((full / 2, 0.8 * full), (full / 2, 0.3 * full))  # 90°: from the horizon
        tab.wait(SMOOTH)
        flat = tab.canvas()
        high = page.after(lambda: page.set("option-z_factor", 6), "browser-terrain")
        assert tab.js("document.querySelector('output[for=option-z_factor]').innerText")[0] == "6"
        assert tall(high) > 3 * tall(flat)
        recipe = tomllib.loads(served.get("/depict/save/recipe")[1].decode())
        assert recipe["z_factor"] == 6
        focus = recipe["view"]["focus"]  # the box's middle, 21.5 m high, six times
        assert 6 * 20 < focus[2] < 6 * 23
        low = page.after(lambda: page.click("reset"))
        assert tall(low) > tall(flat)  # the map again
        assert tab.js("document.querySelector('output[for=option-z_factor]').innerText")[0] == "1"
        assert tab.errors == []


# --- wrong input --------------------------------------------------------------------------------


@pytest.fixture
def session(ball):
    return Session(ball, scales=2)


def test_a_port_in_use_is_one_sentence(session):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(MeshdepictError, match=rf"port {port} is in use"):
            serve(session, port=port, open_browser=False)


def test_a_forbidden_port_is_one_sentence():
    error = server._port_error(PermissionError(13, "Permission denied"), 80)
    assert re.search("port 80 may not be used: choose one above 1023", str(error))
    other = OSError(5, "broken")
    assert server._port_error(other, 80) is other


def test_work_that_nobody_waits_for_any_more_is_given_up(ball):
    """Ctrl-C must not wait for a scale space: the next word about its progress ends it."""
    session = Session(ball, scales=2)
    session.baked()
    stopped = server._Server(Desk(session, "ball.ply"), 0, print)
    stopped.stopping = True
    session.progress = stopped._progress
    with pytest.raises(server._StoppedError):
        stopped.desk.apply([["method", "light_alignment"]])  # another ratio: another scale space
    stopped.worker.shutdown()


@pytest.mark.parametrize("port", [-1, 65536, 80.5, "80", True])
def test_what_is_no_port_is_refused(session, port):
    with pytest.raises(MeshdepictError, match="port="):
        serve(session, port=port, open_browser=False)


def test_without_trame_the_sentence_says_what_to_install(session, monkeypatch):
    monkeypatch.setitem(sys.modules, "trame.app", None)
    with pytest.raises(MeshdepictError, match=r"needs trame: pip install 'pyvista\[jupyter\]'"):
        serve(session, open_browser=False)


def test_a_desk_says_what_is_wrong_and_does_the_rest(session):
    desk = Desk(session, "ball.ply")
    said = desk.apply([
        ["method", "phonk"], ["option", "exaggerated", "exaggeration", -1], ["nonsense"], [], 7,
        ["view", [1, 2], [0, 0, 0], 1], ["view"], ["light", [0, 0, 0]],
        ["option", "exaggerated", "exaggeration", 40],
    ])  # fmt: skip
    for part in ("did you mean 'phong'?", "exaggeration=-1", "'nonsense'", "three axes",
                 "no change", "not all zero"):  # fmt: skip
        assert part in said
    assert session.options == {"exaggeration": 40}
    assert desk.apply([["option", "phong", "exposure", 2]]) == ""  # of a method no longer chosen
    assert session.options == {"exaggeration": 40}


def test_a_desk_names_files_after_the_title_in_letters_that_travel(session):
    for title, name in (("Büste 3 (neu).ply", "B-ste-3-neu"), ("../../x.ply", "x"), ("…", "mesh")):
        assert Desk(session, title).name("ply") == f"{name}-exaggerated.ply"


def test_what_a_method_cant_be_lit_by_is_said(session):
    desk = Desk(session, "ball.ply")
    session.shine(["northwest", "east"])
    assert desk.look()["light"] is None
    assert "one light" in desk.apply([["method", "exaggerated"]])
