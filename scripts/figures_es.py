"""Figures of Exaggerated Shading (Rusinkiewicz, Burns and DeCarlo 2006), in object space."""

from __future__ import annotations

import numpy as np
from figure_parts import Stage, figure, page
from PIL import Image

from meshdepict.shading.bands import band_weights
from meshdepict.shading.exaggerated import local_light, soft_toon

WEST = np.array([-1.0, 1.0, 0.0]) / 2**0.5  # northwest, level, as for maps
NORTHWEST = np.array([-1.0, 1.0, 1.0]) / 3**0.5


@figure("A golf ball: diffuse, and exaggerated")
def es1(stage: Stage) -> Image.Image:
    shot = stage.look("golf ball")
    space = shot.vertices(scales=9)
    facing = shot.buffer.normals @ NORTHWEST
    places = {"towards": facing > 0.9, "away": facing < -0.2}
    row = []
    for words, values in (
        ("diffuse", shot.buffer.sample(0.5 + 0.5 * space.normals[0] @ NORTHWEST)),
        ("exaggerated, a = 40", shot.values(space, "exaggerated", NORTHWEST, exaggeration=40.0)),
        ("fitted to the shape, the default", shot.values(space, "exaggerated", NORTHWEST)),
    ):
        spread = ", ".join(f"{name} {values[here].std():.2f}" for name, here in places.items())
        shown = shot.picture(values, colormap="gooch")
        row.append((f"{words}\ncontrast, facing the light: {spread}", shown))
    return page([row])


@figure("Local lighting models on a sphere and on ridges: diffuse, scaled height, soft toon")
def es3(stage: Stage) -> Image.Image:
    steep = (5.0, 5.0, 1.0)

    def scaled(normals):
        normals = normals * steep
        return 0.5 + 0.5 * normals @ WEST / np.linalg.norm(normals, axis=1)

    models = {
        "diffuse, ½ + ½ n·l": lambda normals: 0.5 + 0.5 * normals @ WEST,
        "height × 5": scaled,
        "soft toon, a = 12": lambda normals: 0.5 + 0.5 * soft_toon(normals @ WEST, 12.0),
    }
    sphere, ridges = stage.look("sphere"), stage.look("ridges")
    flank = ridges.buffer.points
    distance = np.hypot(flank[:, 0], flank[:, 1])
    place = (np.degrees(np.arctan2(flank[:, 1], flank[:, 0])) % 360 + 7.5) // 15 % 24
    ring = (distance > 0.7) & (distance < 0.8)
    rows = [[], []]
    for name, model in models.items():
        values = model(ridges.buffer.normals)
        contrast = [np.ptp(values[ring & (place == i)]) for i in range(24)]
        equal = sum(c > 0.9 * max(contrast) for c in contrast)
        words = (
            f"contrast of 24 ridges {min(contrast):.2f} … {max(contrast):.2f},\n"
            f"{equal} within 10 % of the best"
        )
        rows[0].append((name, sphere.picture(model(sphere.buffer.normals))))
        rows[1].append((words, ridges.picture(values)))
    return page(rows)


@figure("What result the base coat and the detail of every scale add up to")
def es5(stage: Stage) -> Image.Image:
    exaggeration, scales = 25.0, 8
    shot = stage.look("armadillo")
    space = shot.vertices(scales=scales)
    weights = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
    base = space.normals[scales] @ NORTHWEST
    terms = [
        soft_toon(
            np.sum(space.normals[i] * local_light(NORTHWEST, space.normals[i + 1]), axis=1),
            exaggeration,
        )
        for i in range(scales)
    ]
    total = (1 + weights[-1] * base + weights[:-1] @ terms) / 2
    ours = shot.values(space, "exaggerated", NORTHWEST, exaggeration=exaggeration)
    off = np.abs(shot.buffer.sample(np.clip(total, 0, 1)) - ours).max()
    shown = [("base coat", shot.picture(shot.buffer.sample(0.5 + 0.5 * base)))]
    for i in reversed(range(0, scales, 2)):
        caption = f"detail {i}, σ = {space.widths[i] / space.widths[1]:.3g} edges"
        shown.append((caption, shot.picture(shot.buffer.sample(0.5 + 0.5 * terms[i]))))
    sums = ("weighted sum", shot.picture(shot.buffer.sample(np.clip(total, 0, 1))))
    whole = (f"exaggerated(): off by {off:.0e}", shot.picture(ours))
    return page([shown[:4], [*shown[4:], sums, whole]])


@figure("The contribution of scales, by a power of their width")
def es6(stage: Stage) -> Image.Image:
    shot = stage.look("bunny")
    space = shot.vertices(scales=9)
    shown = [
        (f"k ∝ σ^{p:g}", shot.shaded(space, "exaggerated", exaggeration=25.0, emphasis=p))
        for p in (-1.0, -0.5, 0.0)
    ]
    return page([shown])


@figure("Light turned to the direction that bends most: ridges and valleys get sharper")
def es8(stage: Stage) -> Image.Image:
    shot = stage.look("lucy", zoom=3, centre=(0.05, 0.1))
    space = shot.vertices(scales=9)
    strengths = (0.0, 5.0, 20.0)
    shown = [
        shot.values(space, "exaggerated", exaggeration=15.0, principal_strength=s)
        for s in strengths
    ]
    change = np.clip(0.5 + 2 * (shown[-1] - shown[0]), 0, 1)
    row = [(f"s = {s:g} σ²", shot.picture(v)) for s, v in zip(strengths, shown, strict=True)]
    off = 255 * np.abs(shown[-1] - shown[0])
    row.append((f"difference × 4; mean {off.mean():.1f} grey levels", shot.picture(change)))
    return page([row[:2], row[2:]])
