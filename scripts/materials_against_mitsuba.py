"""Compare the materials with those of Mitsuba 3 over random directions.

    pip install mitsuba
    python scripts/materials_against_mitsuba.py > table.md      # a few seconds

Prints Markdown: docs/materials.md is this output with sentences round it. Where a model differs on
purpose, the same formula is evaluated once more with Mitsuba's part in place of ours: what is left
then is rounding, so the part that is named is the only difference.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.material import (
    AshikhminShirley,
    CookTorrance,
    Lambert,
    Material,
    diffuse_term,
    schlick,
    specular_term,
)

try:
    import mitsuba as mi
except ImportError:
    sys.exit("This comparison needs Mitsuba 3, which meshdepict does not: pip install mitsuba")

mi.set_variant("scalar_rgb")

Floats = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
COUNT = 4_000
IOR = 1.5
HEAD_ON = ((IOR - 1) / (IOR + 1)) ** 2


class Case(NamedTuple):
    """One of our terms, Mitsuba's counterpart, and what turns the one into the other."""

    model: str
    material: Material
    term: Callable[..., Any]
    plugin: dict[str, Any]
    slope: float  # of the lobe that directions are drawn from
    why: str
    exchanged: Callable[[Floats, Floats, Floats], Floats] | None = None


def directions(rng: np.random.Generator, slope: float) -> tuple[Floats, Floats]:
    """Return lights and eyes above the surface: half of them anywhere, half near the mirror's."""
    eye, light = (upper(rng.normal(size=(COUNT, 3))) for _ in range(2))
    half = upper(np.column_stack([rng.normal(0, slope, (COUNT, 2)), np.ones(COUNT)]))
    mirrored = 2 * (half * eye).sum(axis=1, keepdims=True) * half - eye
    near = (np.arange(COUNT) % 2 == 0) & (mirrored[:, 2] > 0)
    light[near] = mirrored[near]
    steep = np.minimum(light[:, 2], eye[:, 2]) > 0.02
    return light[steep], eye[steep]


def upper(vectors: Floats) -> Floats:
    """Return unit vectors of the upper hemisphere."""
    vectors = vectors * np.where(vectors[:, 2:] < 0, [1, 1, -1], 1)
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def theirs(plugin: dict[str, Any], light: Floats, eye: Floats) -> Floats:
    """Return π times Mitsuba's BRDF times cosine: what our terms are."""
    bsdf, context, hit = mi.load_dict(plugin), mi.BSDFContext(), mi.SurfaceInteraction3f()
    found = np.empty(len(light))
    for i, (towards, seen) in enumerate(zip(light.tolist(), eye.tolist(), strict=True)):
        hit.wi = seen
        found[i] = bsdf.eval(context, hit, mi.Vector3f(towards))[0]
    return np.pi * found


# --- what differs on purpose ------------------------------------------------------------------


def angles(light: Floats, eye: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return n·l, n·e, n·h and e·h."""
    half = light + eye
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return light[:, 2], eye[:, 2], half[:, 2], (eye * half).sum(axis=1)


def smith(cosine: Floats, alpha: float) -> Floats:
    """Return Smith's shadowing of Beckmann facets in Walter's rational form (2007, eq. 27)."""
    a = cosine / (alpha * np.sqrt(np.maximum(1 - cosine**2, 1e-12)))
    return np.where(a < 1.6, (3.535 * a + 2.181 * a**2) / (1 + 2.276 * a + 2.577 * a**2), 1)


def fresnel(cosine: Floats) -> Floats:
    """Return what unpolarised light a dielectric reflects (Fresnel)."""
    inside = np.sqrt(1 - (1 - cosine**2) / IOR**2)
    across = (cosine - IOR * inside) / (cosine + IOR * inside)
    along = (inside - IOR * cosine) / (inside + IOR * cosine)
    return (across**2 + along**2) / 2


def smooth_shadowing(alpha: float) -> Callable[[Floats, Floats, Floats], Floats]:
    """Exchange the V-grooves' shadowing for Smith's."""

    def exchange(values: Floats, light: Floats, eye: Floats) -> Floats:
        nl, ne, nh, eh = angles(light, eye)
        grooves = np.minimum(1, np.minimum(2 * nh * ne / eh, 2 * nh * nl / eh))
        return values / grooves * smith(nl, alpha) * smith(ne, alpha)

    return exchange


def dielectric(alpha: float) -> Callable[[Floats, Floats, Floats], Floats]:
    """Exchange shadowing, and Schlick's Fresnel term for the exact one."""
    shadowed = smooth_shadowing(alpha)

    def exchange(values: Floats, light: Floats, eye: Floats) -> Floats:
        eh = angles(light, eye)[3]
        return shadowed(values, light, eye) / schlick(HEAD_ON, eh) * fresnel(eh)

    return exchange


def cases() -> list[Case]:
    found = [
        Case(
            "Lambert, diffuse term of Phong", Lambert(0.6), diffuse_term,
            {"type": "diffuse", "reflectance": gray(0.6)}, 1.0, "the same",
        )
    ]  # fmt: skip
    for m in (0.1, 0.3, 0.6):
        found += [
            Case(
                f"Cook–Torrance, mirroring facets, m = {m}",
                CookTorrance(0, 1, m), specular_term,
                {"type": "roughconductor", "material": "none", "alpha": m,
                 "distribution": "beckmann"},
                m, "V-grooves shadow each other (1982), Mitsuba's facets are Smith's",
                smooth_shadowing(m),
            ),
            Case(
                f"Cook–Torrance, glass facets, m = {m}",
                CookTorrance(0, HEAD_ON, m), specular_term,
                {"type": "roughplastic", "alpha": m, "distribution": "beckmann",
                 "int_ior": IOR, "ext_ior": 1.0, "diffuse_reflectance": gray(0)},
                m, "the same, and Schlick's Fresnel term against the exact one",
                dielectric(m),
            ),
        ]  # fmt: skip
    found.append(
        Case(
            "Cook–Torrance, diffuse base", CookTorrance(0.6, HEAD_ON, 0.3), diffuse_term,
            {"type": "roughplastic", "alpha": 0.3, "distribution": "beckmann", "int_ior": IOR,
             "ext_ior": 1.0, "diffuse_reflectance": gray(0.6), "specular_reflectance": gray(0)},
            1.0, "Mitsuba's base also gets the light that the coat reflects back inside, and looks "
            "through rough facets",
        )
    )  # fmt: skip
    for n in (10, 100, 1000):
        alpha = (2 / (n + 2)) ** 0.5
        found.append(
            Case(
                f"Ashikhmin–Shirley, mirroring coat, n = {n}",
                AshikhminShirley(0, 1, n), specular_term,
                {"type": "roughconductor", "material": "none", "alpha": alpha,
                 "distribution": "beckmann"},
                alpha, "no such plugin; the nearest is Beckmann's lobe of slope √(2/(n + 2)), "
                "which has shadowing in place of max(n·l, n·e)",
            )
        )  # fmt: skip
    return found


def gray(value: float) -> dict[str, Any]:
    return {"type": "rgb", "value": [value] * 3}


def difference(ours: Floats, other: Floats) -> tuple[float, float]:
    """Return median and largest difference, relative to the larger of both.

    Only of values that show, at least a tenth of a grey level.
    """
    larger = np.maximum(ours, other)
    shown = larger > 0.1 / 255
    off = np.abs(ours - other)[shown] / larger[shown]
    return float(np.median(off)), float(off.max())


def main() -> None:
    rng = np.random.default_rng(1982)
    print(f"Mitsuba {mi.__version__}, {COUNT:,} pairs of directions, at least 1.1° above the "
          "surface.\n")  # fmt: skip
    print("| model | Mitsuba | median | largest | … with Mitsuba's part | why |")
    print("| --- | --- | --- | --- | --- | --- |")
    for case in cases():
        light, eye = directions(rng, case.slope)
        ours, other = case.term(case.material, UP, light, eye), theirs(case.plugin, light, eye)
        median, largest = difference(ours, other)
        left = ""
        if case.exchanged is not None:
            left = f"{difference(case.exchanged(ours, light, eye), other)[1]:.0e}"
        print(f"| {case.model} | `{case.plugin['type']}` | {median:.2g} | {largest:.2g} | "
              f"{left} | {case.why} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
