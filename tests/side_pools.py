"""Pools that work in this process, one part after the other, and a mesh with relief to work on."""

from __future__ import annotations

from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from meshdepict.distributed.attempts import Outcome, attempt
from meshdepict.distributed.workers import Workers


class Here:
    """A pool without processes; ``spoil`` may change what becomes of a part."""

    ahead = 2

    def __init__(self, work, spoil=None):
        self.work, self.spoil, self.given = work, spoil, []

    def give(self, number, item):
        self.given.append((number, item))

    def take(self) -> Outcome:
        number, item = self.given.pop()  # the last one first: no order is promised
        found = attempt(self.work, number, item)
        return found if self.spoil is None else self.spoil(found)


@dataclass(frozen=True)
class WorkersHere(Workers):
    """Workers that are this process."""

    @contextmanager
    def at_work(self):
        yield lambda work: nullcontext(Here(work))


def rows_of(path: Path) -> bytes:
    """What a PLY file holds after its header."""
    return path.read_bytes().partition(b"end_header\n")[2]
