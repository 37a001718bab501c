"""Figures of Exaggerated Shading in use: attention, volumes, manuscripts, faces, comparisons."""

from __future__ import annotations

from typing import Any

import numpy as np
from figure_objects import head
from figure_parts import BACKGROUND, Shot, Stage, detail, figure, page
from numpy.typing import NDArray
from PIL import Image

import meshdepict as md
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.volume_picture import draw_volume
from meshdepict.shapes.gbuffer import GBuffer

FACE = 0.0, 0.3  # of Lucy, in the picture of ES 9
SHOWN = {"exaggeration": 25.0}  # the paper's figures have 25 to 50
METHODS = (
    ("diffuse", "half_lambert", {}),
    ("exaggerated, a = 25", "exaggerated", SHOWN),
)


@figure("Detail fades away from a point of interest, the finest first")
def es9(stage: Stage) -> Image.Image:
    shot = stage.look("lucy", zoom=2.0, centre=(0.0, 0.35))
    space = shot.vertices(scales=9)
    x, y, _ = shot.buffer.view.frame @ (shot.buffer.points - shot.buffer.view.focus).T
    half = shot.buffer.view.parallel_scale
    away = np.hypot(x - FACE[0] * half, y - FACE[1] * half)
    face = shot.buffer.points[np.argmin(away)]
    row = []
    for words, options in (
        ("everywhere", {}), ("at the face", {"focus": face, "radius": 0.06 * space.shape.diagonal})
    ):  # fmt: skip
        values = shot.values(space, "exaggerated", **SHOWN, **options)
        fine = shot.detail(values)
        near, far = (fine[where].std() for where in (away < 0.25 * half, away > 0.8 * half))
        row.append((f"{words}\ndetail near {near:.3f}, far {far:.3f}", shot.picture(values)))
    return page([row])


@figure("A CT head, skin and the skull's inside: conventional shading, and ours")
def es10(stage: Stage) -> Image.Image:
    volume, up = head(stage.folder, max(32, min(160, stage.size)))
    opened = volume if up == "-z" else volume.cropped(z=(0, 0.62))  # that one has no crown
    plain = Figure(size=(stage.size, stage.size), scale_bar=False, background="transparent")
    rows = []
    for shape, transfer, view in ((volume, "skin", "front"), (opened, "bone", "top")):
        baked = md.bake_volume(
            shape, transfer=transfer, view=view, up=up, tolerance=1e-3, scales=6, **SHOWN
        )
        row = []
        for words, conventional in (("conventional", True), ("exaggerated", False)):
            drawn = draw_volume(baked, plain, plain=conventional)
            pixels = np.asarray(drawn)
            spread = detail(pixels, pixels[..., 3] > 250).std()
            shown = Image.new("RGB", drawn.size, BACKGROUND)
            shown.paste(drawn, mask=drawn)
            row.append((f"{transfer}, {words}\ndetail {spread:.3f}", shown))
        rows.append(row)
    return page(rows)


@figure("Letters on a folded page, and a skull: diffuse, and ours")
def es11(stage: Stage) -> Image.Image:
    rows = []
    written, blank = stage.look("manuscript"), stage.look("blank page")
    space, empty = written.vertices(scales=9), blank.vertices(scales=9)
    row = []
    for words, method, options in METHODS:
        values = written.values(space, method, **options)
        there = np.abs(values - blank.values(empty, method, **options))
        letters = np.sort(there)[-len(there) // 4 :].mean()
        row.append(
            (f"{words}\nletters differ by {255 * letters:.0f} of 255", written.picture(values))
        )
    rows.append(row)
    shot = stage.look("skull")
    space = shot.vertices(scales=9)
    row = []
    for words, method, options in METHODS:
        values = shot.values(space, method, **options)
        row.append((f"{words}\ndetail {shot.detail(values).std():.3f}", shot.picture(values)))
    rows.append(row)
    return page(rows)


@figure("A face, with noise on it, and with wrinkles as high as the noise: diffuse, and ours")
def es12(stage: Stage) -> Image.Image:
    face = stage.look("nefertiti", zoom=2.6, centre=(0.0, 0.15))
    smooth = face.buffer.mesh
    normals = face.vertices(scales=0).normals_at(0)
    rng = np.random.default_rng(2006)
    height = 4e-4 * smooth.diagonal
    rows: list[list[tuple[str, Image.Image]]] = [[], []]
    first: dict[str, Any] = {}
    for name, field in (
        ("a) as scanned", 0.0), ("c) with noise", rng.standard_normal(len(smooth.vertices))),
        ("d) with wrinkles", wrinkles(face, rng)),
    ):  # fmt: skip
        aged = smooth.vertices + height * np.reshape(field, (-1, 1)) * normals
        shot = Shot(
            GBuffer.of(md.Mesh(aged, smooth.faces), face.buffer.view, size=face.buffer.size),
            up=face.up,
        )
        space = shot.vertices(scales=9)
        for row, (words, method, options) in zip(rows, METHODS, strict=True):
            values = shot.values(space, method, **options)
            picture = shot.picture(values)
            tones = shot.buffer.image(values)
            off = 255 * np.abs(tones - first.setdefault(method, tones)).mean()
            row.append((f"{name}, {words}\n{off:.1f} levels from a)", picture))
    return page(rows)


def wrinkles(face: Shot, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a random field over the vertices, of deviation 1, that changes mostly up and down."""
    place = face.buffer.mesh.vertices @ face.buffer.view.frame.T / face.buffer.mesh.diagonal
    waves = rng.standard_normal((3, 200)) * [[60], [400], [60]]
    return np.cos(place @ waves + rng.uniform(0, 2 * np.pi, 200)).sum(axis=1) / 10


@figure("Cosine, mean curvature, accessibility, and ours: knapping, hair, and a wing")
def es13(stage: Stage) -> Image.Image:
    rows = []
    for shot, cap in (
        (stage.look("flake"), 0.05), (stage.look("lucy", zoom=6.0, centre=(0.02, 0.54)), 0.02),
        (stage.look("lucy", zoom=3.0, centre=(-0.25, 0.6)), 0.02),
    ):  # fmt: skip
        space = shot.vertices(scales=9)
        row = []
        for words, method, options in (
            METHODS[0], ("mean curvature", "mean_curvature", {"curvature": "object"}),
            ("accessibility", "accessibility", {"cap": cap}), METHODS[1],
        ):  # fmt: skip
            values = shot.values(space, method, **options)
            caption = f"{words}\ndetail {shot.detail(values).std():.3f}"
            row.append((caption, shot.picture(values)))
        rows.append(row)
    return page(rows)
