"""Figures of Exaggerated Shading (Rusinkiewicz, Burns and DeCarlo 2006), in object space."""

from __future__ import annotations

import numpy as np
from figure_parts import Stage, drawing, figure, page
from PIL import Image
from scipy.ndimage import gaussian_filter1d

from meshdepict.color.colormaps2d import mix
from meshdepict.shading.bands import band_weights
from meshdepict.shading.exaggerated import local_light, soft_toon

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


@figure("On a profile: one light for all, and a light in the plane of the next smoother normal")
def es4(stage: Stage) -> Image.Image:
    from matplotlib.figure import Figure

    t = np.linspace(0, np.pi, 1801)
    points = (1 + 0.015 * np.cos(36 * t))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    tangents = np.gradient(points, t, axis=0)
    fine = np.stack([tangents[:, 1], -tangents[:, 0]], axis=1)
    fine /= np.linalg.norm(fine, axis=1, keepdims=True)
    smooth = gaussian_filter1d(fine, 100, axis=0)
    smooth /= np.linalg.norm(smooth, axis=1, keepdims=True)
    light = np.array([-1.0, 1.0]) / 2**0.5
    local = local_light(light, smooth)
    one = np.broadcast_to(light, fine.shape)
    drawn = Figure(figsize=(3 * stage.inches, 0.9 * stage.inches), layout="constrained")
    cells = drawn.subplots(1, 2)
    for axes, name, lights, shade in (
        (cells[0], "cosine", one, 0.5 + 0.5 * fine @ light),
        (cells[1], "soft toon, a = 4", local,
         0.5 + 0.5 * soft_toon(np.sum(fine * local, axis=1), 4.0)),
    ):  # fmt: skip
        axes.scatter(*points.T, c=shade, cmap="gray", vmin=0, vmax=1, s=14)
        for place in (200, 550, 900, 1250, 1600):
            for vectors, color in ((smooth, "tab:blue"), (lights, "tab:orange")):
                axes.arrow(*points[place], *(0.3 * vectors[place]), color=color, head_width=0.05)
        facing = np.degrees(t)
        contrast = [
            np.ptp(shade[(facing > at - 10) & (facing < at + 10)]) for at in (120, 90, 45, 15)
        ]
        words = ", ".join(f"{c:.2f}" for c in contrast)
        axes.set(
            title=f"{name}: contrast {words}", aspect="equal", xlim=(-1.45, 1.45),
            ylim=(-0.1, 1.45), xticks=[], yticks=[],
        )  # fmt: skip
        axes.title.set_fontsize(9)
        axes.set_facecolor("#c6cdd6")
    words = (
        "orange: the light; blue: the next smoother normal; contrast of the ripples\n"
        "15, 45, 90 and 120° round from where the surface faces the light"
    )
    return page([[(words, drawing(drawn))]])


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


@figure("Colour maps, the last two of two lights, from the northwest and from the northeast")
def es7(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo", zoom=2.0, centre=(0.0, 0.4))
    space = shot.vertices(scales=9)
    first, second = (
        shot.values(space, "exaggerated", light, exaggeration=25.0)
        for light in ("northwest", "northeast")
    )
    cells = [
        (name, shot.picture(first, colormap=name)) for name in ("gray", "sepia", "stone", "gooch")
    ]
    grey = np.abs(first - 0.5) < 0.05
    told = np.mean(np.abs(second - 0.5)[grey] > 0.1)
    for name in ("dusk", "swiss"):
        words = f"{name}: of what is grey in the first light,\n{told:.0%} is not in the second"
        cells.append((words, shot.picture(mix(first, second, name))))
    return page([cells[:3], cells[3:]])


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
