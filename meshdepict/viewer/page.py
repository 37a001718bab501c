"""One self-contained page that shows a bake: opens from a disk, offline, and turns.

The page carries a small viewer of its own (``web/mesh_view.js``, ``web/appearance.js``). For the
Stanford bunny it is 0.7 MB; the same through PyVista's ``export_html``, which brings all of vtk.js,
is 3.0 MB.
"""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdepict.files.atomic import atomic_write
from meshdepict.viewer.packed_appearance import pack_appearance
from meshdepict.viewer.packing import pack_mesh, sight

if TYPE_CHECKING:
    from meshdepict.scene.view import View
    from meshdepict.shapes.appearance import Appearance
    from meshdepict.shapes.mesh import Mesh

__all__ = ["WEB", "save_page"]

WEB = Path(__file__).with_name("web")

_IN_CAPTION = ("light", "options", "scales", "colormap")


_TOOLS = ("appearance.js", "mesh_view.js")


def save_page(
    path: str | Path,
    mesh: Mesh,
    view: View,
    provenance: Mapping[str, str],
    appearances: Mapping[str, Appearance],
) -> Path:
    """Write a bake as one HTML file that loads nothing else.

    It shows the colours exactly, without lighting, in a view (in parallel projection), with a
    caption from the provenance; mouse, touch and keys turn it. Positions are rounded to 1/65535 of
    the longest side. A line parts it and another appearance, if there is any to choose.

    Parameters
    ----------
    path : str or Path
    mesh : Mesh
    view : View
    provenance : mapping of str
    appearances : mapping
        Of the mesh, by names for people: what is shown, and what it can be compared with.

    Raises
    ------
    MeshdepictError
        Where the file can't be written.
    """
    path = Path(path)
    packed, info = pack_mesh(mesh)
    looks, elements = _appearances(appearances.values())
    method = provenance["method"].replace("_", " ")
    name = path.stem.encode(errors="replace").decode()  # a file's name need not be text
    parts = {
        "TITLE": html.escape(f"{name} – {method}"),
        "NAME": html.escape(name),
        "METHOD": html.escape(method),
        "COMPARED": _compared(list(appearances)[1:]),
        "KEYS": " w: compare. [ ] or drag: line." if len(looks) > 1 else "",
        "CAPTION": _terms({key: provenance.get(key, "") for key in _IN_CAPTION}),
        "PROVENANCE": _terms(provenance),
        "STYLE": _text("page.css"),
        "VIEWER": "".join(map(_text, _TOOLS)),
        "INFO": _json({**info, **sight(view), "appearances": looks}),
        "MESH": _deflated(packed),
        "APPEARANCES": elements,
    }
    # Cut first, then filled: what is filled in is never searched for marks.
    pieces = _text("page.html").split("%%")
    pieces[1::2] = [parts[name] for name in pieces[1::2]]
    with atomic_write(path) as file:
        for piece in pieces:
            file.write(piece.encode())
    return path


def _appearances(appearances: Iterable[Appearance]) -> tuple[list[dict[str, Any]], str]:
    """Return what is said about appearances, and elements that hold them, each picture once."""
    looks, elements = [], []
    pictures: dict[bytes, str] = {}
    for number, appearance in enumerate(appearances):
        found = pack_appearance(appearance)
        for picture in found.pictures:
            if picture not in pictures:
                pictures[picture] = f"picture-{len(pictures)}"
                data = base64.b64encode(picture).decode()
                elements.append(_element(pictures[picture], data))
        looks.append({**found.info, "pictures": [pictures[each] for each in found.pictures]})
        elements.append(_element(f"appearance-{number}", _deflated(found.data)))
    return looks, "".join(elements)


def _element(name: str, data: str) -> str:
    return f'<script type="text/plain" id="{name}">{data}</script>\n'


def _compared(names: list[str]) -> str:
    """Return the control that chooses what lies to the left of a line; "" without any."""
    if not names:
        return ""
    options = "".join(
        f'<option value="{number}">{html.escape(name)}</option>'
        for number, name in enumerate(names, start=1)
    )
    return (
        '\n<label class="compared">compared with <select><option value="">nothing</option>'
        f"{options}</select></label>"
    )


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
