"""Figures of Radiance Scaling (Vergne et al. 2011), per pixel."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from figure_parts import Shot, Stage, crop, drawing, figure, page
from PIL import Image

import meshdepict as md
from meshdepict.scene.material import (
    AshikhminShirley,
    LitSphere,
    Mirror,
    Phong,
    Refractive,
    SubLambert,
    Toon,
)
from meshdepict.shading.radiance_scaling import scaling
from meshdepict.shapes.gbuffer import GBuffer

GLOSSY = AshikhminShirley(diffuse=0.35, reflectance=0.25, shininess=60.0)

DIM = 0.02  # an exposure under which next to nothing is burnt out, to measure at


def scaled(
    shot: Shot, light: Any = "northwest", *, iterations: int = 8, **options: Any
) -> Image.Image:
    """Return the picture of Radiance Scaling on the slopes after some steps of diffusion."""
    return shot.shaded(shot.descriptor(iterations), "radiance_scaling", light, **options)


@figure("The scaling function over reflectance, for two invariant points and five curvatures")
def rs2(stage: Stage) -> Image.Image:
    from matplotlib.figure import Figure

    drawn = Figure(figsize=(2 * stage.inches, stage.inches), layout="constrained")
    delta = np.linspace(0, 1, 201)
    for axes, invariant in zip(drawn.subplots(1, 2, sharey=True), (0.2, 0.8), strict=True):
        for curvature in (-1.0, -0.5, 0.0, 0.5, 1.0):
            values = scaling(curvature, delta, invariant=invariant, magnitude=1.0)
            axes.plot(delta, values, label=f"κ = {curvature:g}")
        axes.axvline(invariant, color="grey", lw=0.6)
        axes.set(title=f"α = {invariant:g}", xlabel="δ")
    axes.legend(frameon=False, fontsize=7)
    return page([[("γ = 1", drawing(drawn))]])


@figure("Scaling by two magnitudes and three invariant points")
def rs3(stage: Stage) -> Image.Image:
    shot = stage.look("bunny")
    light = (315, 45)
    plain = scaled(shot, light, material="lambert", magnitude=0.0, exposure=0.7)
    rows = []
    for magnitude in (10.0, 20.0):
        row = [("γ = 0", plain)]
        for invariant in (0.5, 0.01, 0.99):
            shown = scaled(
                shot, light, material="lambert", magnitude=magnitude, invariant=invariant,
                gain=1.0, exposure=0.7,
            )  # fmt: skip
            row.append((f"γ = {magnitude:g}, α = {invariant:g}", shown))
        rows.append(row)
    return page(rows)


@figure("Mean curvature of the object, and as seen with three foreshortenings, near and far")
def rs4(stage: Stage) -> Image.Image:
    rows = []
    for where, zoom in (("near", 1.0), ("in the background, enlarged", 0.3)):
        shot = stage.look("armadillo", zoom=zoom)
        vertices = shot.vertices(scales=1)
        bend = vertices.curvature(1).mean * vertices.widths[1]
        own = shot.picture(shot.buffer.sample(0.5 + 0.5 * np.tanh(4 * bend)))
        row = [(f"object space, {where}", own)]
        space = shot.descriptor(4)
        for f in (0.0, 0.5, 1.0):
            seen = space.view_curvature(shot.buffer.view, 1, foreshortening=f)
            shown = 0.5 - 0.5 * np.tanh(10 * seen.mean) * seen.weight
            row.append((f"f = {f:g}, {where}", shot.picture(shown)))
        part = (0.35, 0.35, 0.65, 0.65)
        rows.append(row if zoom == 1 else [(words, crop(shown, part)) for words, shown in row])
    return page(rows)


@figure("Anisotropy, under a light from the left")
def rs5(stage: Stage) -> Image.Image:
    shot = stage.look("lucy", zoom=2.5, centre=(0.0, 0.1))
    space = shot.descriptor()
    found = [
        shot.values(
            space, "radiance_scaling", (270, 45), material="lambert", anisotropy=a, magnitude=6.0,
            exposure=0.6,
        )
        for a in (-1.0, 0.0, 1.0)
    ]  # fmt: skip
    row = [
        (f"λ = {a}", shot.picture(values, linear=True))
        for a, values in zip((-1, 0, 1), found, strict=True)
    ]
    change = found[2] - found[0]
    words = f"λ = 1 less λ = −1;\nmean {255 * np.abs(change).mean():.0f} of 255, linear"
    row.append((words, shot.picture(np.clip(0.5 + change / 2, 0, 1))))
    return page([row[:2], row[2:]])


@figure("Simple light: Phong's lobes, an ambient lobe, a cartoon, and a moon")
def rs6(stage: Stage) -> Image.Image:
    light = "northwest"
    head = stage.look("armadillo", zoom=2.2, centre=(0.0, 0.4))
    phong = Phong(ambient=0.1, diffuse=0.55, specular=0.45, shininess=12.0)
    none = {"ambient_magnitude": 0.0, "diffuse_magnitude": 0.0, "specular_magnitude": 0.0}
    rows = [[
        (words, scaled(head, light, material=phong, **(none | chosen)))
        for words, chosen in (
            ("a) Phong", {}), ("diffuse scaled", {"diffuse_magnitude": 6.0}),
            ("specular scaled", {"specular_magnitude": 6.0}),
            ("all scaled", dict.fromkeys(none, 6.0) | {"ambient_magnitude": 2.0}),
        )
    ]]  # fmt: skip
    relief = stage.look("flake")
    ambient = Phong(ambient=0.45, diffuse=0.45, specular=0.0)
    lucy = stage.look("lucy", zoom=2.0, centre=(0.0, 0.35))
    moon = Shot(craters(stage.size))
    for words, shot, material, where, steps in (
        ("b) ambient and diffuse", relief, ambient, light, 30),
        ("c) cartoon", lucy, Toon(bins=5, sharpness=12.0), light, 8),
        ("d) moon, ζ = 0.5", moon, SubLambert(), (270, 25), 8),
    ):
        rows.append([
            (f"{words}, {name}", scaled(
                shot, where, iterations=steps, material=material, magnitude=m, exposure=0.8
            ))
            for name, m in (("plain", 0.0), ("scaled", 6.0))
        ])  # fmt: skip
    return page([rows[0], [*rows[1], *rows[2]], rows[3]])


def craters(size: int, count: int = 400) -> GBuffer:
    """Return a smooth sphere with a normal map of craters, as pixels."""
    rng = np.random.default_rng(1969)
    along = np.linspace(-1.05, 1.05, size)
    x, y = np.meshgrid(along, -along)
    mask = x * x + y * y < 0.99
    z = np.sqrt(np.where(mask, 1 - x * x - y * y, 1))
    sphere = np.stack([x, y, z], axis=-1)
    tilt = np.zeros_like(sphere)
    centres = rng.normal(size=(count, 3))
    centres /= np.linalg.norm(centres, axis=1, keepdims=True)
    for centre, radius in zip(centres, 0.03 / rng.random(count) ** 0.5, strict=True):
        across = sphere - centre
        d = np.linalg.norm(across, axis=-1, keepdims=True) / min(radius, 0.25)
        # Inwards within the bowl, outwards on the rim.
        slope = np.exp(-((2 * (d - 1.2)) ** 2)) - 1.6 * np.exp(-((1.6 * d) ** 4))
        tilt += 0.4 * slope * across / min(radius, 0.25)
    normals = sphere + tilt - sphere * np.sum(tilt * sphere, axis=-1, keepdims=True)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return GBuffer.from_images(normals, mask=mask)


@figure("A glossy object in an environment: diffuse, specular and both terms scaled")
def rs7(stage: Stage) -> Image.Image:
    row, closer = [], []
    for words, diffuse, specular in (
        ("a) plain", 0.0, 0.0), ("b) diffuse", 5.0, 0.0), ("c) specular", 0.0, 5.0),
        ("d) both", 5.0, 5.0),
    ):  # fmt: skip
        for cells, zoom, centre in ((row, 1.0, (0, 0)), (closer, 3.0, (0.0, 0.35))):
            shot = stage.look("armadillo", zoom=zoom, centre=centre)
            light = shot.environment("studio_small_03_1k")
            shown = scaled(
                shot, light, material=GLOSSY, diffuse_magnitude=diffuse,
                specular_magnitude=specular, lights=128,
            )  # fmt: skip
            cells.append((words, shown))
    return page([row, closer])


@figure("Light computed beforehand: irradiance and occlusion, occlusion alone, a lit sphere")
def rs8(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo")
    light = shot.environment("studio_small_03_1k")
    sphere = LitSphere(stage.sphere("ls02.png"))
    cases = {
        "a) irradiance × occlusion": {
            "material": "lambert", "illumination": "irradiance", "rays": 128,
        },
        "b) ambient occlusion": {
            "material": "lambert", "illumination": "occlusion", "rays": 128, "exposure": 0.5,
        },
        "c) lit sphere": {"material": sphere},
    }  # fmt: skip
    rows = [
        [
            (f"{words}, {name}", scaled(shot, light, magnitude=magnitude, **options))
            for words, options in cases.items()
        ]
        for name, magnitude in (("plain", 0.0), ("scaled", 5.0))
    ]
    return page(rows)


@figure("A refractive object, and a mirror: under a sunset, and with its sun and sky clipped")
def rs9(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo")
    sunset, space = shot.environment("venice_sunset_1k"), shot.descriptor(4)
    clipped = md.Environment(
        np.minimum(sunset.pixels, np.quantile(sunset.pixels, 0.9)), up=sunset.up
    )
    rows = []
    for name, material, exposures in (
        ("refractive", Refractive(), (0.25, 0.4)), ("mirror", Mirror(), (0.5, 0.8))
    ):  # fmt: skip
        row = []
        for sky, light, exposure in zip(
            ("sunset", "clipped"), (sunset, clipped), exposures, strict=True
        ):
            plain, scaled_up = (
                shot.values(
                    space, "radiance_scaling", light, material=material, magnitude=magnitude,
                    exposure=DIM,
                )
                for magnitude in (0.0, 3.0)
            )  # fmt: skip
            share = follows(shot, space, scaled_up - plain)
            for words, values in (
                (f"{name}, {sky}", plain),
                (f"γ = 3: change follows convexity {share:.0%}", scaled_up),
            ):  # fmt: skip
                shown = values * (exposure / DIM)
                spread = shot.detail(shown, linear=True).std()
                row.append((f"{words}\ndetail {spread:.3f}", shot.picture(shown, linear=True)))
        rows.append(row)
    return page(rows)


def follows(shot: Shot, space: md.ScaleSpace, change: Any) -> float:
    """Return where convexities get brighter and concavities darker: a share of what changes."""
    seen = space.view_curvature(shot.buffer.view, 1)
    bent = np.tanh(-10 * seen.mean) * seen.weight
    change = np.asarray(change).reshape(len(bent), -1).mean(axis=1)
    there = (np.abs(bent) > 0.2) & (np.abs(change) > 1e-3 * DIM)
    return float(np.mean(change[there] * bent[there] > 0))


@figure("Time of a picture by the number of lights: plain, scaled, and warped")
def rs12(stage: Stage) -> Image.Image:
    from matplotlib.figure import Figure

    shot = stage.look("armadillo")
    light, space = shot.environment("grace_256x128"), shot.descriptor(6)
    counts = (16, 64, 128, 192, 256)

    def seconds(method: str, count: int, magnitude: float) -> float:
        """Return the processor's time, which others on the machine hardly change."""
        taken = []
        for _ in range(2):
            start = time.process_time()
            shot.values(space, method, light, material=GLOSSY, lights=count, magnitude=magnitude)
            taken.append(time.process_time() - start)
        return min(taken)

    drawn = Figure(figsize=(2 * stage.inches, 1.2 * stage.inches), layout="constrained")
    axes = drawn.subplots()
    slopes: list[float] = []
    for name, method, magnitude in (
        ("plain", "radiance_scaling", 0.0), ("radiance scaling", "radiance_scaling", 5.0),
        ("light warping", "light_warping", 8.0),
    ):  # fmt: skip
        found = [seconds(method, count, magnitude) for count in counts]
        slopes.append(np.polyfit(counts, found, 1)[0])
        straight = np.corrcoef(counts, found)[0, 1]
        label = f"{name}: a light takes {slopes[-1] / slopes[0]:.2f} of plain, r = {straight:.3f}"
        axes.plot(counts, found, marker="o", ms=3, label=label)
    axes.set(xlabel="lights", ylabel="s of processor", ylim=(0, None))
    axes.legend(frameon=False, fontsize=8)
    return page([[("per pixel, without reading and smoothing", drawing(drawn))]])


@figure("Light Warping above, Radiance Scaling below: matt and glossy, under two orientations")
def rs13(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo")
    space = shot.descriptor(6)
    rows: list[list[tuple[str, Image.Image]]] = [[], []]
    for material, name in (("lambert", "diffuse"), (GLOSSY, "shiny")):
        for turn in (0, 180):
            light = shot.environment("ennis_256x128", turn=turn)
            shared = {"material": material, "lights": 128, "exposure": DIM}
            plain = shot.values(space, "radiance_scaling", light, magnitude=0.0, **shared)
            for row, method, magnitude in zip(
                rows, ("light_warping", "radiance_scaling"), (8.0, 4.0), strict=True
            ):
                values = shot.values(space, method, light, magnitude=magnitude, **shared)
                share = follows(shot, space, values - plain)
                words = f"{name}, turned by {turn}°\nchange follows convexity: {share:.0%}"
                row.append((words, shot.picture(0.7 / DIM * values, linear=True)))
    return page(rows)


@figure("Light Warping, Radiance Scaling, and one after the other, on a glossy object")
def rs14(stage: Stage) -> Image.Image:
    shot = stage.look("dragon")
    light = shot.environment("grace_256x128")
    row = [
        (words, scaled(
            shot, light, material=GLOSSY, warping=warping, magnitude=magnitude, lights=128,
        ))
        for words, warping, magnitude in (
            ("plain", 0.0, 0.0), ("warped, α = 8", 8.0, 0.0), ("scaled, γ = 5", 0.0, 5.0),
            ("warped, then scaled", 8.0, 5.0),
        )
    ]  # fmt: skip
    return page([row[:2], row[2:]])
