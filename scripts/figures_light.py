"""Figures with shadows and light that bounces, shaded at vertices.

They are the second column of Light Warping's 9, Radiance Scaling's 10 and 11, and the last two of
Local Light Alignment's 11.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from figure_objects import vase
from figure_parts import BACKGROUND, SCANS, Stage, figure, mesh, page
from PIL import Image

import meshdepict as md
from meshdepict.scene.material import AshikhminShirley, Phong

SHINY = AshikhminShirley(diffuse=0.4, reflectance=0.25, shininess=60.0)
GLOSSY = Phong(ambient=0.0, diffuse=0.6, specular=0.4, shininess=30.0)
SEVEN = (0.9, 0.6, 0.4, 0.2, 0.3, 0.2)  # Local Light Alignment, fig. 9: the strengths, finest first
VIEW = "isometric"
GROUND = "#{:02x}{:02x}{:02x}".format(*BACKGROUND)


def shown(baked: Any, stage: Stage, *, wide: float = 1.0) -> Image.Image:
    """Return the picture of a bake, or of what was baked together."""
    with tempfile.TemporaryDirectory() as folder:
        size = f"{round(wide * stage.size)}x{stage.size}px"
        path = baked.picture(Path(folder) / "picture.png", size=size, background=GROUND)
        return Image.open(path).convert("RGB")


def sky(stage: Stage, name: str, share: float, *, turned: bool = False) -> md.Environment:
    """Return an environment, times a share; turned, with what was behind the object before it."""
    if stage.folder is None:
        rows, columns = np.mgrid[0:32, 0:64]
        sun = np.exp(-((rows - 8) ** 2 + (columns - 44) ** 2) / 8.0)
        return md.Environment((0.2 + 9 * sun)[..., None] * [1, 0.9, 0.8] * share, name="sun")
    found = md.Environment.from_file(stage.folder / "env" / f"{name}.hdr")
    pixels = np.roll(found.pixels, turned * found.pixels.shape[1] // 2, axis=1)
    return md.Environment(pixels * np.float32(share), name=name)


def scan(stage: Stage, name: str) -> md.Mesh:
    """Return a scan that stands upright along y."""
    found = mesh(name, stage.folder, stage.vertices)
    if stage.folder is not None and SCANS[name][2] == "z":
        turned = found.vertices[:, [0, 2, 1]] * [1, 1, -1]
        return md.Mesh(turned, found.faces)
    return found


@figure("The armadillo in global illumination, matt and glossy: original and warped")
def lw9gi(stage: Stage) -> Image.Image:
    armadillo, rows = scan(stage, "armadillo"), []
    for name, material in (("matt", "lambert"), ("glossy", GLOSSY)):
        row = []
        for place, share in (("grace_256x128", 1.0), ("ennis_256x128", 0.12)):
            for words, magnitude in (("original", 0.0), ("warped", 14.0)):
                baked = md.bake(
                    armadillo, "light_warping", light=sky(stage, place, share, turned=True),
                    bounces=3, shadows=True, material=material, magnitude=magnitude, rays=128,
                )  # fmt: skip
                row.append((f"{name}, {place.split('_')[0]}\n{words}", shown(baked, stage)))
        rows.append(row)
    return page(rows)


@figure(
    "A dragon beside a vase that mirrors it, on a mirror: scaled nowhere, at the eye, everywhere"
)
def rs10(stage: Stage) -> Image.Image:
    dragon = scan(stage, "dragon")
    beside = vase(dragon)
    row = []
    for words, magnitude, enhance in (
        ("without", 0.0, "first"), ("first bounce", 8.0, "first"), ("all bounces", 8.0, "all")
    ):  # fmt: skip
        objects = [
            (dragon, {"material": SHINY, "magnitude": magnitude}),
            (beside, {"material": "mirror", "magnitude": 0.0}),
        ]
        baked = md.bake_together(
            objects, "radiance_scaling", light=sky(stage, "venice_sunset_1k", 0.5), view=VIEW,
            ground="mirror", shadows=True, bounces=2, enhance=enhance,
        )  # fmt: skip
        picture = shown(baked, stage.larger(2), wide=1.5)
        wide, high = picture.size
        row.append((words, picture.crop((wide // 4, high // 8, wide * 3 // 4, high * 7 // 8))))
    return page([row])


@figure("The dragon under a light of 25° on a matt ground: original and scaled")
def rs11(stage: Stage) -> Image.Image:
    dragon, row = scan(stage, "dragon"), []
    for words, magnitude in (("original", 0.0), ("scaled", 8.0)):
        baked = md.bake(
            dragon, "radiance_scaling", light="northwest:25", view=VIEW, ground="matt",
            shadows=True, bounces=1, magnitude=magnitude, rays=256,
        )  # fmt: skip
        row.append((words, shown(baked, stage, wide=1.5)))
    return page([row])


@figure("Matt and frosted glass in global illumination: original and aligned")
def lla11gi(stage: Stage) -> Image.Image:
    rows = []
    for name, words, options in (
        ("bunny", "matt, three bounces", {"bounces": 3}),
        ("armadillo", "frosted, two interfaces", {
            "bounces": 2, "interfaces": 2, "transmitted": 1.0, "background": 1.0, "diffuse": 0.15,
            "frosting": 0.25,
        }),
    ):  # fmt: skip
        row = []
        for kind, strength in (("original", 0.0), ("enhanced", SEVEN)):
            baked = md.bake(
                scan(stage, name), "light_alignment", light=sky(stage, "venice_sunset_1k", 0.5),
                shadows=True, scales=6, strength=strength, transmitted_strength=strength, rays=128,
                **options,
            )  # fmt: skip
            row.append((f"{name}, {words}\n{kind}", shown(baked, stage)))
        rows.append(row)
    return page([rows[0] + rows[1]])
