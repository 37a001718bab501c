"""Who may come in: requests from this machine's own browser that know the token.

Other people on the machine lack the token. Other pages in the same browser lack the cookie
(SameSite), have another Origin, and, where they point a name of their own at 127.0.0.1, another
Host.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from aiohttp.typedefs import Handler, Middleware
    from aiohttp.web import Request, StreamResponse

__all__ = ["Gate"]

_REFUSAL = "This page is for whoever started it: open the address that meshdepict printed.\n"


class Gate:
    """Middleware that demands a token for everything, pages and web sockets alike.

    Parameters
    ----------
    token : str
    port : callable
        Returns the port, which is known only once the server listens.
    """

    def __init__(self, token: str, port: Callable[[], int]) -> None:
        self.token = token
        self._port = port

    @property
    def hosts(self) -> tuple[str, str]:
        """What a browser on this machine calls the server."""
        return f"127.0.0.1:{self._port()}", f"localhost:{self._port()}"

    @property
    def cookie(self) -> str:
        """The cookie's name; other ports of this machine share cookies."""
        return f"meshdepict-{self._port()}"

    @property
    def address(self) -> str:
        """What a person opens."""
        return f"http://{self.hosts[0]}/?token={self.token}"

    def middleware(self) -> Middleware:
        """Return the middleware for aiohttp."""
        from aiohttp import web

        @web.middleware
        async def guard(request: Request, handler: Handler) -> StreamResponse:
            if request.method not in ("GET", "HEAD") or not self._admits(request):
                return web.Response(status=403, text=_REFUSAL, headers=self._headers())
            page = self._page(request.host)
            if request.path in ("/", "/index.html") and request.path_qs != page:
                response: StreamResponse = web.Response(status=302, headers={"Location": page})
            else:
                response = await handler(request)
            if not response.prepared:  # a web socket's is under way
                response.headers.update(self._headers())
                response.set_cookie(self.cookie, self.token, httponly=True, samesite="Strict")
            return response

        return guard

    def _admits(self, request: Request) -> bool:
        host, origin = request.headers.get("Host"), request.headers.get("Origin")
        if host not in self.hosts or origin not in (None, f"http://{host}"):
            return False
        query = request.query
        words = request.cookies.get(self.cookie), query.get("token"), query.get("secret")
        return any(map(self._same, words))

    def _page(self, host: str) -> str:
        """Return where trame's client is told its secret and its socket; it forgets them later."""
        return f"/index.html?secret={self.token}&sessionURL=ws://{host}/ws"

    def _same(self, word: str | None) -> bool:
        return word is not None and secrets.compare_digest(word.encode(), self.token.encode())

    def _headers(self) -> dict[str, str]:
        """Return headers by which the browser itself loads nothing from elsewhere."""
        sockets = " ".join(f"ws://{host}" for host in self.hosts)
        return {
            "Content-Security-Policy": (
                # Vue compiles its templates in the page: hence unsafe-eval.
                "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; "
                "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
                f"connect-src 'self' {sockets}; frame-ancestors 'none'; form-action 'none'"
            ),
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "Cache-Control": "no-store",
        }
