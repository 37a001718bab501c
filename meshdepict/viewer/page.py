"""One self-contained page that shows a bake: opens from a disk, offline, and turns.

The page carries a small viewer of its own (``web/mesh_view.js``). For the Stanford bunny it is
0.7 MB; the same through PyVista's ``export_html``, which brings all of vtk.js, is 3.0 MB.
"""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict.files.atomic import atomic_write
from meshdepict.viewer.packing import pack_mesh, sight

if TYPE_CHECKING:
    from meshdepict.baking.baked import Baked

__all__ = ["WEB", "save_page"]

WEB = Path(__file__).with_name("web")

_IN_CAPTION = ("light", "options", "scales", "colormap")


def save_page(baked: Baked, path: str | Path) -> Path:
    """Write a bake as one HTML file that loads nothing else.

    It shows the colours exactly, without lighting, in the bake's view (in parallel projection),
    with a caption from the provenance; mouse, touch and keys turn it. Positions are rounded to
    1/65535 of the longest side.

    Raises
    ------
    MeshdepictError
        Where the file can't be written.
    """
    path = Path(path)
    packed, info = pack_mesh(baked.mesh)
    method = baked.provenance["method"].replace("_", " ")
    name = path.stem.encode(errors="replace").decode()  # a file's name need not be text
    parts = {
        "TITLE": html.escape(f"{name} – {method}"),
        "NAME": html.escape(name),
        "METHOD": html.escape(method),
        "CAPTION": _terms({key: baked.provenance.get(key, "") for key in _IN_CAPTION}),
        "PROVENANCE": _terms(baked.provenance),
        "STYLE": _text("page.css"),
        "VIEWER": _text("mesh_view.js"),
        "INFO": _json({**info, **sight(baked.view)}),
        "MESH": _deflated(packed),
        "COLORS": _deflated(baked.colors.tobytes()),
    }
    # Cut first, then filled: what is filled in is never searched for marks.
    pieces = _text("page.html").split("%%")
    pieces[1::2] = [parts[name] for name in pieces[1::2]]
    with atomic_write(path) as file:
        for piece in pieces:
            file.write(piece.encode())
    return path


def _text(name: str) -> str:
    return (WEB / name).read_text(encoding="utf-8")


def _deflated(data: bytes) -> str:
    return base64.b64encode(zlib.compress(data, 9)).decode()


def _json(value: object) -> str:
    return json.dumps(value).replace("<", "\\u003c")  # nothing can end the script element


def _terms(table: Mapping[str, str]) -> str:
    """Return a table as terms and their descriptions."""
    return "".join(
        f"<div><dt>{html.escape(key)}</dt><dd>{html.escape(_as_text(text))}</dd></div>"
        for key, text in table.items()
        if text
    )


def _as_text(text: str) -> str:
    return text.encode(errors="replace").decode()
