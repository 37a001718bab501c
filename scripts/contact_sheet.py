"""Draw every method on one sheet per mesh: what a change did to any picture, at a glance.

    python scripts/contact_sheet.py scan.ply …                 # sheet-scan.png, …
    python scripts/contact_sheet.py lucy.ply --up z --size 300 --light 120,20 -o sheets/
    python scripts/contact_sheet.py scan.ply exaggerated lambert light_alignment

Needs no display. Methods share their scale spaces.
"""

from __future__ import annotations

import argparse
import tempfile
import warnings
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import meshdepict as md
from meshdepict.shading import METHODS, declaration

MARGIN = 8
BACKGROUND = (176, 190, 204)
# Beside every method as it is by default: settings that the papers' figures show.
EXTRA = {
    "light_alignment fig. 9": ("light_alignment", {"strength": (0.9, 0.6, 0.4, 0.2, 0.3)}),
    "light_alignment phong": ("light_alignment", {"material": "phong"}),
    "exaggerated a = 40": ("exaggerated", {"exaggeration": 40.0}),
    "exaggerated dusk": ("exaggerated", {"colormap2d": "dusk"}),
    "exaggerated gooch": ("exaggerated", {"colormap": "gooch"}),
    "sky_view 20°": ("sky_view", {"spread": 20.0}),
}


def pictures(
    mesh: md.Mesh, names: list[str], *, size: int, **look: object
) -> dict[str, Image.Image]:
    """Return a picture of the mesh per method, by caption; methods that fail are said so."""
    spaces: dict[tuple[int, float], md.ScaleSpace] = {}
    wanted = {name: (name, {}) for name in METHODS} | EXTRA
    found = {}
    for caption, (name, options) in wanted.items():
        if names and name not in names:
            continue
        declared = declaration(METHODS[name])
        key = (declared.scales, declared.ratio)
        if key not in spaces:
            spaces[key] = md.scale_space(
                mesh, scales=declared.scales, ratio=declared.ratio, tolerance=1e-3
            )
        try:
            baked = md.bake(spaces[key], name, **look, **options)
        except md.MeshdepictError as error:
            print(f"{caption}: {error}")
            continue
        found[caption] = picture(baked, size)
    # Where a bake in black leaves a picture white there is no object: white methods would get lost.
    black = md.bake(mesh, "half_lambert", exposure=0.0, **look)
    background = picture(black, size).convert("L").point(lambda level: 255 * (level > 250))
    for image in found.values():
        image.paste(BACKGROUND, mask=background)
    return found


def picture(baked: md.Baked, size: int) -> Image.Image:
    """Return what `Baked.picture` writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = baked.picture(Path(folder) / "one.png", size=(size, size))
        return Image.open(path).convert("RGB")


def sheet(found: dict[str, Image.Image], *, columns: int) -> Image.Image:
    """Return the pictures in rows, captions under them."""
    size = next(iter(found.values())).width
    font = ImageFont.load_default(size=max(10, size // 18))
    wide, high = size + MARGIN, size + MARGIN + size // 12
    rows = -(-len(found) // columns)
    page = Image.new("RGB", (columns * wide + MARGIN, rows * high + MARGIN), "white")
    draw = ImageDraw.Draw(page)
    for i, (caption, picture) in enumerate(found.items()):
        x, y = MARGIN + i % columns * wide, MARGIN + i // columns * high
        page.paste(picture, (x, y))
        draw.text((x + size / 2, y + size), caption, "black", font, anchor="ma")
    return page


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw every method on one sheet per mesh.")
    parser.add_argument("words", nargs="+", help="mesh files, and names of methods (default all)")
    parser.add_argument("-o", "--output", type=Path, default=Path(), help="folder")
    parser.add_argument("--light", default="northwest")
    parser.add_argument("--view", default="front")
    parser.add_argument("--up", default="y", choices=["y", "z"])
    parser.add_argument("--size", type=int, default=400, help="of a picture, in pixels")
    parser.add_argument("--columns", type=int, default=6)
    given = parser.parse_args()
    light = given.light
    if "," in light:
        light = tuple(float(number) for number in light.split(","))
    names = [word for word in given.words if word in METHODS]
    for path in (Path(word) for word in given.words if word not in METHODS):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", md.MeshdepictWarning)
            found = pictures(
                md.read_mesh(path), names,
                size=given.size, light=light, view=given.view, up=given.up,
            )  # fmt: skip
        output = given.output / f"sheet-{path.name.split('.')[0]}.png"
        sheet(found, columns=given.columns).save(output)
        print(output)


if __name__ == "__main__":
    main()
