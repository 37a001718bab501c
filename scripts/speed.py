"""Measure how long baking takes, and the trade of speed for accuracy.

    MESHDEPICT_DATA=… python scripts/speed.py             # a few minutes
    MESHDEPICT_DATA=… python scripts/speed.py --large     # and 3.5 million faces

Prints Markdown: docs/speed.md is this output with a sentence round it. Best of several runs each,
since whatever else a machine does only ever adds time. The larger meshes are made by
make_large.py of the data folder.
"""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import meshdepict as md
from meshdepict.threads import thread_count


def best(work: Callable[[], object], runs: int) -> float:
    """Return the shortest time of several runs, in seconds."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def ready(path: Path) -> md.Mesh:
    """Read a mesh and compute what does not belong to the scale space."""
    mesh = md.read_mesh(path)
    assert len(mesh.normals) == len(mesh.areas)
    assert mesh.edge_length > 0
    return mesh


def row(*cells: object) -> None:
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def head(*cells: str) -> None:
    print()
    row(*cells)
    row(*("---" for _ in cells))


def scale_spaces(meshes: dict[str, md.Mesh]) -> None:
    head("scale space, 9 scales, facing 1, tolerance 1e-4", "vertices", "seconds", "aim")
    for (name, mesh), aim in zip(meshes.items(), ("0.8", "1.6"), strict=False):
        md.scale_space(mesh, scales=9)
        row(
            name, f"{len(mesh.vertices):,}", f"{best(lambda m=mesh: md.scale_space(m), 7):.2f}", aim
        )


def trade(mesh: md.Mesh) -> None:
    head(
        "tolerance, radians",
        "seconds, facing 1",
        "seconds, facing 0",
        "largest error met, facing 1",
    )
    finest = 1e-7
    exact = md.scale_space(mesh, tolerance=finest).normals.astype(float)
    for tolerance in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, finest):
        seconds = [
            best(lambda f=f, t=tolerance: md.scale_space(mesh, tolerance=t, facing=f), 3)
            for f in (1, 0)
        ]
        normals = md.scale_space(mesh, tolerance=tolerance).normals
        error = 2 * np.arcsin(np.linalg.norm(normals - exact, axis=2).max() / 2)
        met = "what the others are measured against" if tolerance == finest else f"{error:.1e}"
        row(f"{tolerance:g}", *(f"{s:.2f}" for s in seconds), met)


def growth(mesh: md.Mesh) -> None:
    head("one width, tolerance 1e-4", "seconds", "relative to the quickest")
    times = {}
    for edges in (1, 2, 4, 8, 16, 32, 64, 128, 300):
        width = edges * mesh.edge_length
        times[edges] = best(lambda w=width: md.scale_space(mesh, scales=1, width=w), 5)
    quickest = min(t for e, t in times.items() if e >= 4)
    for edges, seconds in times.items():
        row(f"{edges} edges", f"{seconds:.3f}", f"{seconds / quickest:.1f}" if edges >= 4 else "")


def lights(mesh: md.Mesh) -> None:
    space = md.scale_space(mesh, scales=9)
    angles = iter(np.linspace(0, 360, 10_000))
    md.shading.exaggerated(space, "northwest")
    count = 50

    def turn() -> None:
        for _ in range(count):
            md.shading.exaggerated(space, (next(angles), 30.0))

    seconds = best(turn, 8) / count
    head("new light, exaggerated", "faces", "milliseconds", "a second", "aim")
    row("9 scales", f"{len(mesh.faces):,}", f"{1e3 * seconds:.2f}", f"{1 / seconds:.0f}", "600")


def processes(bunny: Path, folder: Path) -> None:
    head("whole process", "seconds", "aim")

    def run(*arguments: str, cache: str | None = None) -> None:
        env = os.environ | ({"NUMBA_CACHE_DIR": cache} if cache else {})
        subprocess.run([sys.executable, *arguments], check=True, cwd=folder, env=env,
                       stdout=subprocess.DEVNULL)  # fmt: skip

    empty = best(lambda: run("-c", "pass"), 9)
    loaded = best(lambda: run("-c", "import meshdepict"), 9)
    row("import meshdepict, beyond Python itself", f"{loaded - empty:.3f}", "0.15")
    with tempfile.TemporaryDirectory() as cache:
        bake = ("-m", "meshdepict", "bake", str(bunny), "--force")
        row(
            "meshdepict bake bunny, very first run",
            f"{best(lambda: run(*bake, cache=cache), 1):.1f}",
            "20",
        )
        row(
            "meshdepict bake bunny, caches warm",
            f"{best(lambda: run(*bake, cache=cache), 5):.1f}",
            "3",
        )


def large(path: Path) -> None:
    head("3.5 million faces, 13 scales, tolerance 1e-3", "seconds", "aim")
    start = time.perf_counter()
    mesh = ready(path)
    row("read, orient, normals, areas, edges", f"{time.perf_counter() - start:.1f}", "")
    start = time.perf_counter()
    md.scale_space(mesh, scales=13, tolerance=1e-3)
    row("scale space", f"{time.perf_counter() - start:.1f}", "100")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2
    row("peak memory, GB", f"{peak:.2f}", "4")


def main() -> None:
    if "MESHDEPICT_DATA" not in os.environ:
        sys.exit("set MESHDEPICT_DATA to the folder of real scans")
    data = Path(os.environ["MESHDEPICT_DATA"])
    print(f"{thread_count()} cores, {platform.processor() or platform.machine()}, Python "
          f"{platform.python_version()}, meshdepict {md.__version__}.")  # fmt: skip
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def made(preset: str) -> Path:
            subprocess.run([sys.executable, str(data / "make_large.py"), preset, "--out", name],
                           check=True, stdout=subprocess.DEVNULL)  # fmt: skip
            return folder / f"{preset}.ply"

        if "--large" in sys.argv:
            large(made("arma_3500k"))
        bunny = data / "mesh" / "bunny_69k.ply"
        meshes = {"Stanford bunny": ready(bunny), "bunny_144k": ready(made("bunny_144k"))}
        scale_spaces(meshes)
        lights(meshes["bunny_144k"])
        growth(meshes["bunny_144k"])
        trade(meshes["Stanford bunny"])
        processes(bunny, folder)


if __name__ == "__main__":
    main()
