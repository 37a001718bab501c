"""What is measured: golf balls, the same bits everywhere, and scans where they are at hand."""

from __future__ import annotations

import functools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import meshdepict as md

BALLS = {"golf ball": 36_000, "large golf ball": 72_000}  # vertices
SCANS = {"bunny": "mesh/bunny_69k.ply"}  # in the folder of real scans
MADE = ("bunny_144k", "arma_3500k")  # by make_large.py of that folder
SUBJECTS = (*BALLS, *SCANS, "bunny_144k")


@functools.cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="meshdepict-subjects-")


@functools.cache
def path(subject: str) -> Path:
    """Return the file of a subject, or of any mesh file itself.

    Raises
    ------
    NotImplementedError
        Where there are no scans: asv leaves the benchmark out.
    """
    if subject in BALLS:
        file = Path(_folder().name) / f"{subject.replace(' ', '-')}.ply"
        md.bake(md.samples.golf_ball(BALLS[subject]), "lambert").save(file)
        return file
    if subject not in (*SCANS, *MADE):
        return Path(subject)
    if "MESHDEPICT_DATA" not in os.environ:
        raise NotImplementedError("MESHDEPICT_DATA doesn't name the folder of real scans")
    data = Path(os.environ["MESHDEPICT_DATA"])
    if subject in SCANS:
        return data / SCANS[subject]
    made = [sys.executable, str(data / "make_large.py"), subject, "--out", _folder().name]
    subprocess.run(made, check=True, stdout=subprocess.DEVNULL)
    return Path(_folder().name) / f"{subject}.ply"


@functools.cache
def mesh(subject: str) -> md.Mesh:
    """Return a subject with all that does not belong to its scale space computed."""
    if subject in BALLS:
        return ready(md.samples.golf_ball(BALLS[subject]))
    return ready(md.read_mesh(path(subject)))


def ready(found: md.Mesh) -> md.Mesh:
    """Compute normals, areas and edge length of a mesh."""
    assert len(found.normals) == len(found.areas)
    assert found.edge_length > 0
    return found
