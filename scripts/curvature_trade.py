"""Measure how far curvature estimators are off, by resolution, noise and triangulation.

    python scripts/curvature_trade.py > tables.md      # about five minutes

Prints Markdown: docs/curvature.md is this output with sentences round it. Draws
docs/curvature_trade.png. Exact answers are those of the tests, peers are libigl, VTK and, where it
is installed, PyMeshLab. Best of several runs each, since whatever else a machine does only ever
adds time.
"""

from __future__ import annotations

import platform
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from curvature_cases import (
    ESTIMATORS,
    NOISES,
    QUALITIES,
    SIZES,
    SLOW,
    SURFACES,
    Found,
    ours,
    surface,
    vtk,
)
from exact_surfaces import Exact
from tables import head, row

import meshdepict as md
from benchmarks.timing import shortest
from meshdepict import samples
from meshdepict.curvature import principal_curvatures
from meshdepict.threads import thread_count

ROOT = Path(__file__).resolve().parent.parent


# --- measures ---------------------------------------------------------------------------------


def errors(found: Found, exact: Exact) -> dict[str, float]:
    """Return errors of k1, k2 and mean in per cent of the surface's own |k1|, of d1 in degrees.

    Root mean squares over the vertices away from borders; the median of the angles, where
    k1² − k2² is a tenth of its largest or more. Estimates are matched by sign, not by magnitude:
    where |k1| ≈ |k2| noise may swap the two.
    """
    inner = exact.inner
    unit = np.sqrt(np.mean(exact.k1[inner] ** 2)) / 100
    ours = np.sort(np.stack(found[:2]), axis=0)[:, inner]
    theirs = np.sort(np.stack([exact.k1, exact.k2]), axis=0)[:, inner]
    off = ours - theirs
    first = (exact.k1 > exact.k2)[inner]
    parts = {
        "k1": np.where(first, off[1], off[0]),
        "k2": np.where(first, off[0], off[1]),
        "mean": off.mean(axis=0),
    }
    result = {name: float(np.sqrt(np.mean(part**2)) / unit) for name, part in parts.items()}
    squares = exact.k1**2 - exact.k2**2
    clear = inner & (squares > 0.1 * np.square(exact.k1[inner]).max())
    result["d1"] = np.nan
    if found[2] is not None and clear.any():
        d1 = found[2][clear]
        length = np.maximum(np.linalg.norm(d1, axis=1), 1e-12)
        cosine = np.abs(np.einsum("ij,ij->i", d1, exact.d1[clear])) / length
        result["d1"] = float(np.median(np.degrees(np.arccos(np.minimum(cosine, 1)))))
    return result


Key = tuple[str, int, str, float, str]


def cases() -> Iterator[tuple[str, int, str, float]]:
    for name in SURFACES:
        for count in SIZES:
            yield name, count, "regular", 0.0
        for quality in QUALITIES:
            for noise in NOISES:
                if quality != "regular" or noise:
                    yield name, 10_000, quality, noise


def measured() -> dict[Key, dict[str, float]]:
    results: dict[Key, dict[str, float]] = {}
    for case in cases():
        exact = surface(*case)
        runs = 5 if case[1] <= 10_000 and case[2:] == ("regular", 0.0) else 1
        for label, (estimate, slow) in ESTIMATORS.items():
            if slow and case[1] > SLOW:
                continue
            found: list[Found] = []
            seconds = shortest(lambda e=estimate, m=exact.mesh, f=found: f.append(e(m)), runs)
            results[*case, label] = errors(found[-1], exact) | {"seconds": seconds}
        print(f"  {case}", file=sys.stderr, flush=True)
    return results


def over_surfaces(results, label, count, quality, noise, what, pick=np.median) -> float:
    values = [
        results[name, count, quality, noise, label][what]
        for name in SURFACES
        if (name, count, quality, noise, label) in results
    ]
    values = [value for value in values if not np.isnan(value)]
    return float(pick(values)) if values else np.nan


# --- tables -----------------------------------------------------------------------------------


def short(value: float) -> str:
    return (
        "–" if np.isnan(value) else f"{value:#.2g}".rstrip(".") if value < 99.5 else f"{value:.0f}"
    )


def tables(results) -> None:
    head("vertices, estimator", "k1 %", "k2 %", "mean %", "d1 °", "seconds")
    for count in SIZES:
        for label in ESTIMATORS:
            given = (results, label, count, "regular", 0.0)
            cells = [over_surfaces(*given, what) for what in ("k1", "k2", "mean", "d1")]
            if not np.isnan(cells[0]):
                seconds = over_surfaces(*given, "seconds", min)
                row(f"{count:,} {label}", *map(short, cells), f"{seconds:.3f}")
    for what, unit in (("mean", "%"), ("d1", "°")):
        columns = [f"{quality} {noise:g}" for quality in QUALITIES for noise in NOISES]
        head(f"{what}, {unit}", *columns)
        for label in ESTIMATORS:
            cells = [
                over_surfaces(results, label, 10_000, quality, noise, what)
                for quality in QUALITIES
                for noise in NOISES
            ]
            if not np.isnan(cells[0]):
                row(label, *map(short, cells))
    head("k1 % / k2 % / mean % / d1 °", *SURFACES)
    for label in ESTIMATORS:
        cells = []
        for name in SURFACES:
            found = results[name, 10_000, "regular", 0.0, label]
            cells.append(" / ".join(short(found[what]) for what in ("k1", "k2", "mean", "d1")))
        row(label, *cells)


def aims() -> None:
    head("work", "measured", "aim")
    for count, runs, aim in ((36_000, 40, "15 ms"), (1_750_000, 4, "600 ms")):
        mesh = surface("torus", count).mesh
        principal_curvatures(mesh)
        seconds = shortest(lambda m=mesh: principal_curvatures(m), runs)
        row(f"tensor, {len(mesh.vertices):,} vertices", f"{1e3 * seconds:.1f} ms", aim)
    found = principal_curvatures(samples.sphere(41_000))
    worst = max(np.abs(found.k1 - 1).max(), np.abs(found.k2 - 1).max())
    row("worst error of k, unit icosphere of 41 k vertices", f"{100 * worst:.1g} %", "1 %")
    ball = samples.sphere(10_000)
    rng = np.random.default_rng(2009)
    noisy = md.Mesh(
        ball.vertices * (1 + 1e-3 * rng.normal(size=(len(ball.vertices), 1))), ball.faces
    )
    head("mean curvature of a unit sphere, 0.1 % noise, 10 k vertices", "5 %", "50 %", "95 %")
    import igl

    rivals = {"VTK": lambda: np.mean(vtk(noisy)[:2], axis=0)}
    for edges in (2, 5):
        rivals[f"libigl, ball of {edges} × edge"] = lambda r=edges: np.mean(
            igl.principal_curvature(noisy.vertices, noisy.faces, r, useKring=False)[2:4], axis=0
        )
        for width in (edges / 2, edges):
            rivals[f"tensor, Gaussian of {width:g} × edge"] = lambda w=width: np.mean(
                ours("tensor", w)(noisy)[:2], axis=0
            )
    for label, work in rivals.items():
        row(label, *(f"{value:.3f}" for value in np.percentile(work(), [5, 50, 95])))


# --- the plot ---------------------------------------------------------------------------------


def plot(results, path: Path) -> None:
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 3, figsize=(13, 4.6), layout="constrained")
    for number, label in enumerate(ESTIMATORS):
        theirs = label.split()[0] in {"libigl,", "VTK", "PyMeshLab"}
        style = {"marker": "o", "ms": 4, "ls": ":" if theirs else "-", "color": f"C{number}"}
        sizes = [n for n in SIZES if ("torus", n, "regular", 0.0, label) in results]
        mean = [over_surfaces(results, label, n, "regular", 0.0, "mean") for n in sizes]
        seconds = [over_surfaces(results, label, n, "regular", 0.0, "seconds", min) for n in sizes]
        noisy = [
            over_surfaces(results, label, 10_000, "regular", noise, "mean") for noise in NOISES
        ]
        axes[0].loglog(sizes, mean, **style, label=label)
        axes[1].loglog([max(noise, 2e-5) for noise in NOISES], noisy, **style)
        axes[2].loglog(sizes, seconds, **style)
    axes[0].set(xlabel="vertices", ylabel="error of the mean curvature, %", title="without noise")
    axes[1].set(xlabel="noise, edges (leftmost: none)", title="10,000 vertices")
    axes[2].set(xlabel="vertices", ylabel="seconds", title=f"time, {thread_count()} cores")
    for axis in axes:
        axis.grid(visible=True, which="major", alpha=0.3)
    figure.legend(loc="outside lower center", ncols=5, frameon=False)
    figure.savefig(path, dpi=110)


def main() -> None:
    start = time.perf_counter()
    for estimate, _ in ESTIMATORS.values():
        estimate(surface("torus", 1_000).mesh)  # compile, load
    print(f"{thread_count()} cores, {platform.processor() or platform.machine()}, Python "
          f"{platform.python_version()}, meshdepict {md.__version__}.")  # fmt: skip
    aims()
    results = measured()
    tables(results)
    plot(results, ROOT / "docs" / "curvature_trade.png")
    print(f"{time.perf_counter() - start:.0f} s in all", file=sys.stderr)


if __name__ == "__main__":
    main()
