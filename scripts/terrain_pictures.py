"""Draw the pictures of docs/terrain.md: what methods show of a volcano and of old fields.

    MESHDEPICT_DATA=data python scripts/terrain_pictures.py -o docs/

Mount St. Helens is a model of the U.S. Geological Survey, of which the folder of real data has a
copy (dem/); the fields are the package's own.
"""

from __future__ import annotations

import argparse
import os
import warnings
from pathlib import Path

import numpy as np
from figure_parts import page
from PIL import Image

import meshdepict as md

HORN = (315, 45)
FIRST = {"hillshade": {"light": HORN}, "exaggerated": {}}
VOLCANO = {
    "hillshade": {"light": HORN},
    "multidirectional_hillshade": {},
    "exaggerated": {},
    "texture_shading": {},
    "sky_view": {"radius": 20},
    "positive_openness": {"radius": 20},
    "negative_openness": {"radius": 20},
    "topographic_position": {},
}
FIELDS = {
    "hillshade": {"light": HORN},
    "exaggerated": {},
    "local_dominance": {},
    "integral_invariant": {"radius": 6.0},
}


def shaded(field: md.HeightField, method: str, **chosen: object) -> Image.Image:
    """Return the relief of a field, white where it has no height."""
    baked = md.bake(field, method, **chosen)
    return Image.fromarray(field.image(baked.colors, background=255))


def strip(field: md.HeightField, looks: dict[str, dict], side: int, columns: int) -> Image.Image:
    """Return what methods make of a field, in rows, so many pixels high each."""
    cells = []
    for method, chosen in looks.items():
        picture = shaded(field, method, **chosen)
        wide = round(picture.width * side / picture.height)
        cells.append((method, picture.resize((wide, side), Image.Resampling.LANCZOS)))
    return page([cells[k : k + columns] for k in range(0, len(cells), columns)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("docs"), help="folder")
    given = parser.parse_args()
    if "MESHDEPICT_DATA" not in os.environ:
        parser.error("set MESHDEPICT_DATA to the folder of real data")
    warnings.simplefilter("ignore", md.MeshdepictWarning)
    volcano = md.read_heightfield(
        Path(os.environ["MESHDEPICT_DATA"], "dem", "dem_st_helens_30m.tif")
    )
    fields = md.samples.terrain()
    crater = volcano.window(slice(60, 400), slice(20, 310))
    sheets = {
        "terrain_first": strip(crater, FIRST, 340, 2),
        "terrain_volcano": strip(volcano, VOLCANO, 200, 4),
        "terrain_fields": strip(fields, FIELDS, 240, 4),
    }
    for name, picture in sheets.items():
        path = given.output / f"{name}.jpg"
        picture.convert("RGB").save(path, quality=66, optimize=True)
        print(f"{path}: {path.stat().st_size / 1000:.0f} kB, {picture.size}")
        assert np.asarray(picture).std() > 0


if __name__ == "__main__":
    main()
