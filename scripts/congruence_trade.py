"""Measure how the ranking of methods by congruence depends on how congruence is measured.

    python scripts/congruence_trade.py bunny.ply lucy.ply@z/back … > tables.md

After an @ stands which axis is up, and after a stroke the view. Prints Markdown: docs/congruence.md
is this output with sentences round it. One thing at a time is other than in the first row. A cell
has the mean over the objects of a method's mean over the 21 lights, and on how many of the objects
it is the highest: of Local Light Alignment at each strength against all other methods, and of
those against one another and Local Light Alignment at 0.4. An order is by these means.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from tables import head, row

import meshdepict as md
from meshdepict.congruence.comparison import compare, usual_methods

ALIGNED = "light_alignment"
OTHERS = tuple(name for name in usual_methods() if name != ALIGNED)
SHORT = {
    "lambert": "L", "light_warping": "LW", "radiance_scaling": "RS", "normal_enhancement": "NE",
    "exaggerated": "ES", ALIGNED: "LLA",
}  # fmt: skip
STRENGTHS: dict[str, Any] = {
    "0.3": 0.3, "0.4": 0.4, "0.7": 0.7, "fig. 9": (0.9, 0.6, 0.4, 0.2, 0.3, 0.2),
}  # fmt: skip
RANKED = "0.4"  # the strength that other methods meet
FIRST: dict[str, Any] = {"per_pixel": True, "size": (480, 480)}

Means = dict[str, float]


def settings(sizes: list[int], widths: list[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield names and what differs from the first."""
    yield "first: per pixel, 480 pixels, depth, declared", {}
    yield "slope", {"flow": "slope"}
    for scored in ("linear", "display"):
        yield scored, {"scored": scored}
        yield f"slope, {scored}", {"flow": "slope", "scored": scored}
    yield "vertices", {"per_pixel": False}
    yield "vertices, slope", {"per_pixel": False, "flow": "slope"}
    for width in widths:
        yield f"first width {width}", {"width": width}
    for size in sizes:
        yield f"{size} pixels", {"size": (size, size)}


def means(mesh: md.Mesh, **chosen: Any) -> Means:
    """Return mean congruences of the other methods, and of LLA at every strength."""
    found = compare(mesh, OTHERS, **chosen)
    result = dict(zip(found.methods, found.means.tolist(), strict=True))
    for name, strength in STRENGTHS.items():
        options = {ALIGNED: {"strength": strength}}
        result[name] = float(compare(mesh, [ALIGNED], options=options, **chosen).means[0])
    return result


def highest(found: Means, name: str) -> bool:
    """Return whether none of those that a method meets has a higher mean."""
    met = OTHERS if name in STRENGTHS else (*OTHERS, RANKED)
    return all(found[name] >= found[other] for other in met)


def order(found: Means) -> str:
    """Return the methods, the highest mean first; those within 0.005 are alike."""
    ranked = sorted((*OTHERS, RANKED), key=lambda name: -found[name])
    text = ""
    for name, before in zip(ranked, [None, *ranked], strict=False):
        sign = "" if before is None else " ≈ " if found[before] - found[name] < 0.005 else " > "
        text += sign + SHORT[ALIGNED if name in STRENGTHS else name]
    return text


def measured(words: list[str], given: dict[str, Any]) -> dict[str, Means]:
    """Return the means of every object under one setting."""
    found = {}
    for word in words:
        path, _, how = word.partition("@")
        up, _, view = how.partition("/")
        mesh = md.read_mesh(path)
        name = Path(path).name.split(".")[0].split("_")[0]
        found[name] = means(mesh, up=up or "y", view=view or "front", **{**FIRST, **given})
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", help="FILE, FILE@UP or FILE@UP/VIEW")
    parser.add_argument("--sizes", type=int, nargs="*", default=[240, 360, 720])
    parser.add_argument("--widths", nargs="*", default=["2px", "4px", "8px"])
    given = parser.parse_args()
    columns = {name: SHORT[name] for name in OTHERS} | {s: f"LLA {s}" for s in STRENGTHS}
    per_object: dict[str, dict[str, Means]] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", md.MeshdepictWarning)
        head("", *columns.values(), "order")
        for setting, changed in settings(given.sizes, given.widths):
            found = per_object[setting] = measured(given.files, changed)
            mean = {name: float(np.mean([f[name] for f in found.values()])) for name in columns}
            times = {name: sum(highest(f, name) for f in found.values()) for name in columns}
            row(setting, *(f"{mean[name]:.2f} · {times[name]}" for name in columns), order(mean))
    for setting in ("slope", next(iter(per_object))):
        head(setting, *columns.values(), "order")
        for name, found in per_object[setting].items():
            row(name, *(f"{found[column]:.3f}" for column in columns), order(found))


if __name__ == "__main__":
    main()
