"""The viewer in a browser: served by trame, on this machine only, for whoever has its address."""

from __future__ import annotations

from meshdepict.viewer.browser.server import serve

__all__ = ["serve"]
