"""Many files baked alike: each a part of the work, and none that is done already.

A file counts as done where what it became says so: its provenance has a mark that is computed from
the input's bytes, the look and the version. Neither names nor dates count, and nor does what lies
beside an input: materials, textures.
"""

from __future__ import annotations

import re
import shutil
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from hashlib import blake2b
from os.path import abspath, exists
from pathlib import Path
from typing import Any, NamedTuple

from meshdepict.baking.batch import Batch, Job
from meshdepict.baking.choice_list import AUTO
from meshdepict.baking.recipe_files import files_named
from meshdepict.console import Heard, about, complain, progress_bar, say
from meshdepict.distributed.attempts import Outcome, Work, attempt, outcomes
from meshdepict.distributed.mesh_tiles import bake_by_tiles, check_tiles
from meshdepict.distributed.workers import Workers
from meshdepict.drawing.figure import summary
from meshdepict.drawing.picture_files import PICTURES, read_picture_provenance
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.mark import MARK, VERSION
from meshdepict.files.reach import regular
from meshdepict.io import read_provenance
from meshdepict.scales.ladder import Progress

__all__ = ["Done", "FileBatch", "Task", "bake_file"]

_KEY = "made by"
_CHUNK = 1 << 22


class Task(NamedTuple):
    """A file to bake, in a process that knows nothing but this."""

    batch: Batch
    job: Job
    recipe: str


class Done(NamedTuple):
    """What is to be said of a file.

    Attributes
    ----------
    line : str
        About what was written; "" where that was done before.
    notes : tuple of str
        What is odd.
    """

    line: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class FileBatch(Batch):
    """Meshes and terrain that several processes bake alike.

    Attributes
    ----------
    workers : Workers
    again : bool
        Whether what is done already is done again.
    tiles : int, optional
        Vertices of a tile, at most, where each mesh is shaded by tiles; see `mesh_tiles`.
    """

    workers: Workers
    again: bool = False
    tiles: int | None = None

    def run(self) -> int:
        """Bake what can be and isn't; return how many failed, each with one line."""
        if self.tiles is not None:
            check_tiles(self.look, self.tiles)
        jobs, heard = self.jobs(), Heard()
        done, there = 0, 0
        tasks = [Task(replace(self, inputs=()), _absolute(job), self._recipe) for job in jobs]
        with (
            progress_bar(f"{len(tasks)} files", quiet=self.quiet) as progress,
            self.workers.at_work() as pool_for,
        ):
            for ended, found in enumerate(self._outcomes(tasks, pool_for, progress), 1):
                source = jobs[found.number].source
                if found.error:
                    complain(about(source, _as_named(found.error, jobs[found.number])))
                else:
                    there += not found.value.line
                    done += bool(found.value.line)
                    self._tell(jobs[found.number], found.value, heard)
                if progress:
                    progress(ended, len(tasks))
        heard.tell()
        failed = len(self.inputs) - done - there
        if not self.quiet:
            complain(f"{done} baked, {there} done before, {failed} failed")
        return failed

    def _outcomes(
        self, tasks: Sequence[Task], pool_for: Callable[[Work], Any], progress: Progress | None
    ) -> Iterator[Outcome]:
        """Yield what becomes of every file: each a part of the work, or one after the other."""
        if self.tiles is None:
            with pool_for(bake_file) as pool:
                yield from outcomes(pool, tasks)
            return
        for number, task in enumerate(tasks):

            def bake(task: Task, ended: int = number) -> Done:
                def within(done: float, total: float) -> None:
                    if progress:
                        progress(ended + done / total, len(tasks))

                return self._by_tiles(task, pool_for, within)

            yield attempt(bake, number, task)

    def _by_tiles(self, task: Task, pool_for: Callable[[Work], Any], progress: Progress) -> Done:
        assert task.job.source is not None
        assert self.tiles is not None
        start = time.perf_counter()
        output, mark = task.job.output, _mark(task.job.source, task.recipe)
        if task.recipe and _says(output, mark):
            return Done("")
        _sweep(output)
        provenance = bake_by_tiles(
            task.job.source, output, self.look, pool_for,
            tile=self.tiles, marks={_KEY: mark}, progress=progress,
        )  # fmt: skip
        seconds = time.perf_counter() - start
        notes: tuple[str, ...] = ()
        if AUTO in (self.look.view, self.look.up):
            notes = ("a view or an up of auto looks at the whole mesh: front and y are taken",)
        doubt = (provenance["doubtful"],) if "doubtful" in provenance else ()
        return Done(f"{output}: {summary(provenance)}, {seconds:.1f} s", (*notes, *doubt))

    def _tell(self, job: Job, done: Done, heard: Heard) -> None:
        if done.line:
            say(_as_named(done.line, job))
        if not self.quiet:
            for text in heard.fresh(job.source, [_as_named(note, job) for note in done.notes]):
                complain(f"note: {about(job.source, text)}")

    @property
    def _recipe(self) -> str:
        """What beside the input makes the output, in short; the same for all files."""
        flags = (self.winding, self.fix_winding, self.triangles, self.quantize)
        said = (*flags, self.picture is None, self.tiles)
        found = blake2b(f"{VERSION} {self.look!r} {self.figure!r} {said}".encode(), digest_size=16)
        for path in files_named(self.look.words(), self.look.function):
            _add(found, Path(path))
        return "" if self.again else found.hexdigest()


def bake_file(task: Task) -> Done:
    """Bake a file, unless that is done.

    Raises
    ------
    MeshdepictError
        As `bake`, and for a file that can't be read or written.
    """
    batch, job, recipe = task
    mark = _mark(job.source, recipe)
    targets = [path for path in (job.output, job.picture) if path is not None]
    if recipe and all(_says(path, mark) for path in targets):
        return Done("")
    for path in targets:
        _sweep(path)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        line = batch.bake_job(job, marks={_KEY: mark})
    notes = [str(each.message) for each in said if issubclass(each.category, MeshdepictWarning)]
    return Done(line, tuple(dict.fromkeys(notes)))


def _mark(source: Path | None, recipe: str) -> str:
    assert source is not None
    found = blake2b(recipe.encode(), digest_size=16)
    regular(source)
    try:
        _add(found, source)
    except OSError as error:
        raise MeshdepictError(f"{source} can't be read: {error.strerror}") from None
    return found.hexdigest()


def _add(found: blake2b, path: Path) -> None:
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            found.update(chunk)


def _says(path: Path, mark: str) -> bool:
    """Whether a file is there and has the mark."""
    if not exists(path):
        return False
    read = read_picture_provenance if path.suffix.lower() in PICTURES else read_provenance
    with suppress(MeshdepictError):
        lines: Sequence[str] = read(path) or ()
        return any(line.removeprefix(MARK) == f"{_KEY}: {mark}" for line in lines)
    return False


def _sweep(path: Path) -> None:
    """Take away what a process began to write here before it was killed."""
    begun = re.compile(re.escape(f".{path.name[:100]}.") + r"[0-9a-f]{8}\.part")
    for other in path.parent.iterdir():
        if begun.fullmatch(other.name):
            other.unlink(missing_ok=True)
        elif other.name.startswith(f".{path.name[:100]}.") and other.name.endswith(".tiles"):
            shutil.rmtree(other, ignore_errors=True)


def _absolute(job: Job) -> Job:
    """Return a job with paths that another process understands, wherever it began."""
    source, output, picture = (
        None if path is None else Path(abspath(path))
        for path in (job.source, job.output, job.picture)
    )
    assert output is not None
    return replace(job, source=source, output=output, picture=picture)


def _as_named(text: str, job: Job) -> str:
    """Return what a process said, with the names that the files have here."""
    for path in (job.source, job.output, job.picture):
        if path is not None:
            text = text.replace(abspath(path), str(path))
    return text
