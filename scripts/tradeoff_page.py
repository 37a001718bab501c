"""The page and the plots of the measured trade: docs/accuracy.md, docs/accuracy.png."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tradeoff_subjects import Row

import meshdepict as md
from meshdepict.baking.accuracy import ACCURACIES
from meshdepict.threads import thread_count

# ruff: noqa: E501 - lines of the page
PLOTTED = ("tolerance", "scales", "rays", "lights")

HEAD = """# Speed for accuracy

What every knob costs and gives, measured by `scripts/tradeoff.py`, which writes this page. Errors are
differences in grey levels (of 255) of the bytes that a picture shows, against the knob's most exact
setting: root mean square, and the 99th percentile. Where a knob makes another picture and not a
rougher one (facing, diffusion, bounces), the difference says how much it changes. Seconds are by the
clock and, in brackets, of all processors together, kernels being loaded; memory is what arrays take
at most, beyond the shape itself.

{machine}

## Three names for it

`--accuracy draft|normal|reference`, `accuracy=` in Python, chooses the numbers below where nobody says
others; what is said comes first. `normal` is what is usual. Files and recipes record the numbers.

{sets}

The usual tolerance is off by less than a tenth of a grey level, as the first table shows, so `reference` keeps
it: of methods that cast no rays and take no panorama, Exaggerated Shading for one, it is `normal`.
`draft` looks at every second scale of Exaggerated Shading, which is what its error comes from. Ambient
occlusion keeps its 256 rays in drafts: with fewer its grey scale, which goes by the noise, would be another.
Below half a level is what `reference` aims at; a table below says where rays miss it.

`--budget 2s`, `budget=` in Python, takes the most exact of the three that is predicted to fit, or draft
where none does, and says what was predicted: of a command from the start of the program to the written
file (the first file's; of others from reading on), in Python of the call. It is not for windows, movies, plates
and comparisons. Predictions are those of `meshdepict info --explain`; `scripts/budget_check.py` compares
them with what bakes take. The machine is measured once, for a fiftieth of a second, and its speed kept
in the user's cache. Not predicted are accessibility's search, shadows and bounces of panoramas with
bright lamps, `--refine`, and what other programs take of the machine meanwhile.

{predictions}
"""

UNSET = """## What can't be set

* The steps of rays through a volume's picture: always a voxel, and a quarter of one where something
  is shown (`drawing/volume_rays.py`); no public knob.
* The stride of voxels: no knob either; the table takes a thinned `Volume`.
* The estimator of curvature: `curvature.principal_curvatures` has the three, methods always take the tensor.
* Precision: sums are in single precision where the tolerance allows it and in double where not; no knob.
  The table rounds positions.
* Packed normals are those of windows on the graphics card, 2 × 16 bits, and 2 × 24 where a method
  magnifies errors; not a choice.
"""


def write(folder: Path, rows: Mapping[str, Sequence[Row]], about: Mapping[str, str]) -> None:
    """Write the page and its plots from what was measured."""
    parts = [
        HEAD.format(machine=_machine(), sets=_sets(), predictions=_predictions(folder)),
        "## Knobs",
    ]
    if any(rows.get(name) for name in PLOTTED):
        _plot(folder / "accuracy.png", rows)
        parts.append("![Error against seconds, knob by knob](accuracy.png)")
    for name, text in about.items():
        if rows.get(name):
            parts += [f"### {rows[name][0].knob.capitalize()}", text.strip(), _table(rows[name])]
    parts.append(UNSET.rstrip())
    (folder / "accuracy.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _machine() -> str:
    return (
        f"{thread_count()} cores, {platform.processor() or platform.machine()}, Python "
        f"{platform.python_version()}, meshdepict {md.__version__}; load "
        f"{os.getloadavg()[0]:.0f} when this page was written."
    )


def _sets() -> str:
    lines = ["| | tolerance | rays | lights of an environment | scales |", "| --- " * 5 + "|"]
    for name, each in ACCURACIES.items():
        ladders = ", ".join(f"{m} {n} of ratio {r:g}" for m, (n, r) in each.ladders.items())
        usual = "as usual"
        lines.append(
            f"| `{name}` | {each.tolerance or usual} | {_times(each.rays)} | "
            f"{_times(each.lights)} | {ladders or usual} |"
        )
    return "\n".join(lines)


def _times(factor: float) -> str:
    if factor == 1:
        return "as usual"
    return f"× {factor:g}" if factor > 1 else f"1/{round(1 / factor)} of the usual"


def _predictions(folder: Path) -> str:
    """Return what `budget_check.py` found, if it was asked."""
    path = folder / "accuracy_predictions.md"
    return path.read_text(encoding="utf-8").strip() if path.exists() else ""


def _table(rows: Sequence[Row]) -> str:
    lines = [
        "| | setting | seconds | MB | rms | 99 % within |",
        "| --- " * 6 + "|",
    ]
    before = ""
    for row in rows:
        name, before = ("" if row.subject == before else row.subject), row.subject
        lines.append(
            f"| {name} | {row.setting} | {row.seconds:.2f} ({row.core_seconds:.2f}) | "
            f"{row.size / 1e6:.0f} | {row.rms:.2f} | {row.most:.0f} |"
        )
    return "\n".join(lines)


def _plot(path: Path, rows: Mapping[str, Sequence[Row]]) -> None:
    """Draw error against core-seconds of some knobs."""
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot

    names = [name for name in PLOTTED if rows.get(name)]
    figure, axes = pyplot.subplots(
        1, len(names), figsize=(3.6 * len(names), 3.6), layout="constrained", squeeze=False
    )
    for axis, name in zip(axes[0], names, strict=True):
        curves: dict[str, list[Any]] = {}
        for row in rows[name]:
            method = row.setting.partition(":")[0] if ":" in row.setting else ""
            curves.setdefault(f"{row.subject} {method}".strip(), []).append(row)
        for label, curve in curves.items():
            shown = [row for row in curve if row.rms > 0]
            axis.loglog(
                [row.core_seconds for row in shown], [max(row.rms, 1e-3) for row in shown],
                marker="o", ms=3, label=label,
            )  # fmt: skip
        axis.axhline(0.5, color="grey", lw=0.8, ls=":")
        axis.set(title=rows[name][0].knob, xlabel="core-seconds")
        axis.grid(visible=True, alpha=0.3)
        axis.legend(fontsize=7, frameon=False)
    axes[0][0].set(ylabel="rms error, grey levels (dotted: half of one)")
    figure.savefig(path, dpi=90)
    pyplot.close(figure)
