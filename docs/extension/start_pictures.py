"""The pictures of the first page that no method's page has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import strips
from PIL import Image
from sphinx.application import Sphinx

import meshdepict as md


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", draw)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def draw(app: Sphinx) -> None:
    """Write pictures/*.webp where they aren't there yet."""
    home = Path(app.srcdir) / "pictures"
    for name, method in (("before", "hillshade"), ("after", "exaggerated")):
        path = home / f"terrain-{name}.webp"
        if not path.exists():
            strips.save(strips.picture("terrain", method), path)
    head = None
    for name, method in (("before", "lambert"), ("after", "exaggerated")):
        path = home / f"ct-{name}.webp"
        if not path.exists():
            head = head or md.samples.ct_phantom((160, 160, 160))
            png = home / f"ct-{name}.png"
            md.bake_volume(head, method, transfer="bone").picture(png, size=(640, 640))
            strips.save(Image.open(png).convert("RGB"), path)
            png.unlink()
