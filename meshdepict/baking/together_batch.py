"""Baking files whose objects stand together: one scene, a file of each, one picture."""

from __future__ import annotations

import re
import time
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

from meshdepict.baking.batch import MEMORY, Batch, Job, caption_of, stem, target_of, unexpected
from meshdepict.baking.objects import bake_objects, scene_look, scene_meshes
from meshdepict.baking.pixel_widths import measured
from meshdepict.baking.targets import check_target
from meshdepict.console import Heard, about, complain, notes, progress_bar, say
from meshdepict.drawing.framing import frame
from meshdepict.drawing.picture import save_picture
from meshdepict.drawing.picture_files import check_picture
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.joined import JoinedMesh
from meshdepict.shapes.mesh import Mesh

__all__ = ["TogetherBatch"]

_NAMED = 3  # files that a picture is named after


@dataclass(frozen=True, kw_only=True)
class TogetherBatch(Batch):
    """Meshes to bake as one scene; attributes are those of `Batch`.

    The picture is one of all: a file, or a folder.
    """

    @property
    def _folders(self) -> tuple[tuple[str, str | None], ...]:
        return (("-o", self.output),)

    def run(self) -> int:
        """Bake all, or none where one can't be; return how many failed."""
        jobs = self.jobs()
        if len(jobs) < len(self.inputs):
            complain("nothing is baked: all of them are needed together")
            return len(self.inputs)
        try:
            lines = self._bake_all(jobs, self._picture())
        except MeshdepictError as error:
            complain(error)
        except MemoryError:
            complain(MEMORY)
        except Exception as error:  # a fault of this program's
            complain(unexpected(error))
        else:
            for line in lines:
                say(line)
            return 0
        return len(self.inputs)

    def _plan(self, source: Path | None) -> Job:
        return replace(super()._plan(source), picture=None)

    def _picture(self) -> Path | None:
        """Choose and check the name of the picture."""
        if self.picture is None:
            return None
        names = [stem(source) for source in self.inputs]
        if len(names) > _NAMED:
            names[_NAMED - 1 :] = [f"{len(names) - _NAMED + 1}-more"]
        path = target_of(self.picture, f"{'-'.join(names)}-{self.look.title}.png", "--picture")
        check_picture(path, self.figure)
        check_target(path, force=self.force, inputs=self._input_identities)
        return path

    def _bake_all(self, jobs: list[Job], picture: Path | None) -> list[str]:
        """Bake the meshes, write the files and return the lines about them."""
        start, heard = time.perf_counter(), Heard()
        meshes = []
        for job in jobs:
            with notes(job.source, quiet=self.quiet, heard=heard):
                try:
                    shape = self._read(job.source)
                except MeshdepictError as error:
                    raise MeshdepictError(about(job.source, error)) from None
                if not isinstance(shape, Mesh):
                    raise MeshdepictError(f"{job.source}: only meshes stand together, not terrain")
                meshes.append(shape)
        figure = None if picture is None else self.figure
        with (
            notes(quiet=self.quiet),
            progress_bar(f"{len(jobs)} objects", quiet=self.quiet) as progress,
        ):
            look = scene_look(meshes, self.look)
            scene = JoinedMesh(scene_meshes(meshes, look))
            if figure is not None:
                frame(look.eye(scene), scene, figure)  # refuses what is too large, before the work
            look = measured(look, scene, figure)
            try:
                bakes = bake_objects(meshes, [look] * len(meshes), progress=progress)
            except MeshdepictError as error:
                raise MeshdepictError(_with_file(str(error), jobs)) from None
            for job, baked in zip(jobs, bakes, strict=True):
                self._save(baked, job.output)
            if picture is not None:
                save_picture(bakes.scene, picture, figure)
        seconds = time.perf_counter() - start
        for job, baked in zip(jobs, bakes, strict=True):
            with notes(job.source, quiet=self.quiet, heard=heard):
                for text in self._remarks(baked, job.output):
                    warnings.warn(text, MeshdepictWarning, stacklevel=2)
        heard.tell()
        jobs[-1] = replace(jobs[-1], picture=picture)
        return [caption_of(job, baked, seconds) for job, baked in zip(jobs, bakes, strict=True)]


def _with_file(said: str, jobs: list[Job]) -> str:
    """Return a refusal with the file's name in place of the object's number."""
    return re.sub(r"^object (\d+):", lambda found: f"{jobs[int(found[1]) - 1].source}:", said)
