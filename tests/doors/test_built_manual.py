"""The manual as it was built, in the folder MESHDEPICT_MANUAL: links, words, widths, search."""

from __future__ import annotations

import functools
import http.server
import os
import threading
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from chromium import tab  # noqa: F401

BUILT = os.environ.get("MESHDEPICT_MANUAL")
HOME = Path(BUILT or ".").resolve()
pytestmark = pytest.mark.skipif(BUILT is None, reason="MESHDEPICT_MANUAL is not set")
SEEN = ("index", "start", "howto/choosing", "methods/index", "methods/exaggerated", "concepts",
        "gallery/index", "reference/classes", "terrain")  # fmt: skip


class Read(HTMLParser):
    """Collects a page's links, its anchors, and pictures without words."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.wordless: list[str] = []

    def handle_starttag(self, tag, attrs):
        said = dict(attrs)
        if said.get("id"):
            self.anchors.add(said["id"])
        for name in ("href", "src"):
            if said.get(name):
                self.links.append(said[name])
        # An empty text is what a picture has whose words stand beside it.
        if tag == "img" and said.get("alt") is None:
            self.wordless.append(said.get("src", "?"))


@functools.cache
def page(path: Path) -> Read:
    read = Read()
    read.feed(path.read_text("utf-8"))
    return read


def pages() -> list[Path]:
    return [path for path in sorted(HOME.rglob("*.html")) if "_static" not in path.parts]


def test_every_link_within_the_manual_leads_somewhere():
    assert len(pages()) > 40
    for path in pages():
        for link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            assert target.exists(), (path.name, link)
            if parts.fragment and target.suffix == ".html":
                assert unquote(parts.fragment) in page(target).anchors, (path.name, link)


def test_every_picture_has_words():
    for path in pages():
        assert not page(path).wordless, path.name


@pytest.fixture(scope="module")
def address():
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Silent) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()
        thread.join()


class Silent(http.server.SimpleHTTPRequestHandler):
    """Serves the manual, and says nothing."""

    def __init__(self, *given, **named) -> None:
        super().__init__(*given, directory=str(HOME), **named)

    def log_message(self, *_):
        """Say nothing."""


@pytest.mark.parametrize("width", [1280, 400])
def test_no_page_is_wider_than_the_screen(tab, address, width):  # noqa: F811
    tab.resize(width, 900)
    for name in SEEN:
        tab.open(f"{address}/{name}.html")
        assert tab.js("document.documentElement.scrollWidth") <= width, name
        assert not tab.errors, (name, tab.errors)


def test_the_search_finds_a_method(tab, address):  # noqa: F811
    tab.open(f"{address}/search.html?q=exaggeration")
    tab.wait("document.querySelectorAll('#search-results li').length")
    assert "exaggerat" in tab.js("document.querySelector('#search-results').innerText").lower()


def test_the_slider_cuts_where_it_is_put(tab, address):  # noqa: F811
    tab.open(f"{address}/methods/exaggerated.html")
    tab.wait("document.querySelector('.before-after.wiped input') !== null")
    tab.js(
        "{const bar = document.querySelector('.before-after input'); bar.value = 25; "
        "bar.dispatchEvent(new Event('input'));}"
    )
    assert "25%" in tab.js(
        "getComputedStyle(document.querySelector('.before-after img + img')).clipPath"
    )


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_both_themes_have_words_that_can_be_read(tab, address, theme):  # noqa: F811
    tab.open(f"{address}/start.html")
    tab.js(f"document.documentElement.dataset.theme = '{theme}'")
    colors = tab.js(
        "(s => [s.color, getComputedStyle(document.body).backgroundColor])"
        "(getComputedStyle(document.querySelector('article p')))"
    )
    words, ground = ([float(x) for x in c.strip("rgba()").split(",")[:3]] for c in colors)
    assert abs(sum(words) - sum(ground)) / 3 > 120
