"""The server of the page: trame on 127.0.0.1, behind a `Gate`, with the session on a thread."""

from __future__ import annotations

import asyncio
import errno
import os
import secrets
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from meshdepict.console import complain
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.browser.desk import KINDS, Desk
from meshdepict.viewer.browser.gate import Gate
from meshdepict.viewer.browser.looks import LOOKS
from meshdepict.viewer.browser.redirect import redirect
from meshdepict.viewer.packing import pack_mesh, raised
from meshdepict.viewer.page import WEB

if TYPE_CHECKING:
    from aiohttp.web import Request, Response

    from meshdepict.viewer.session import Session

__all__ = ["serve"]

_ICON = (
    "data:image/svg+xml,<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'>"
    "<circle cx='8' cy='8' r='7' fill='%23777'/><circle cx='6' cy='5' r='3' fill='%23fff'/></svg>"
)
_SCRIPTS = ("appearance", "pick", "mesh_view", "looks", "app")
_ENDED = "<p class='gone'>meshdepict has ended. Start it again to go on.</p>"


def serve(
    session: Session,
    *,
    port: int = 0,
    open_browser: bool = True,
    title: str = "mesh",
    ready: Callable[[str], None] | None = None,
) -> None:
    """Show a session in a browser on this machine until Ctrl-C.

    Prints the page's address, which holds a random token without which nothing is served. Closing
    the browser ends nothing: the address can be opened again.

    Parameters
    ----------
    session : Session
        Used from another thread until this returns.
    port : int
        0 takes a free one.
    open_browser : bool
        Whether to open the address; by way of a file, as command lines are for all to see.
    title : str
        What the page calls the shape.
    ready : callable, optional
        ``ready(address)``, once the page can be opened.

    Raises
    ------
    MeshdepictError
        Without trame, for a port that is in use or forbidden, and for whatever the session can't
        bake.
    """
    try:
        import trame.app
        import trame.ui.html  # noqa: F401
    except ImportError:
        raise MeshdepictError(
            "the viewer in a browser needs trame: pip install 'pyvista[jupyter]'"
        ) from None
    if isinstance(port, bool) or not isinstance(port, int) or not 0 <= port <= 65535:
        raise MeshdepictError(f"port={port!r} is not a number from 0 (any free port) to 65535")
    session.baked()  # what can't be baked is said before anything is served

    def started(address: str) -> None:
        sys.stdout.write(f"{address}\n")
        sys.stdout.flush()
        complain("open this address in a browser; Ctrl+C ends it")
        if open_browser:
            way = kept.enter_context(redirect(address))
            threading.Thread(target=webbrowser.open, args=(way,), daemon=True).start()
        if ready is not None:
            ready(address)

    before = session.progress
    kept = ExitStack()
    try:
        asyncio.run(_Server(Desk(session, title), port, started).run())
    except KeyboardInterrupt:
        return
    except OSError as error:
        raise _port_error(error, port) from error
    finally:
        kept.close()
        session.progress = before


def _port_error(error: OSError, port: int) -> Exception:
    if error.errno == errno.EADDRINUSE:
        return MeshdepictError(f"port {port} is in use: choose another one, or none for a free one")
    if error.errno == errno.EACCES:
        return MeshdepictError(f"port {port} may not be used: choose one above 1023")
    return error


class _StoppedError(Exception):
    """Ends the work on a scale space that nobody waits for any more."""


class _Server:
    def __init__(self, desk: Desk, port: int, started: Callable[[str], None]) -> None:
        from trame.app import get_server

        self.desk = desk
        self.port = port
        self.started = started
        self.gate = Gate(secrets.token_urlsafe(24), lambda: self.trame.port)
        self.trame = get_server(f"meshdepict-{secrets.token_hex(4)}", client_type="vue3")
        self.worker = ThreadPoolExecutor(1, "meshdepict-session")
        self.stopping = False
        self.told = 0.0  # when progress was told last
        self.colors = b""

    async def run(self) -> None:
        """Serve until cancelled."""
        self.loop = asyncio.get_running_loop()
        self.queue: asyncio.Queue[tuple[str, int, list[Any]]] = asyncio.Queue()
        self.desk.session.progress = self._progress
        self._fill()
        with _arguments(f"--server --host=127.0.0.1 --authKey={self.gate.token} --timeout=0"):
            listening = asyncio.ensure_future(
                self.trame.start(
                    port=self.port, thread=True, open_browser=False, show_connection_info=False,
                    disable_logging=True, backend="aiohttp", exec_mode="coroutine",
                )
            )  # fmt: skip
        work = asyncio.create_task(self._work())
        try:
            # Ctrl-C cancels this wait, not the server, which is then told to stop.
            await asyncio.shield(listening)
        finally:
            self.stopping = True
            work.cancel()
            self.worker.shutdown(wait=False, cancel_futures=True)
            if not listening.done():
                await self.trame.stop()
                await listening
            del self.desk, self.mesh, self.shown, self.colors  # trame keeps its servers for good

    # --- the page -----------------------------------------------------------------------------

    def _fill(self) -> None:
        """Put everything into trame's state that the page shows at first."""
        from trame.ui.html import DivLayout

        trame, state = self.trame, self.trame.state
        trame.enable_module(
            {
                "scripts": [f"depict/web/{name}.js" for name in _SCRIPTS],
                "styles": ["depict/web/app.css"],
                "vue_use": ["meshdepict"],
            }
        )
        with DivLayout(trame) as layout:
            layout.root.add_child("<depict-app />")
        self.z_factor = self.desk.session.z_factor
        self.mesh, state.mesh = pack_mesh(self.desk.session.surface)
        self.shown = self.desk.session.colors
        self.colors = self.shown.tobytes()
        state.update(
            {
                "look": self.desk.look(),
                "home": {**self.desk.home(), "count": 0},
                "revision": 1,
                "texture": 0,
                "applied": {},
                "message": "",
                "progress": 0.0,
                "trame__title": f"{self.desk.title} – meshdepict",
                "trame__favicon": _ICON,
                "trame__template_error": _ENDED,
            }
        )
        trame.trigger("change")(self._change)
        trame.controller.on_error.add(lambda message: complain(f"the page says: {message}"))
        trame.controller.on_server_bind.add(self._bind)
        trame.controller.on_server_ready.add(lambda **_: self.started(self.gate.address))

    def _bind(self, server: Any) -> None:
        """Put the gate before, and the mesh, its colours and its files into trame's web server."""
        server.config["host"] = "127.0.0.1"  # whatever trame was told elsewhere
        router = server.app.router
        server.app.middlewares.append(self.gate.middleware())
        router.add_get("/depict/mesh", self._send_mesh)
        router.add_get("/depict/colors", self._send_colors)
        router.add_get("/depict/appearance/{name}", self._send_appearance)
        router.add_get("/depict/save/{kind}", self._send_file)
        router.add_get("/loading.tpl", self._send_loading)
        router.add_static("/depict/web", WEB)

    async def _send_mesh(self, request: Request) -> Response:
        return _bytes(self.mesh)

    async def _send_colors(self, request: Request) -> Response:
        return _bytes(self.colors)

    async def _send_appearance(self, request: Request) -> Response:
        from aiohttp import web

        name = request.match_info["name"]
        if name not in LOOKS:
            raise web.HTTPNotFound(text=f"there is no appearance {name!r:.40}\n")
        try:
            return _bytes(await self._apart(self.desk.looks.packed, name))
        except MeshdepictError as error:
            return web.Response(status=400, text=str(error))

    async def _send_loading(self, request: Request) -> Response:
        from aiohttp import web

        return web.Response(text="<p style='font: 1rem system-ui; padding: 4rem'>loading …</p>")

    async def _send_file(self, request: Request) -> Response:
        from aiohttp import web

        kind = request.match_info["kind"]
        if kind not in KINDS:
            raise web.HTTPNotFound(text=f"there is no file of kind {kind!r:.40}\n")
        try:
            width, height = (int(request.query.get(side, 1000)) for side in ("width", "height"))
            shown = await self._apart(self.desk.shown, kind)
            if kind == "png":  # windows, also those off screen, belong to the main thread
                data = self.desk.save(kind, shown, (width, height))
            else:
                data = await self._apart(self.desk.save, kind, shown, (width, height))
        except (MeshdepictError, ValueError) as error:
            return web.Response(status=400, text=str(error))
        return _bytes(data, **{"X-File-Name": self.desk.name(kind)})

    # --- the session --------------------------------------------------------------------------

    async def _apart(self, work: Callable[..., Any], *arguments: Any) -> Any:
        return await self.loop.run_in_executor(self.worker, work, *arguments)

    def _change(self, client: str, serial: int, changes: list[Any]) -> None:
        """Take the page's changes, and answer at once: a long wait would look like a dead line."""
        self.queue.put_nowait((str(client), int(serial), list(changes)))

    async def _work(self) -> None:
        """Make changes in the order they came in, and tell every page what there is now."""
        while True:
            client, serial, changes = await self.queue.get()
            try:
                message = await self._apart(self.desk.apply, changes)
                look, home = await self._apart(lambda: (self.desk.look(), self.desk.home()))
            except Exception as error:  # a fault of ours: the page says so and goes on
                message, look, home = f"{type(error).__name__}: {error}", None, None
                complain(message)
            with self.trame.state as state:
                if look is not None:
                    state.look = look
                if self.desk.session.z_factor != self.z_factor:
                    times = self.desk.session.z_factor / self.z_factor
                    self.z_factor = self.desk.session.z_factor
                    state.mesh = raised(state.mesh, times)
                if ["reset"] in changes and home is not None:
                    state.home = {**home, "count": state.home["count"] + 1}
                if not message and self.desk.session.colors is not self.shown:
                    self.shown = self.desk.session.colors
                    self.colors = self.shown.tobytes()
                    state.revision += 1
                state.texture = self.desk.looks.number
                state.message, state.progress = message, 0.0
                state.applied = {client: serial}

    def _progress(self, done: float, total: float) -> None:
        """Tell the page how far a scale space is; called on the session's thread."""
        if self.stopping:
            raise _StoppedError
        if time.monotonic() - self.told > 0.2:
            self.told = time.monotonic()
            self.loop.call_soon_threadsafe(self._tell, done / total if total else 0.0)

    def _tell(self, share: float) -> None:
        with self.trame.state as state:
            state.progress = share


def _bytes(data: bytes, **headers: str) -> Response:
    from aiohttp import web

    return web.Response(body=data, content_type="application/octet-stream", headers=headers)


@contextmanager
def _arguments(line: str) -> Iterator[None]:
    """Let trame read these arguments instead of this program's or the environment's."""
    before = os.environ.get("TRAME_ARGS")
    os.environ["TRAME_ARGS"] = line
    try:
        yield
    finally:
        del os.environ["TRAME_ARGS"]
        if before is not None:
            os.environ["TRAME_ARGS"] = before
