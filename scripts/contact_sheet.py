"""Draw every method as it is by default on every object given: one sheet, and a table of numbers.

    python scripts/contact_sheet.py                      # the package's own samples
    python scripts/contact_sheet.py scan.ply lucy.ply@z/back -o sheet.png --table
    python scripts/contact_sheet.py scan.ply --method exaggerated --method lambert --extra

After an @ stands which axis is up, and after a stroke the view. Rows are objects, columns methods.
Needs no display: pixels take what vertices have. Every cell of the table has the shares of the
pixels that are black and white (within 8 of 255 levels), in percent, the correlation of the
picture's broad tone with that of half-Lambert under the northwest light, and the picture's
standard deviation.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from scipy.ndimage import gaussian_filter
from tables import head, row

import meshdepict as md
from meshdepict import color, samples
from meshdepict.scene.names import as_light
from meshdepict.scene.view import View
from meshdepict.shading import METHODS, declaration
from meshdepict.shapes.isosurface import isosurface

MARGIN = 4
BACKGROUND = (176, 190, 204)
BROAD = 0.03  # width of the blur that leaves a broad tone, in heights of the picture
# Beside every method as it is by default: settings that the papers' figures show.
EXTRA = {
    "exaggerated a = 25": ("exaggerated", {"exaggeration": 25.0}),
    "light_alignment one light": ("light_alignment", {"light": "northwest", "strength": 0.4}),
    "light_alignment phong": ("light_alignment", {"material": "phong"}),
    "light_warping one light": ("light_warping", {"light": "northwest"}),
    "sky_view 20°": ("sky_view", {"spread": 20.0}),
}


def ellipsoid() -> md.Mesh:
    """Return a smooth find: semi-axes 1, 1.4 and 0.8."""
    ball = samples.sphere(10_000)
    return md.Mesh(ball.vertices * [1.0, 1.4, 0.8], ball.faces)


OWN: dict[str, tuple[Callable[[], md.Mesh], str, str]] = {
    "golf ball": (lambda: samples.golf_ball(12_000), "y", "front"),
    "ellipsoid": (ellipsoid, "y", "front"),
    "torus": (lambda: samples.torus(12_000), "z", "isometric"),
    "ridges": (lambda: samples.radiating_ridges(20_000, hill=0.15), "z", "top"),
    "CT phantom": (lambda: isosurface(samples.ct_phantom((72, 72, 72)), 500.0), "z", "front"),
}


class Seen:
    """An object in a view, with the scale spaces that methods share."""

    def __init__(self, mesh: md.Mesh, up: str, view: str, size: int) -> None:
        self.mesh = mesh
        eye = View.fitted(view, mesh, up=up, height_px=size)
        self.buffer = md.GBuffer.of(mesh, eye, size=(size, size))
        self.view = self.buffer.view
        self._spaces: dict[tuple[int, float], md.ScaleSpace] = {}
        lambert = md.shading.half_lambert(self._space(0, 2.0), as_light("northwest", self.view))
        self.reference = self._broad(self.buffer.sample(lambert))

    def bake(self, method: str, **chosen: Any) -> md.Baked:
        """Bake by a method, with what it declares where nothing is chosen."""
        declared = declaration(METHODS[method])
        space = self._space(declared.scales, declared.ratio)
        return md.bake(space, method, view=self.view, **chosen)

    def picture(self, baked: md.Baked) -> Image.Image:
        """Return its colours at the pixels."""
        levels = self.buffer.sample(baked.colors.astype(float)).round().astype(np.uint8)
        return Image.fromarray(self.buffer.image(levels, background=BACKGROUND))

    def numbers(self, baked: md.Baked, *, linear: bool) -> str:
        """Return what the table has of a picture."""
        shown = self.buffer.sample(baked.intensity)
        shown = color.linear_to_srgb(shown) if linear else shown
        shown = shown if shown.ndim == 1 else shown @ [0.2126, 0.7152, 0.0722]
        black, white = (100 * np.mean(far) for far in (shown < 8 / 255, shown > 247 / 255))
        broad, spread = self._broad(shown), shown.std()
        flat = spread < 1e-6 or broad.std() < 1e-6
        follows = 0.0 if flat else np.corrcoef(broad, self.reference)[0, 1]
        return f"{black:.0f}/{white:.0f} · {follows:.2f} · {spread:.2f}"

    def _space(self, scales: int, ratio: float) -> md.ScaleSpace:
        key = scales, ratio
        if key not in self._spaces:
            self._spaces[key] = md.scale_space(self.mesh, scales=scales, ratio=ratio)
        return self._spaces[key]

    def _broad(self, values: np.ndarray) -> np.ndarray:
        """Return values blurred in the picture, over the object alone."""
        width = BROAD * self.view.height_px
        covered = gaussian_filter(self.buffer.mask.astype(float), width)
        blurred = gaussian_filter(self.buffer.image(values.astype(float)), width)
        return (blurred / np.maximum(covered, 1e-9))[self.buffer.mask]


def objects(words: list[str], size: int) -> Iterator[tuple[str, Seen]]:
    """Yield names and objects: files, or the package's own samples."""
    for name, (make, up, view) in () if words else OWN.items():
        yield name, Seen(make(), up, view, size)
    for word in words:
        path, _, how = word.partition("@")
        up, _, view = how.partition("/")
        mesh = md.read_mesh(path)
        yield Path(path).name.split(".")[0], Seen(mesh, up or "y", view or "front", size)


def sheet(rows: dict[str, list[Image.Image]], captions: list[str]) -> Image.Image:
    """Return the pictures in rows, captions over the columns."""
    size = next(iter(rows.values()))[0].width
    font = ImageFont.load_default(size=max(9, size // 11))
    wide, top = size + MARGIN, size // 3
    page = Image.new("RGB", (len(captions) * wide + MARGIN, top + len(rows) * wide), "white")
    draw = ImageDraw.Draw(page)
    for i, caption in enumerate(captions):
        text = caption.replace("_", "\n").replace(" ", "\n")
        draw.multiline_text(
            (MARGIN + i * wide + size / 2, top - MARGIN), text, "black", font, anchor="md",
            align="center", spacing=1,
        )  # fmt: skip
        for j, pictures in enumerate(rows.values()):
            page.paste(pictures[i], (MARGIN + i * wide, top + j * wide))
    return page


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", help="FILE, FILE@UP or FILE@UP/VIEW")
    parser.add_argument("-o", "--output", type=Path, default=Path("contact_sheet.jpg"))
    parser.add_argument("--table", action="store_true", help="print the numbers as Markdown")
    parser.add_argument("--method", action="append", help="one of those to draw; all unless given")
    parser.add_argument("--extra", action="store_true", help="also settings of the papers' figures")
    parser.add_argument("--size", type=int, default=320, help="of a picture, in pixels")
    parser.add_argument("--shown", type=int, help="size on the sheet; as they are unless given")
    given = parser.parse_args()
    wanted: dict[str, tuple[str, dict[str, Any]]] = {
        name: (name, {})
        for name in given.method
        or [name for name in METHODS if "heights" not in declaration(METHODS[name]).needs]
    }
    wanted |= EXTRA if given.extra else {}
    pictures: dict[str, list[Image.Image]] = {}
    table: dict[str, list[str]] = {caption: [] for caption in wanted}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", md.MeshdepictWarning)
        for name, seen in objects(given.files, given.size):
            pictures[name] = []
            for caption, (method, chosen) in wanted.items():
                baked = seen.bake(method, **chosen)
                linear = declaration(METHODS[method]).linear
                table[caption].append(seen.numbers(baked, linear=linear))
                drawn = seen.picture(baked)
                side = given.shown or given.size
                pictures[name].append(drawn.resize((side, side), Image.Resampling.LANCZOS))
    page = sheet(pictures, list(wanted))
    page.save(given.output, quality=88, optimize=True)
    if given.table:
        head("method", *pictures)
        for caption, cells in table.items():
            row(caption, *cells)
    else:
        print(given.output)


if __name__ == "__main__":
    main()
