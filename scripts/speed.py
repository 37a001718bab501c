"""Measure how long baking takes, and the trade of speed for accuracy.

    MESHDEPICT_DATA=… python scripts/speed.py             # a few minutes
    MESHDEPICT_DATA=… python scripts/speed.py --large     # and 3.5 million faces

Prints Markdown: docs/speed.md is this output with a sentence round it. Best of several runs each,
since whatever else a machine does only ever adds time. What is timed stands in `benchmarks/`. The
larger meshes are made by make_large.py of the data folder.
"""

from __future__ import annotations

import os
import platform
import resource
import sys

import numpy as np
from scipy.spatial import cKDTree
from tables import head, row

import meshdepict as md
from benchmarks import lights, processes, scale_spaces, subjects
from benchmarks.timing import best, shortest, statement_seconds
from meshdepict.threads import thread_count

MESHES = {"bunny": ("Stanford bunny", "0.8"), "bunny_144k": ("bunny_144k", "1.6")}


def making() -> None:
    head("scale space, 9 scales, facing 1, tolerance 1e-4", "vertices", "seconds", "aim")
    for subject, (name, aim) in MESHES.items():
        seconds = best(scale_spaces.Making(), "time_making", subject, runs=7)
        row(name, f"{len(subjects.mesh(subject).vertices):,}", f"{seconds:.2f}", aim)


def trade(subject: str) -> None:
    head(
        "tolerance, radians",
        "seconds, facing 1",
        "seconds, facing 0",
        "largest error met, facing 1",
        "times a k-d tree, facing 1",
    )
    mesh, finest = subjects.mesh(subject), min(scale_spaces.TOLERANCES)
    # Of the vertices, built and asked for 32 neighbours: machines differ.
    tree = shortest(
        lambda: cKDTree(mesh.unit_points).query(mesh.unit_points, k=32, workers=thread_count())
    )
    exact = md.scale_space(mesh, tolerance=finest).normals.astype(float)
    for tolerance in scale_spaces.TOLERANCES:
        seconds = [
            best(scale_spaces.Tolerance(), "time_making", subject, tolerance, facing)
            for facing in (1, 0)
        ]
        normals = md.scale_space(mesh, tolerance=tolerance).normals
        error = 2 * np.arcsin(np.linalg.norm(normals - exact, axis=2).max() / 2)
        met = "what the others are measured against" if tolerance == finest else f"{error:.1e}"
        row(f"{tolerance:g}", *(f"{s:.2f}" for s in seconds), met, f"{seconds[0] / tree:.1f}")


def growth(subject: str) -> None:
    head("one width, tolerance 1e-4", "seconds", "relative to the quickest")
    times = {
        edges: best(scale_spaces.OneWidth(), "time_making", subject, edges, runs=5)
        for edges in scale_spaces.EDGES
    }
    quickest = min(t for e, t in times.items() if e >= 4)
    for edges, seconds in times.items():
        row(f"{edges} edges", f"{seconds:.3f}", f"{seconds / quickest:.1f}" if edges >= 4 else "")


def new_light(subject: str) -> None:
    seconds = best(lights.NewLight(), "time_shading", subject, runs=400)
    head("new light, exaggerated", "faces", "milliseconds", "a second", "aim")
    faces = len(subjects.mesh(subject).faces)
    row("9 scales", f"{faces:,}", f"{1e3 * seconds:.2f}", f"{1 / seconds:.0f}", "600")


def whole_processes(subject: str) -> None:
    head("whole process", "seconds", "aim")
    seconds = statement_seconds(processes.Import().timeraw_package())
    row("import meshdepict, beyond Python itself", f"{seconds:.3f}", "0.15")
    for name, what, aim, runs in (
        ("time_first_baking", "very first run", "20", 1),
        ("time_baking", "caches warm", "3", 5),
    ):
        seconds = best(processes.Command(), name, subject, runs=runs)
        row(f"meshdepict bake {subject}, {what}", f"{seconds:.1f}", aim)


def large() -> None:
    head("3.5 million faces, 13 scales, tolerance 1e-3", "seconds", "aim")
    os.environ["MESHDEPICT_HUGE"] = "1"
    seconds = best(scale_spaces.Huge(), "time_reading", runs=1)
    row("read, orient, normals, areas, edges", f"{seconds:.1f}", "")
    row("scale space", f"{best(scale_spaces.Huge(), 'time_making', runs=1):.1f}", "100")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2
    row("peak memory, GB", f"{peak:.2f}", "4")


def main() -> None:
    if "MESHDEPICT_DATA" not in os.environ:
        sys.exit("set MESHDEPICT_DATA to the folder of real scans")
    print(f"{thread_count()} cores, {platform.processor() or platform.machine()}, Python "
          f"{platform.python_version()}, meshdepict {md.__version__}.")  # fmt: skip
    if "--large" in sys.argv:
        large()
    making()
    new_light("bunny_144k")
    growth("bunny_144k")
    trade("bunny")
    whole_processes("bunny")


if __name__ == "__main__":
    main()
