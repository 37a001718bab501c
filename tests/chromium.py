"""A headless Chromium, driven by its own DevTools protocol through aiohttp, which trame brings."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENCE

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
QUIET = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--disable-extensions",
    "--disable-dev-shm-usage", "--hide-scrollbars",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
)  # fmt: skip


def find_chromium() -> str | None:
    """The browser's program: that of MESHDEPICT_CHROMIUM, or the first that is installed."""
    return shutil.which(os.environ.get("MESHDEPICT_CHROMIUM", "")) or next(
        filter(None, map(shutil.which, NAMES)), None
    )


class Chromium:
    """One tab. `requests`, `errors`: what it asked for and complained about since `open`."""

    def __init__(self, folder: Path, *, size: tuple[int, int] = (900, 640)) -> None:
        self.requests: list[str] = []
        self.errors: list[str] = []
        self._asked = 0
        self._loop = asyncio.new_event_loop()
        self._process = subprocess.Popen(
            [find_chromium(), *QUIET, "--remote-debugging-port=0", f"--user-data-dir={folder}",
             f"--window-size={size[0]},{size[1]}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        written = folder / "DevToolsActivePort"
        self.until(lambda: written.exists() and written.read_text().count("\n"))
        port = written.read_text().split()[0]
        self._run(self._connect(port))
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.resize(*size)

    async def _connect(self, port: str) -> None:
        import aiohttp

        self._client = aiohttp.ClientSession()
        async with self._client.get(f"http://127.0.0.1:{port}/json/list") as answer:
            tabs = json.loads(await answer.text())
        address = next(tab["webSocketDebuggerUrl"] for tab in tabs if tab["type"] == "page")
        self._socket = await self._client.ws_connect(address, max_msg_size=0)

    def _run(self, coroutine):
        return self._loop.run_until_complete(asyncio.wait_for(coroutine, PATIENCE))

    def until(self, done):
        """Wait until a function returns something true; return it."""
        end = time.monotonic() + PATIENCE
        while not (found := done()):
            assert time.monotonic() < end, "the browser took too long"
            time.sleep(0.02)
        return found

    def call(self, method: str, **parameters):
        """Call a method of the protocol and return its result."""
        return self._run(self._call(method, parameters))

    async def _call(self, method, parameters):
        self._asked += 1
        await self._socket.send_json({"id": self._asked, "method": method, "params": parameters})
        while True:
            said = await self._socket.receive_json()
            if said.get("id") == self._asked:
                assert "error" not in said, said["error"]
                return said["result"]
            self._note(said.get("method"), said.get("params", {}))

    def _note(self, event, said) -> None:
        if event == "Network.requestWillBeSent":
            self.requests.append(said["request"]["url"])
        elif event == "Network.webSocketCreated":
            self.requests.append(said["url"])
        elif event == "Runtime.exceptionThrown":
            details = said["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif event == "Log.entryAdded" and said["entry"]["level"] == "error":
            self.errors.append(said["entry"]["text"])
        elif event == "Runtime.consoleAPICalled" and said["type"] == "error":
            self.errors.append(str(said["args"]))

    def open(self, address: str) -> None:
        # A page whose server has gone complains once more when it is left: that is not about this.
        self.call("Page.navigate", url="about:blank")
        self.wait("location.href === 'about:blank' && document.readyState === 'complete'")
        self.requests.clear()
        self.errors.clear()
        self.call("Page.navigate", url=address)
        self.wait("document.readyState === 'complete'")  # a tab on its way hears nothing

    def js(self, text: str):
        """Evaluate an expression, await it if it is a promise, and return its value."""
        said = self.call("Runtime.evaluate", expression=text, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in said, said["exceptionDetails"]
        return said["result"].get("value")

    def wait(self, text: str):
        """Wait until an expression is true; return it."""
        return self.until(lambda: self.js(text))

    def resize(self, width: int, height: int, *, mobile: bool = False) -> None:
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=1, mobile=mobile,
        )  # fmt: skip

    def picture(self, name: str = "", box: tuple[float, ...] | None = None) -> np.ndarray:
        """A screenshot (h, w, 3); kept as name.png in MESHDEPICT_ARTEFACTS where that is set."""
        from io import BytesIO

        from PIL import Image

        clip = {} if box is None else {
            "clip": dict(zip(("x", "y", "width", "height"), box, strict=True), scale=1)
        }  # fmt: skip
        data = base64.b64decode(self.call("Page.captureScreenshot", **clip)["data"])
        kept = os.environ.get("MESHDEPICT_ARTEFACTS")
        if kept and name:
            Path(kept).mkdir(parents=True, exist_ok=True)
            (Path(kept) / f"{name}.png").write_bytes(data)
        return np.asarray(Image.open(BytesIO(data)).convert("RGB"))

    def canvas(self, name: str = "") -> np.ndarray:
        """A screenshot of the page's canvas."""
        box = self.js(
            "(b => [b.x, b.y, b.width, b.height])"
            "(document.querySelector('canvas').getBoundingClientRect())"
        )
        return self.picture(name, tuple(box))

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, steps: int = 4) -> None:
        """Press the left button at one point and let it go at another."""

        def mouse(kind, x, y, buttons):
            self.call(
                "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons,
                clickCount=1,
            )  # fmt: skip

        mouse("mousePressed", *start, 1)
        for share in np.linspace(0, 1, steps + 1)[1:]:
            mouse("mouseMoved", *(np.add(start, share * np.subtract(end, start))), 1)
        mouse("mouseReleased", *end, 0)

    def key(self, name: str) -> None:
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name)

    def close(self) -> None:
        async def leave():
            await self._socket.close()
            await self._client.close()

        self._run(leave())
        self._loop.close()
        self._process.terminate()
        self._process.wait(PATIENCE)


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    """An empty tab, or a skip that says why there is none."""
    pytest.importorskip("aiohttp", reason="aiohttp, which trame brings, is not installed")
    if find_chromium() is None:
        pytest.skip("no Chromium found: install it, or set MESHDEPICT_CHROMIUM to its program")
    tab = Chromium(tmp_path_factory.mktemp("chromium"))
    yield tab
    tab.close()
