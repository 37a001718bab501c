"""Compare what bakes are predicted to take with what they take, as whole processes.

    MESHDEPICT_DATA=… python scripts/budget_check.py [LARGE.ply …]      # two minutes

Prints Markdown and writes docs/accuracy_predictions.md, which docs/accuracy.md takes in. Times are
the least of two runs: by the clock, which on a quiet machine is what counts, and of all processors
together, which other work disturbs less. The machine is measured anew. Where the median is off on a
quiet machine, `machine._REFERENCE_SECONDS` is that many times too large.
"""

from __future__ import annotations

import functools
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tables import ROOT

import meshdepict as md
from meshdepict.baking import costs, machine
from meshdepict.baking.budget import predicted_steps, predicted_time
from meshdepict.threads import thread_count

WITHIN = 0.3
RUNS = 2
FILES = {
    "bunny": "mesh/bunny_69k.ply",
    "dragon": "mesh/dragon_203k.ply",
    "flake": "mesh/flake1_152k.ply",
    "terrain": "dem/dem_slovenia_lidar_1m.tif",
    "head": "ct/ct_headsq_64x64x93.nrrd",
    "engine": "ct/ct_engine_256x256x128.nrrd",
}
CASES = (
    ("bunny", "exaggerated", "normal"), ("bunny", "exaggerated", "draft"),
    ("bunny", "sky_view", "draft"), ("bunny", "ambient_occlusion", "normal"),
    ("bunny", "lambert", "normal"), ("dragon", "exaggerated", "normal"),
    ("dragon", "radiance_scaling", "normal"), ("dragon", "light_alignment", "draft"),
    ("flake", "light_alignment", "normal"), ("flake", "sky_view", "normal"),
    ("terrain", "exaggerated", "normal"), ("terrain", "hillshade", "normal"),
    ("head", "exaggerated", "normal"), ("engine", "exaggerated", "normal"),
    ("engine", "radiance_scaling", "normal"),
)  # fmt: skip
LARGE_CASES = (("exaggerated", "normal"), ("radiance_scaling", "normal"), ("sky_view", "draft"))


@functools.cache
def read(path: Path) -> tuple[object, float]:
    """Return what a file holds, and the seconds that reading took."""
    begin = time.process_time()
    return md.read(path), time.process_time() - begin


def predicted(path: Path, method: str, accuracy: str) -> tuple[float, float]:
    """Return seconds by the clock, and of all processors."""
    shape, reading = read(path)
    steps = predicted_steps(shape, md.Look(method, accuracy=accuracy), writes=True)
    own = costs.PROGRAM_SECONDS / machine.speed() + reading
    return own + predicted_time(steps), own + sum(step.seconds for step in steps)


def taken(path: Path, method: str, accuracy: str) -> tuple[float, float]:
    """Return the least seconds of some processes, by the clock and of all processors."""
    command, suffix = "bake", ".ply"
    if path.suffix == ".tif":
        command, suffix = "relief", ".tif"
    elif path.suffix == ".nrrd":
        command, suffix = "volume", ".nrrd"
    words = ["--accuracy", accuracy, "-m", method, "--quiet", "--force"]
    times = []
    with tempfile.TemporaryDirectory() as folder:
        line = [sys.executable, "-m", "meshdepict", command, str(path), *words]
        for _ in range(RUNS):
            before, begin = _children(), time.perf_counter()
            subprocess.run([*line, "-o", f"{folder}/out{suffix}"], check=True, capture_output=True)
            times.append((time.perf_counter() - begin, _children() - before))
    return min(t[0] for t in times), min(t[1] for t in times)


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    if "MESHDEPICT_DATA" not in os.environ:
        sys.exit("set MESHDEPICT_DATA to the folder of real scans")
    folder = Path(os.environ["MESHDEPICT_DATA"])
    cases = [(name, folder / FILES[name], *rest) for name, *rest in CASES]
    for given in sys.argv[1:]:
        cases += [(Path(given).stem, Path(given), *rest) for rest in LARGE_CASES]
    machine.speed = functools.cache(lambda: machine._REFERENCE_SECONDS / machine.measured_seconds())
    lines = [
        "| bake, whole process | predicted | taken | by the clock | core-seconds predicted | taken "
        "| times |",
        "| --- " * 7 + "|",
    ]
    good, ratios_of_cores = [0, 0], []
    for name, path, method, accuracy in cases:
        ours, theirs = predicted(path, method, accuracy), taken(path, method, accuracy)
        ratios = [our / their for our, their in zip(ours, theirs, strict=True)]
        ratios_of_cores.append(ratios[1])
        good = [n + (abs(ratio - 1) <= WITHIN) for n, ratio in zip(good, ratios, strict=True)]
        lines.append(
            f"| {name}, {method}, {accuracy} | {ours[0]:.2f} | {theirs[0]:.2f} | × {ratios[0]:.2f} "
            f"| {ours[1]:.2f} | {theirs[1]:.2f} | × {ratios[1]:.2f} |"
        )
        print(lines[-1], file=sys.stderr, flush=True)
    lines += [
        "",
        f"Within {WITHIN:.0%}: {good[0]} of {len(cases)} by the clock of {thread_count()} cores, "
        f"{good[1]} in core-seconds; the machine {machine.speed():.2f} times as fast as the one "
        f"that the costs were measured on, load {os.getloadavg()[0]:.0f}; core-seconds are "
        f"predicted as {statistics.median(ratios_of_cores):.2f} times those taken (median).",
    ]
    text = "\n".join(lines)
    print(text)
    path = ROOT / "docs" / "accuracy_predictions.md"
    path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
