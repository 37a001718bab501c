"""Figures of Exaggerated Shading that are about terrain, on rasters of heights."""

from __future__ import annotations

import numpy as np
from figure_parts import BACKGROUND, Stage, detail, figure, page
from numpy.typing import NDArray
from PIL import Image

import meshdepict as md
from meshdepict import color, samples
from meshdepict.shading.exaggerated import soft_toon

LEVEL = np.array([-1.0, 1.0, 0.0]) / 2**0.5  # northwest, level, as the paper lights terrain
NORTHWEST = np.array([-1.0, 1.0, 1.0]) / 3**0.5
STEEPER = 5.0  # times the height, in the middle of fig. 3
RIDGES, TURN = 36, 5.0  # turned by so many degrees, so that one runs northwest

Floats = NDArray[np.floating]


def ground(stage: Stage) -> md.HeightField:
    """Return Mount St. Helens, or the procedural terrain."""
    if stage.folder is None:
        side = round(stage.vertices**0.5)
        return samples.terrain((side, side))
    return md.read_heightfield(stage.folder / "dem" / "dem_st_helens_30m.tif")


def ridges(side: int) -> md.HeightField:
    """Return a hill with ridges that radiate from it, 2 km wide: at 5, 15, … 135 … degrees."""
    along = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(along, -along)
    cos, sin = np.cos(np.radians(TURN)), np.sin(np.radians(TURN))
    x, y = cos * x + sin * y, cos * y - sin * x
    z = 1000 * samples.ridge_height(x, y, ridges=RIDGES, hill=0.15)
    step = 2000 / side
    return md.HeightField(z, transform=(step, 0, -1000, 0, -step, 1000))


def contrasts(field: md.HeightField, values: Floats) -> Floats:
    """Return the contrast of each ridge: between the means of ``values`` on its two flanks."""
    right, left = (
        np.array([values[one].mean() for one in flanks(field, side)]) for side in (-1, 1)
    )
    return np.abs(left - right)


def flanks(field: md.HeightField, side: int) -> list[NDArray[np.intp]]:
    """Return the samples on the steep part of each ridge's right (−1) or left flank, half way out.

    Ridges are counted from the east, counterclockwise; number 13 runs northwest.
    """
    east, north, _ = field.points.T / 1000
    away, turn = np.hypot(east, north), (np.degrees(np.arctan2(north, east)) - TURN) % 360
    between = 360 / RIDGES
    number = np.floor(turn / between + 0.5).astype(int) % RIDGES
    off = ((turn - between * number + 180) % 360 - 180) / between  # −½ … ½, from crest to crest
    ring = (away > 0.7) & (away < 0.8)
    steep = ring & (off * side > 0.15) & (off * side < 0.35)
    return [np.flatnonzero(steep & (number == each)) for each in range(RIDGES)]


def cosine(normals: Floats) -> Floats:
    """Shade by eq. 1."""
    return 0.5 + 0.5 * normals @ NORTHWEST


def scaled(normals: Floats) -> Floats:
    """Shade by eq. 1 after heights were multiplied, under the level light."""
    steep = normals * (STEEPER, STEEPER, 1)
    return 0.5 + 0.5 * steep @ LEVEL / np.linalg.norm(steep, axis=1)


def toon(normals: Floats, exaggeration: float) -> Floats:
    """Shade by eq. 2."""
    return 0.5 + 0.5 * soft_toon(normals @ LEVEL, exaggeration)


def shown(field: md.HeightField, values: Floats, size: int) -> Image.Image:
    """Return display values of the samples as a picture so many pixels wide."""
    raster = field.image(
        color.encode(np.asarray(values, np.float32), linear=False), background=BACKGROUND
    )
    high = round(size * raster.shape[0] / raster.shape[1])
    return Image.fromarray(raster).resize((size, high), Image.Resampling.LANCZOS)


@figure("Terrain: cosine, scaled height, soft toon, and several scales under one light")
def es2(stage: Stage) -> Image.Image:
    field = ground(stage)
    space = md.scale_space(field, scales=9)
    normals, broad = space.normals_at(0), space.normals_at(6)
    away = np.degrees(np.arctan2(broad[:, 1], broad[:, 0])) - 135  # from the light, round the map
    side = np.round(np.abs((away + 180) % 360 - 180) / 30)
    slopes = np.hypot(broad[:, 0], broad[:, 1]) > np.sin(np.radians(3))

    def several(**options: float) -> Floats:
        return md.shading.exaggerated(space, "northwest", one_light=True, **options)

    local = md.shading.exaggerated(space, LEVEL, exaggeration=25.0, base=4.0, one_light=False)
    cells = []
    for words, values in (
        ("cosine", cosine(normals)),
        (f"height × {STEEPER:g}", scaled(normals)),
        ("soft toon, a = 25", toon(normals, 25.0)),
        ("several scales as by hand: a = 3, k ∝ σ^0", several(exaggeration=3.0, emphasis=0.0)),
        ("several scales, fitted to the terrain", several()),
        ("more detail: local light, a = 25, k ∝ σ^−½", local),
    ):
        tones = ", ".join(
            f"{values[here].mean():.2f}" if (here := slopes & (side == i)).any() else "–"
            for i in range(7)
        )
        pixels = field.image(color.encode(np.asarray(values, np.float32), linear=False))
        dark = detail(pixels, field.valid)[slopes & (side > 3)]
        words += f"\nslopes 0, 30 … 180° from the light:\n{tones}"
        words += f"\ndetail away from the light {dark.std():.3f}"
        cells.append((words, shown(field, values, stage.size)))
    return page([cells[:3], cells[3:]])


@figure("Local lighting models on a sphere and on 36 ridges: diffuse, scaled height, soft toon")
def es3(stage: Stage) -> Image.Image:
    sphere, field = stage.look("sphere"), ridges(max(160, 3 * stage.size))
    space = md.scale_space(field, scales=5)
    normals = space.normals_at(0)
    rows = [[], []]
    several = md.shading.exaggerated(space, "northwest", one_light=True, exaggeration=25.0)
    round_ones = sphere.buffer.normals
    for name, ball, values in (
        ("diffuse, ½ + ½ n·l", cosine(round_ones), cosine(normals)),
        (f"height × {STEEPER:g}", scaled(round_ones), scaled(normals)),
        ("soft toon, a = 25", toon(round_ones, 25.0), toon(normals, 25.0)),
        ("soft toon at six scales, a = 25", None, several),
    ):
        found = contrasts(field, values)
        equal = int(np.sum(found > 0.8 * found.max()))
        words = (
            f"from side to side of {RIDGES} ridges {found.min():.2f} … {found.max():.2f},\n"
            f"{equal} within 20 % of the best"
        )
        if ball is not None:
            rows[0].append((name, sphere.picture(ball)))
        else:
            words = f"{name}\n{words}"
        rows[1].append((words, shown(field, values, stage.size)))
    return page(rows)
