"""Figures of Light Warping (Vergne et al. 2009), per pixel."""

from __future__ import annotations

import numpy as np
from figure_parts import Shot, Stage, crop, figure, page
from PIL import Image

from meshdepict.scene.material import AshikhminShirley, Toon

GLOSSY = AshikhminShirley(diffuse=0.35, reflectance=0.25, shininess=60.0)


@figure("Curvature as the view sees it: from afar only what is coarse, and of a chosen fineness")
def lw6(stage: Stage) -> Image.Image:
    far, near = (stage.look("armadillo", zoom=zoom) for zoom in (0.4, 1.0))
    seen = [shot.shaded(shot.descriptor(4), "view_curvature", gain=8.0) for shot in (far, near)]
    first = [
        ("from afar", seen[0]), ("from afar, enlarged", crop(seen[0], (0.3, 0.3, 0.7, 0.7))),
        ("near", seen[1]),
    ]  # fmt: skip
    close = stage.look("armadillo", zoom=3.5, centre=(0.0, 0.6))
    x, y, _ = close.buffer.view.frame @ (close.buffer.points - close.buffer.view.focus).T
    away = np.hypot(x, y + 0.1 * close.buffer.view.parallel_scale)
    importance = np.exp(-((away / (0.35 * close.buffer.view.parallel_scale)) ** 2))
    steps = 60
    second = [
        ("fine everywhere", close.descriptor(4)),
        (f"{steps} steps everywhere", close.descriptor(steps)),
        ("fine at the mouth", close.descriptor(steps, importance=importance)),
    ]
    shown = [(name, close.shaded(s, "view_curvature", gain=20.0)) for name, s in second]
    return page([first, shown])


@figure("The armadillo, matt and glossy, under two environments: original and warped")
def lw9(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo")
    space = shot.descriptor(6)
    rows = []
    for name, material in (("diffuse", "lambert"), ("glossy", GLOSSY)):
        row = []
        for sky in ("grace_256x128", "ennis_256x128"):
            light = shot.environment(sky)
            for words, magnitude in (("original", 0.0), ("warped", 8.0)):
                shaded = shot.shaded(
                    space, "light_warping", light, material=material, magnitude=magnitude,
                    lights=128,
                )  # fmt: skip
                row.append((f"{name}, {sky.split('_')[0]}\n{words}", shaded))
        rows.append(row)
    vertices = shot.vertices(scales=1)
    rows.append([
        (words, shot.shaded(
            vertices, "light_warping", illumination="occlusion", rays=64, magnitude=m
        ))
        for words, m in (("ambient occlusion,\non vertices", 0.0), ("the same, warped", 8.0))
    ])  # fmt: skip
    return page(rows)


@figure("Contrast by curvature (eq. 3), in natural and in minimal light, and as a cartoon")
def lw10(stage: Stage) -> Image.Image:
    shot = stage.look("lucy", zoom=2.0, centre=(0.0, 0.35))
    space = shot.descriptor(6)
    rows = []
    for style, material in (("shaded", "lambert"), ("cartoon", Toon(bins=5, sharpness=12.0))):
        row = []
        for name, light, exposure in (
            ("natural", shot.environment("studio_small_03_1k"), 1.0), ("minimal", "northwest", 0.9)
        ):  # fmt: skip
            for magnitude, contrast in ((0.0, 0.0), (8.0, 0.0), (8.0, -0.7)):
                shaded = shot.shaded(
                    space, "light_warping", light, material=material, lights=128,
                    magnitude=magnitude, contrast=contrast, exposure=exposure,
                )  # fmt: skip
                row.append((f"{name} light, {style}\nα = {magnitude:g}, γ = {contrast:g}", shaded))
        rows.append(row)
    return page([rows[0][:3], rows[0][3:], rows[1][:3], rows[1][3:]])


@figure("Beside exaggerated shading, and beside 3D unsharp masking")
def lw11(stage: Stage) -> Image.Image:
    rows = []
    for name, zoom, centre in (("dragon", 1.0, (0, 0)), ("armadillo", 2.5, (0.0, 0.4))):
        shot = stage.look(name, zoom=zoom, centre=centre)
        light, space = shot.environment("grace_256x128"), shot.descriptor(6)

        def warped(material, magnitude, contrast, shot=shot, light=light, space=space):
            return shot.values(
                space, "light_warping", light, material=material, magnitude=magnitude,
                contrast=contrast, lights=128,
            )  # fmt: skip

        plain = warped(GLOSSY, 0.0, 0.0)
        rows.append([
            ("exaggerated shading", shot.shaded(
                shot.vertices(scales=9), "exaggerated", exaggeration=25.0
            )),
            ("light warping, diffuse", shot.picture(warped("lambert", 8.0, -0.4), linear=True)),
            ("glossy, plain", shot.picture(plain, linear=True)),
            ("3D unsharp masking", shot.picture(unsharp(shot, plain), linear=True)),
            ("light warping, glossy", shot.picture(warped(GLOSSY, 8.0, -0.4), linear=True)),
        ])  # fmt: skip
    return page(rows)


def unsharp(shot: Shot, values: np.ndarray) -> np.ndarray:
    """Return clamp(c + k(c − c_σ)) of any shading, channel by channel; the package's is Lambert."""
    space = shot.pixels(filter="none")
    width = 6 * shot.buffer.edge_length
    values = values.reshape(len(values), -1)
    blurred = np.stack([space.mean(channel, width) for channel in values.T], axis=1)
    return np.clip(values + (values - blurred), 0, 1)
