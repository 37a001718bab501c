"""Figures of Local Light Alignment (Mestres et al. 2021), per pixel."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from figure_parts import Shot, Stage, drawing, figure, page
from PIL import Image

from meshdepict.congruence.comparison import Comparison, compare
from meshdepict.congruence.judging import picture
from meshdepict.congruence.lights import light_directions
from meshdepict.congruence.report import contact_sheet
from meshdepict.scene.material import Phong
from meshdepict.shading.light_alignment import align, confidence, transition

METHODS = ("lambert", "light_alignment", "exaggerated", "light_warping", "radiance_scaling")
NAMES = {"lambert": "original", "light_alignment": "light alignment"}
FINE = 3  # times as many pixels across where congruence is scored: windows are 37 pixels wide
SEVEN = (0.9, 0.6, 0.4, 0.2, 0.3, 0.2)  # the strengths of fig. 9, finest first


def aligned(
    shot: Shot, strength: Any, light: Any = "northwest", *, scales: int = 6, **options: Any
) -> Image.Image:
    """Return the picture of Local Light Alignment with a strength for every scale."""
    strength = (strength,) * scales if isinstance(strength, float) else strength
    space = shot.pixels(scales=len(strength))
    return shot.shaded(space, "light_alignment", light, strength=strength, **options)


@figure("What the two confidences are for: without them the shading breaks off")
def lla4(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo", zoom=2.5, centre=(0.0, 0.35))
    space = shot.pixels(scales=1, width=6 * shot.buffer.edge_length)
    normal, base = (n.astype(float) for n in space.normals)
    light = np.array([-1.0, 1.0, 1.0]) @ shot.buffer.view.frame / 3**0.5
    across = np.linalg.norm(np.cross(base, normal), axis=1)  # λ2
    both = confidence(light, normal, base)
    first = np.where(across > 1e-9, both / np.maximum(across, 1e-9), 0)
    # Where nothing holds the light back, it goes all the way to its guide.
    guide = align(light, normal, base, strength=1.0, sharpness=1e3)
    angle = np.arctan2(
        np.linalg.norm(np.cross(light, guide), axis=1), np.einsum("ni,i->n", guide, light)
    )
    axis = guide - np.cos(angle)[:, None] * light
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-12)
    row = []
    for words, share in (
        ("a) not adjusted", np.zeros_like(both)), ("b) λ = 1", np.ones_like(both)),
        ("c) λ = λ1", first), ("d) λ = λ2", across), ("e) λ = λ1 λ2", both),
    ):  # fmt: skip
        turn = (transition(np.clip(share, 0, 1), 2.0) * angle)[:, None]
        turned = np.cos(turn) * light + np.sin(turn) * axis
        shaded = np.clip(np.einsum("ni,ni->n", normal, turned), 0, 1)
        row.append((words, shot.picture(shaded, linear=True)))
    ours = shot.values(space, "light_alignment", strength=1.0, sharpness=2.0)
    off = np.abs(ours - shaded).max()
    row.append((f"light_alignment(): off from e) by {off:.0e}", shot.picture(ours, linear=True)))
    return page([row[:3], row[3:]])


@figure("How sharp the transitions are")
def lla5(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo", zoom=2.5, centre=(0.0, 0.35))
    space = shot.pixels(scales=1, width=6 * shot.buffer.edge_length)
    shown = [
        (f"γ = {g}", shot.shaded(space, "light_alignment", strength=1.0, sharpness=float(g)))
        for g in range(5)
    ]
    return page([shown])


@figure("The light at two points of a profile, turned at two scales one after the other")
def lla6(stage: Stage) -> Image.Image:
    from matplotlib.figure import Figure
    from scipy.ndimage import gaussian_filter1d

    x = np.linspace(-2, 2, 801)
    height = 0.7 * np.exp(-(x**2)) + 0.05 * np.cos(9 * x)
    slopes = [np.gradient(height, x)]
    slopes += [gaussian_filter1d(slopes[0], width) for width in (80, 400)]
    normals = [np.stack([-g, np.ones_like(g), 0 * g], axis=1) for g in slopes]
    normals = [n / np.linalg.norm(n, axis=1, keepdims=True) for n in normals]
    light = np.broadcast_to([0.3, 0.95, 0.05], normals[0].shape)
    light = light / np.linalg.norm(light, axis=1, keepdims=True)
    drawn = Figure(figsize=(3 * stage.inches, 0.7 * stage.inches), layout="constrained")
    plots = drawn.subplots(1, 3, sharey=True)
    names = ("l3: as given", "l2: turned at scale 2", "l1: turned at scale 1")
    for i, (axes, name) in enumerate(zip(plots, names, strict=True)):
        if i:
            light = align(light, normals[2 - i], normals[3 - i], strength=0.6, sharpness=3.0)
        shade = np.clip(np.sum(normals[0] * light, axis=1), 0, 1)
        axes.scatter(x, height, c=shade, cmap="gray", vmin=0, vmax=1, s=9)
        for point, place in (("p", 300), ("q", 500)):
            at = x[place], height[place]
            for vectors, color in ((normals[2 - min(i, 1)], "tab:blue"), (light, "tab:orange")):
                axes.arrow(*at, *(0.8 * vectors[place, :2]), color=color, head_width=0.08)
            axes.text(at[0], at[1] - 0.4, point)
        axes.set(title=name, aspect="equal", ylim=(-0.4, 1.7), xticks=[], yticks=[])
        axes.set_facecolor("#c6cdd6")
    words = "orange: the light; blue: the normal of the scale that it was turned at"
    return page([[(words, drawing(drawn))]])


@figure("Each scale alone, by five strengths; below without any and with chosen ones")
def lla7(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo", size=max(32, stage.size * 3 // 4))
    rows = []
    for scale in reversed(range(5)):
        row = []
        for share in (0.0, 0.25, 0.5, 0.75, 1.0):
            strength = tuple(share if i == scale else 0.0 for i in range(5))
            row.append((f"scale {scale + 1}, σ = {share:g}", aligned(shot, strength)))
        rows.append(row)
    chosen = (0.5, 0.3, 0.1, 0.2, 0.2)
    rows.append([("without", aligned(shot, 0.0)), (str(chosen), aligned(shot, chosen))])
    return page(rows)


@figure("Highlights and transmitted light with guides of their own")
def lla8(stage: Stage) -> Image.Image:
    rows = []
    for words, shot, chosen in (
        ("a", stage.look("lucy", zoom=2.0, centre=(0, 0.35)), (0.4, 0.2, 0.0, 0.3)),
        ("b", stage.look("bunny"), (0.4, 0.2, 0.2, 0.3)),
    ):
        row = []
        for term, diffuse in (("specular", 0.0), ("with diffuse", 0.5)):
            for state, strength in (("original", (0.0,) * 4), ("enhanced", chosen)):
                shown = aligned(
                    shot, (0.0,) * 4, material="cook_torrance", diffuse=diffuse, roughness=0.25,
                    specular_strength=strength, exposure=3.0 if not diffuse else 1.5,
                )  # fmt: skip
                row.append((f"{words}) {term}, {state}", shown))
        rows.append(row)
    for words, name in (("c", "bunny"), ("d", "dragon")):
        shot = stage.look(name)
        row = []
        sky = shot.environment("venice_sunset_1k")
        for term, lights, material, background, exposure in (
            ("transmitted", [(315, -65), (315, 45)], "lambert", 0.0, 1.5),
            ("with specular and background", sky, "cook_torrance", 0.5, 0.35),
        ):
            for state, share in (("original", 0.0), ("enhanced", 1.0)):
                strengths = tuple(share * s for s in (0.7, 0.3, 0.25, 0.6))
                shown = aligned(
                    shot, (0.0,) * 4, lights, material=material, transmitted=1.0, diffuse=0.0,
                    transmitted_strength=strengths, specular_strength=0.0, frosting=0.25,
                    background=background, exposure=exposure,
                )  # fmt: skip
                row.append((f"{words}) {term}, {state}", shown))
        rows.append(row)
    return page(rows)


@figure("Coarse, fine and all details of matt objects")
def lla9(stage: Stage) -> Image.Image:
    settings = {
        "original": (0.0,) * 6, "coarse details": (0, 0, *SEVEN[2:]),
        "fine details": (*SEVEN[:2], 0, 0, 0, 0), "all details": SEVEN,
    }  # fmt: skip
    shots = (
        stage.look("lucy", zoom=1.6, centre=(0.0, 0.2)),
        stage.look("nefertiti", zoom=1.5, centre=(0.0, 0.1)),
    )
    return page(
        [[(name, aligned(shot, strength)) for name, strength in settings.items()] for shot in shots]
    )


@figure("Coarse details by diffuse and fine ones by specular light, and the reverse")
def lla10(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo", zoom=1.8, centre=(0.0, 0.35))
    coarse, fine, none = (0, 0, 0, 0.4, 0.7, 0.6), (0.7, 0.8, 0.3, 0, 0, 0), (0.0,) * 6
    rows = []
    for name, matt, glossy in (
        ("original", none, none), ("a) diffuse coarse, specular fine", coarse, fine),
        ("b) the reverse", fine, coarse),
    ):  # fmt: skip
        row = []
        for term, diffuse, specular in (
            ("diffuse", 0.7, 0.0), ("specular", 0.0, 0.5), ("both", 0.7, 0.5)
        ):  # fmt: skip
            material = Phong(ambient=0.0, diffuse=diffuse, specular=specular, shininess=15.0)
            shown = aligned(shot, matt, material=material, specular_strength=glossy)
            row.append((f"{name}: {term}", shown))
        rows.append(row)
    return page(rows)


@figure("A gallery, original and enhanced. Direct light alone")
def lla11(stage: Stage) -> Image.Image:
    cells = []
    for name, options in (
        ("flake", {}), ("bunny", {"material": "phong"}), ("nefertiti", {}),
        ("dragon", {"material": "cook_torrance", "exposure": 1.6}),
        ("lucy", {"material": "ashikhmin_shirley", "exposure": 1.6}),
        ("armadillo", {"transmitted": 0.25, "diffuse": 0.4}),
    ):  # fmt: skip
        shot = stage.look(name)
        still = {"specular_strength": 0.0} if "material" in options else {}
        if "transmitted" in options:
            still = {"transmitted_strength": 0.0}
        light = [(315, 30), (135, -50)] if "transmitted" in options else (315, 30)
        cells.append((f"{name}, original", aligned(shot, 0.0, light, **options, **still)))
        cells.append((f"{name}, enhanced", aligned(shot, SEVEN, light, **options)))
    return page([cells[:4], cells[4:8], cells[8:]])


@figure("Renderings and where they agree with the shape, under six of the 21 lights")
def lla12(stage: Stage) -> Image.Image:
    shot = stage.look("armadillo", size=FINE * stage.size)
    space, small = shot.pixels(scales=6), (stage.size, stage.size)
    rows = []
    for light in np.array(light_directions(shot.buffer.view))[[0, 2, 4, 6, 10, 14]]:
        row = []
        for name, strength in (("original", 0.0), ("ours", SEVEN)):
            values = shot.values(space, "light_alignment", light, strength=strength)
            found = shot.judge.flows(shot.buffer.image(values))
            scores = Image.new("RGB", shot.buffer.size, "white")
            colored = Image.fromarray(picture(found))
            scores.paste(colored, mask=colored)
            shown = shot.picture(values, linear=True)
            row.append((f"{light.name} {name}", shown.resize(small)))
            row.append((f"score {found.score:.2f}", scores.resize(small)))
        rows.append(row)
    return page(rows)


def compared(stage: Stage, numbers: Iterable[int], *, name: str = "armadillo") -> Comparison:
    """Compare the methods as the paper does: Lambertian, its settings, per pixel."""
    shot = stage.look(name, size=FINE * stage.size)
    lights = [light_directions(shot.buffer.view)[i - 1] for i in numbers]
    return compare(
        shot.buffer.mesh, METHODS, lights=lights, view=shot.buffer.view, scales=6, per_pixel=True,
        size=shot.buffer.size,
        options={"light_alignment": {"strength": SEVEN}, "exaggerated": {"exaggeration": 40.0}},
    )  # fmt: skip


@figure("Mean congruence of five methods under 21 lights")
def lla13(stage: Stage) -> Image.Image:
    from matplotlib.figure import Figure

    drawn = Figure(figsize=(3 * stage.inches, 3 * stage.inches), layout="constrained")
    for axes, name in zip(drawn.subplots(2, 1), ("armadillo", "bunny"), strict=True):
        found = compared(stage, range(1, 22), name=name)
        for method, scores, mean in zip(found.methods, found.scores, found.means, strict=True):
            label = f"{NAMES.get(method, method.replace('_', ' '))}, mean {mean:.3f}"
            axes.plot(range(1, 22), scores, marker="o", ms=3, label=label)
        axes.set(title=name, xlabel="light", ylabel="congruence", ylim=(0, 1), xticks=range(1, 22))
        axes.legend(frameon=False, fontsize=8)
    return page([[("per pixel, 6 scales", drawing(drawn))]])


@figure("Five methods under seven of the lights")
def lla14(stage: Stage) -> Image.Image:
    found = compared(stage, (1, 3, 5, 7, 11, 15, 19))
    return contact_sheet(found, cell=max(16, stage.size * 2 // 3))
