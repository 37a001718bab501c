"""A campaign of spoiled files: every file tried in a process that may die, and how each ended."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

TRIAL = Path(__file__).resolve().parent / "trial.py"
PATIENCE = 120  # seconds without a word, after which a process is taken for hung

GOOD = ("read", "refused")
"""Outcomes that a spoiled file may have."""


class Outcome(NamedTuple):
    """How one file ended."""

    number: int
    seed: str
    ending: str
    words: str


def outcomes(first: int, last: int) -> Iterator[Outcome]:
    """Try the files of a span of numbers; one that kills its process costs a new one."""
    while first < last:
        done = first
        for found in _one_process(first, last):
            yield found
            done = found.number + 1
        first = done


def _one_process(first: int, last: int) -> Iterator[Outcome]:
    with tempfile.TemporaryDirectory(prefix="meshdepict-fuzz-") as folder:
        out = Path(folder) / "out.txt"
        with out.open("w", encoding="utf-8") as stream:
            process = subprocess.Popen(
                [sys.executable, str(TRIAL), folder, str(first), str(last)],
                stdout=stream, stderr=subprocess.DEVNULL, env=dict(os.environ),
            )  # fmt: skip
            ending = _waited(process, out)
        lines = out.read_text(encoding="utf-8").splitlines()
    for line in lines:
        number, seed, *rest = line.split("\t", 3)
        if len(rest) == 2 and rest[0]:
            yield Outcome(int(number), seed, *rest)
        else:
            yield Outcome(int(number), seed, "killed", ending)
    if not lines:
        raise RuntimeError(f"the process of trials did not begin: {ending}")


def _waited(process: subprocess.Popen[bytes], out: Path) -> str:
    """Wait for the end of a process, or until it has been silent for too long."""
    size = -1
    while True:
        try:
            return f"exit status {process.wait(PATIENCE)}"
        except subprocess.TimeoutExpired:
            if out.stat().st_size == size:
                process.kill()
                process.wait()
                return f"hung for {PATIENCE} s"
            size = out.stat().st_size
