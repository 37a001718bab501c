"""What ``meshdepict info`` prints: plain text in columns."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict import threads
from meshdepict.shapes.summary import data_rows, height_rows, mesh_rows, volume_rows
from meshdepict.shapes.table import columns

if TYPE_CHECKING:
    from meshdepict.baking.look import Look
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.volume import Volume

__all__ = ["explained", "info", "predicted"]

# A default bake: the program itself, and core-seconds and bytes of each vertex
# (scripts/cost_constants.py --bakes measures the four).
_START_SECONDS = 0.5
_VERTEX_SECONDS = 65e-6
_START_BYTES = 160e6
_VERTEX_BYTES = 1300
# Of these, of files alone; and seconds of a cell.
_FILE_BYTES = 1000
_CELL_FILE_SECONDS = 0.05e-6


def info(path: Path) -> str:
    """Return counts, size, defects, attributes and provenance of a file, whatever it holds."""
    from meshdepict.io import read_mesh, read_provenance
    from meshdepict.io.heightfields import is_heightfield_path
    from meshdepict.io.volumes import is_volume_path

    if is_heightfield_path(path):
        return _terrain_info(path)
    if is_volume_path(path):
        return _volume_info(path)
    mesh = read_mesh(path)
    seconds, size = predicted(mesh)
    rows = [
        *mesh_rows(mesh),
        *_oddities(mesh),
        *data_rows(mesh),
        ("default bake", f"about {_duration(seconds)} and {_bytes(size)} of memory"),
    ]
    lines = read_provenance(path) or []
    rows += [("" if i else "baked", line.split(" ", 1)[1]) for i, line in enumerate(lines)]
    return f"{path}\n{columns(rows, indent='  ')}"


def _terrain_info(path: Path) -> str:
    """Return size, heights, place and reference system of terrain, and what a bake costs."""
    from meshdepict.baking.look import Look
    from meshdepict.baking.plan import plan
    from meshdepict.io.heightfields import read_heightfield

    field = read_heightfield(path)
    found = plan(field, Look())
    work = _CELL_FILE_SECONDS * field.z.size + found.seconds
    seconds = _START_SECONDS + work / threads.thread_count()
    size = _START_BYTES + field.z.nbytes + found.size
    rows = [
        *height_rows(field),
        ("default bake", f"about {_duration(seconds)} and {_bytes(size)} of memory"),
    ]
    return f"{path}\n{columns(rows, indent='  ')}"


def _volume_info(path: Path) -> str:
    """Return size, spacing, values and share of voxels that are shown by default."""
    from meshdepict.io.volumes import read_volume

    return f"{path}\n{columns([*volume_rows(read_volume(path))], indent='  ')}"


def explained(path: Path, look: Look) -> str:
    """Return what a bake of a file computes, step by step, with its predicted cost.

    Reading is not predicted: it has just been done.
    """
    from meshdepict.baking import costs
    from meshdepict.baking.budget import predicted_steps, predicted_time, within_budget
    from meshdepict.baking.machine import speed
    from meshdepict.baking.plan import Step, plan

    begun = time.perf_counter()
    shape, what, size = _read(path)
    taken = time.perf_counter() - begun
    program = Step("program", "", costs.PROGRAM_SECONDS / speed(), _START_BYTES)
    look, allowed = within_budget(look, shape, spent=program.seconds + taken, writes=True)
    found = plan(shape, look)
    steps = [
        program,
        Step("file", f"read, {what}", taken, size),
        *predicted_steps(shape, look, writes=True),
        Step("", "while normals are smoothed", 0.0, found.working),
    ]
    cores, work = threads.thread_count(), sum(step.seconds for step in steps)
    clock, memory = predicted_time(steps), sum(step.size for step in steps)
    steps.append(Step("together", f"on {cores} cores about {_duration(clock)}", work, memory))
    rows = [("", "", "seconds of a core", "memory")]
    rows += [
        (step.what, step.where, f"{step.seconds:.2f}" if step.seconds else "",
         _bytes(step.size) if step.size else "")
        for step in steps
    ]  # fmt: skip
    text = f"{look.method} of {path}\n{columns(rows, indent='  ')}"
    if allowed is not None:
        text += f"\n  budget: {allowed}"
    left = [str(scale) for scale in range(1, len(found.widths)) if scale not in found.sets]
    if left:
        noun = "scale" if len(left) == 1 else "scales"
        text += f"\n  left out: normals of {noun} {', '.join(left)}, which nobody reads"
    return text


def _read(path: Path) -> tuple[Mesh | HeightField | Volume, str, float]:
    """Return what a file holds, how much that is, in words, and its bytes in memory."""
    from meshdepict.io import read_mesh
    from meshdepict.io.heightfields import is_heightfield_path, read_heightfield
    from meshdepict.io.volumes import is_volume_path, read_volume

    if is_heightfield_path(path):
        field = read_heightfield(path)
        return field, f"{field.count:,} cells", float(field.z.nbytes)
    if is_volume_path(path):
        volume = read_volume(path)
        return volume, f"{volume.n_samples:,} voxels", float(volume.values.nbytes)
    mesh = read_mesh(path)
    return mesh, f"{len(mesh.vertices):,} vertices", float(_FILE_BYTES * len(mesh.vertices))


def predicted(mesh: Mesh) -> tuple[float, float]:
    """Return roughly the seconds and bytes that a bake with default options takes.

    Measured on scans of 40 to 500 thousand vertices; right within a factor of two.
    """
    count = len(mesh.vertices)
    seconds = _START_SECONDS + _VERTEX_SECONDS * count / threads.thread_count()
    return seconds, _START_BYTES + _VERTEX_BYTES * count


def _oddities(mesh: Mesh) -> Iterable[tuple[str, str]]:
    from meshdepict.shapes.defects import find_defects

    found = find_defects(mesh)
    yield "parts", f"{found.parts:,}"
    counts = (
        (found.unreferenced_vertices, "unreferenced vertex", "unreferenced vertices"),
        (found.coincident_vertices, "coincident vertex", "coincident vertices"),
        (found.degenerate_faces, "degenerate face", "degenerate faces"),
        (found.duplicate_faces, "duplicate face", "duplicate faces"),
        (found.border_edges, "border edge", "border edges"),
        (found.nonmanifold_edges, "non-manifold edge", "non-manifold edges"),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is a row of the report
        message = mesh.orientation.message
    texts = [f"{count:,} {one if count == 1 else many}" for count, one, many in counts if count]
    texts += [message] if message else []
    for i, text in enumerate(texts or ["none"]):
        yield "" if i else "defects", text


def _duration(seconds: float) -> str:
    if seconds < 10:
        return f"{seconds:.1f} s"
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def _bytes(size: float) -> str:
    if size < 1e7:
        return f"{size / 1e6:.1f} MB"
    return f"{size / 1e6:.0f} MB" if size < 1e9 else f"{size / 1e9:.1f} GB"
