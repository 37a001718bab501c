"""Baking files: where the results go, what they may replace, and one after the other.

Whatever can be refused is refused before the first mesh is read.
"""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from os.path import exists, isdir, realpath  # unlike Path's, these never raise
from pathlib import Path

import numpy as np

from meshdepict.baking.baked import Baked
from meshdepict.baking.budget import within_budget
from meshdepict.baking.look import Look
from meshdepict.baking.objects import bake_on_ground, scene_look, scene_meshes
from meshdepict.baking.pixel_widths import measured
from meshdepict.baking.provenance import fitted_text, sampled_text
from meshdepict.baking.refinement import worth_refining
from meshdepict.baking.smearing import CREASES, NOTEWORTHY, smeared_share
from meshdepict.baking.surfaces import as_solid, bake_surface, with_choices
from meshdepict.baking.targets import check_target, identities
from meshdepict.console import Heard, about, complain, notes, progress_bar, say
from meshdepict.drawing.figure import Figure, summary
from meshdepict.drawing.framing import check_scale, frame
from meshdepict.drawing.picture_files import PICTURES, check_picture, write_page
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import write_mesh
from meshdepict.io.folders import RASTERS
from meshdepict.io.source import FORMATS, WRITABLE, suffix_of
from meshdepict.options import Values, options_of
from meshdepict.scales.ladder import Progress
from meshdepict.shading.method import declaration
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.joined import JoinedMesh
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.icosahedron import icosphere

__all__ = ["MEMORY", "Batch", "Job", "caption_of", "check_look", "stem", "target_of", "unexpected"]

_GOLF_BALL = "golf-ball"
_BEFORE = "lambert"  # what every program shows
_NEXT = "next: meshdepict bake YOUR.ply --picture YOUR.png, meshdepict view, meshdepict methods"
_VISIBLE = 2  # grey levels
MEMORY = "out of memory: a simplified mesh needs less"


@dataclass(frozen=True)
class Job:
    """One bake: from a file, or the built-in golf ball where ``source`` is None."""

    source: Path | None
    output: Path
    picture: Path | None
    first: bool = False  # a first try: the picture shows before and after


@dataclass(frozen=True, kw_only=True)
class Batch:
    """Meshes and terrain to bake alike.

    Attributes
    ----------
    inputs : sequence of Path
        None at all means the built-in golf ball, with a picture of before and after.
    look : Look
    output, picture : str, optional
        A file or an existing folder; with several inputs, a folder. Without ``output`` the
        current folder, without ``picture`` no picture.
    figure : Figure
        How the pictures are laid out.
    winding : {"auto", "keep"}
    fix_winding : bool
        Whether turned faces are written.
    triangles : bool
        Whether polygons and strips are written as triangles.
    quantize : bool
        Whether .glb and .gltf hold positions in 16 bits.
    force : bool
        Whether to replace files that this program didn't write.
    quiet : bool
    """

    inputs: Sequence[Path]
    look: Look
    output: str | None = None
    picture: str | None = None
    figure: Figure = field(default_factory=Figure)
    winding: str = "auto"
    fix_winding: bool = False
    triangles: bool = False
    quantize: bool = False
    force: bool = False
    quiet: bool = False

    @cached_property
    def _input_identities(self) -> frozenset[Hashable]:
        return identities(self.inputs)

    @property
    def _folders(self) -> tuple[tuple[str, str | None], ...]:
        """Options that have to name folders where there are several inputs."""
        return ("-o", self.output), ("--picture", self.picture)

    def run(self) -> int:
        """Bake everything that can be baked; return how many failed, each with one line."""
        sources: Sequence[Path | None] = self.inputs or [None]
        done, heard = 0, Heard()
        jobs = self.jobs()
        spent = time.process_time()  # by the first of them: the program has begun
        for job in jobs:
            try:
                line = self._bake(job, heard, spent)
            except MeshdepictError as error:
                complain(about(job.source, error))
            except MemoryError:
                complain(about(job.source, MEMORY))
            except Exception as error:  # a fault of this program's: the other files go on
                complain(about(job.source, unexpected(error)))
            else:
                say(line)
                done += 1
            spent = 0.0
        heard.tell()
        if not self.inputs and done and not self.quiet:
            complain(_NEXT)
        if len(sources) > 1 and not self.quiet:
            complain(f"{done} of {len(sources)} baked")
        return len(sources) - done

    def jobs(self) -> list[Job]:
        """Choose and check the names of all files to write; complain of those that can't be.

        Raises
        ------
        MeshdepictError
            For what can't be with any of them.
        """
        check_look(self.look)
        if self.picture is not None:
            check_scale(self.look.view, self.figure)
        if len(self.inputs) > 1:
            for option, folder in self._folders:
                if folder is not None and not (isdir(folder) or _names_folder(folder)):
                    raise MeshdepictError(
                        f"{option} {folder} is no existing folder: several meshes need one "
                        "(end the name with / and it is made)"
                    )
        sources: Sequence[Path | None] = self.inputs or [None]
        jobs: dict[str, Job] = {}  # by the file that they write
        for source in sources:
            try:
                job = self._plan(source)
                twin = jobs.setdefault(realpath(job.output), job)
                if twin is not job:
                    raise MeshdepictError(
                        f"{source} would become {job.output} as {twin.source} does: "
                        "name its output with -o"
                    )
            except MeshdepictError as error:
                complain(error)
        return [*jobs.values()]

    def _plan(self, source: Path | None) -> Job:
        """Choose and check the names of the files to write."""
        if source is not None and not exists(source):
            raise MeshdepictError(f"{source}: there is no such file")
        name = f"{stem(source)}-{self.look.title}"
        output = target_of(self.output or ".", f"{name}.ply", "-o")
        _check_format(output)
        if self.quantize and suffix_of(output) not in (".glb", ".gltf"):
            raise MeshdepictError(
                f"{output}: --quantize is about .glb and .gltf: leave it out, or save as one"
            )
        picture, first = None, source is None and self.picture is None
        if first:
            picture = output.with_name(f"{stem(output)}.png")
        elif self.picture is not None:
            picture = target_of(self.picture, f"{name}.png", "--picture")
            check_picture(picture, self.figure)
        for path in filter(None, (output, picture)):
            check_target(path, force=self.force, inputs=self._input_identities)
        return Job(source, output, picture, first)

    def _read(self, source: Path | None) -> Mesh | HeightField:
        if source is None:
            from meshdepict import samples

            return samples.golf_ball()
        shape = as_solid(source, winding=self.winding)
        if isinstance(shape, Mesh):  # the ground of terrain is wound as it should be
            shape = shape.rewound() if self.fix_winding else shape
            shape = shape.as_triangles() if self.triangles else shape
        return shape

    def _check_fit(self, shape: Mesh | HeightField, look: Look) -> None:
        """Refuse what is too large for its picture, before the long work."""
        seen = self._seen(shape, look)
        frame(look.eye(seen), seen, self.figure)

    def _seen(self, shape: Mesh | HeightField, look: Look) -> Mesh | HeightField:
        """Return what a picture shows: terrain as high as it is baked, a mesh with its ground."""
        if isinstance(shape, HeightField):
            raised: HeightField = with_choices(shape, look)
            return raised
        return shape if look.ground is None else JoinedMesh(scene_meshes([shape], look))

    def _bake(self, job: Job, heard: Heard, spent: float = 0.0) -> str:
        """Bake one mesh, write the files and return the line about it; see `bake_job`."""
        label = job.source.name if job.source else _GOLF_BALL
        with (
            notes(job.source, quiet=self.quiet, heard=heard),
            progress_bar(label, quiet=self.quiet) as progress,
        ):
            return self.bake_job(job, spent=spent, progress=progress)

    def bake_job(
        self,
        job: Job,
        *,
        spent: float = 0.0,
        marks: Mapping[str, str] | None = None,
        progress: Progress | None = None,
    ) -> str:
        """Bake one mesh, write the files and return the line about it; what is odd it warns of.

        Parameters
        ----------
        job : Job
        spent : float
            Seconds of its budget that are gone already.
        marks : mapping of str, optional
            What else stands in the provenance of what is written.
        progress : callable, optional
            ``progress(done, total)``.

        Raises
        ------
        MeshdepictError
            As `bake`, and for a file that can't be read or written.
        """
        start = time.perf_counter()
        shape = self._read(job.source)
        look = self.look.posed(shape)
        if isinstance(shape, Mesh) and look.ground is not None:
            look = scene_look([shape], self.look)
        if job.picture:
            self._check_fit(shape, look)
        look = measured(look, self._seen(shape, look), self.figure if job.picture else None)
        spent += time.perf_counter() - start
        look, allowed = within_budget(
            look, shape, spent=spent, writes=True, pictured=job.picture is not None
        )
        baked = bake_on_ground(shape, look, progress=progress)
        if allowed is not None:
            baked.provenance["budget"] = str(allowed)
        for depiction in filter(None, (baked, baked.scene)):
            depiction.provenance.update(marks or {})
        self._save(baked, job.output)
        if job.first:
            job = self._show_first(baked, job, look)
        elif job.picture:
            from meshdepict.drawing.picture import save_picture

            save_picture(baked.scene or baked, job.picture, self.figure)
        for text in self._remarks(baked, job.output):
            warnings.warn(text, MeshdepictWarning, stacklevel=2)
        return caption_of(job, baked, time.perf_counter() - start)

    def _save(self, baked: Baked, path: Path) -> None:
        if not self.quantize:
            baked.save(path)
            return
        write_mesh(
            path, baked.mesh, colors=baked.colors, comments=baked.comments, quantize=self.quantize
        )

    def _show_first(self, baked: Baked, job: Job, look: Look) -> Job:
        """Draw before and after; where nothing can be drawn, leave the picture out with a note."""
        assert job.picture is not None
        from meshdepict.drawing.before_after import before_after

        before = bake_on_ground(baked.shape, look.replace(method=_BEFORE, blend=None, tint=None))
        captions = f"before: {_BEFORE}", f"after: {self.look.title}"
        try:
            page = before_after((before.scene or before, baked.scene or baked), captions)
        except (MeshdepictError, ImportError, RuntimeError) as error:
            warnings.warn(f"no picture could be drawn ({error})", MeshdepictWarning, stacklevel=3)
            return replace(job, picture=None)
        write_page(page, job.picture, baked.provenance)
        return job

    def _remarks(self, baked: Baked, output: Path) -> Iterator[str]:
        """Yield what is to be known about an output."""
        mesh = baked.shape
        if not isinstance(mesh, Mesh):
            return  # what follows is about edges and strips of a mesh
        if not mesh.areas.any():
            yield "none of its triangles has an area: there is no shape to see"
        error = None if self.quiet else baked.edge_error
        if error is not None and error.rms > _VISIBLE:
            yield (
                f"colours between vertices are off by {error.rms:.0f} of 255 grey levels (rms), at "
                f"{error.share:.0%} of the edges by more than 2: "
            ) + (
                "--refine 2 splits triangles there"
                if worth_refining(mesh)
                else "large triangles meet at sharp edges there, a finer mesh is needed"
            )
        look = baked.look
        if look is not None and look.refine is not None and mesh.textures is not None:
            yield (
                "split triangles have no texture coordinates any more: meshdepict texture shades "
                "between vertices without splitting any"
            )
        if not self.quiet and look is not None and look.refine is None:
            light = look.lighting(baked.view, mesh.kind) if look.light is None else look.light
            share = smeared_share(mesh, light)
            if share > NOTEWORTHY:
                yield (
                    f"sharp edges smear over {share:.0%} of the area: --creases {CREASES:g} keeps "
                    "planes of one tone"
                )
        strips = getattr(mesh.document, "has_strips", False)
        if strips and suffix_of(output) == ".ply":
            yield (
                "its triangle strips stay strips, of which PyVista and trimesh read the vertices "
                "only: --triangles writes faces"
            )


def check_look(look: Look) -> None:
    """Refuse a look that `bake` would refuse, by trying it on a sphere of twelve vertices.

    A method of terrain alone is tried on sixteen cells.

    Raises
    ------
    MeshdepictError
        As `bake`, but for what depends on the mesh.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what they say is about the sphere
        known = options_of(look.function)
        theirs = (name for name in look.options if isinstance(known[name].accepts, Values))
        usual = {
            "albedo": "none", "normals": "computed", "z_factor": 1.0, "budget": None,
            **dict.fromkeys(theirs),
        }  # fmt: skip
        if "one_light" in known:
            usual["one_light"] = None  # a sphere has no level ground
        asked = (look.function, *(layer.function for layer in look.layers))
        terrain = any("heights" in declaration(function).needs for function in asked)
        tried = HeightField(np.eye(4)) if terrain else Mesh(*icosphere(12))
        bake_surface(tried, look.replace(**usual))


def stem(source: Path | None) -> str:
    """Return a file's name without the suffixes that formats have."""
    if source is None:
        return _GOLF_BALL
    name = Path(source.name)
    if name.suffix.lower() in (*RASTERS, ".tif", ".tiff", ".npy"):
        return name.stem
    while name.suffix.lower() in (*FORMATS, ".gz"):
        name = name.with_suffix("")
    return name.name


def target_of(given: str, name: str, option: str) -> Path:
    """Return the file that an option names: itself, or one of the given name in a folder."""
    path = Path(given)
    if isdir(path):
        return path / name
    if _names_folder(given):
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise MeshdepictError(
                f"{option} {given}: the folder can't be made ({error.strerror})"
            ) from None
        return path / name
    return path


def _names_folder(given: str) -> bool:
    return given.endswith(("/", os.sep))


def _check_format(path: Path) -> None:
    writable = [*WRITABLE, ".html"]
    suffix = suffix_of(path)
    if suffix in PICTURES:
        raise MeshdepictError(
            f"{path}: colours are saved as {', '.join(writable)} (also with .gz), and a picture of "
            f"them beside that: --picture {path}"
        )
    if suffix not in writable:
        raise MeshdepictError(
            f"{path}: colours are saved as {', '.join(writable)} (also with .gz), not as "
            f"{suffix or 'a file without suffix; a folder ends with /'}"
        )


def unexpected(error: Exception) -> MeshdepictError:
    """Return what is said of a fault of this program's."""
    text = f"an unexpected fault, please report it ({type(error).__name__}: {error})"
    return MeshdepictError(text)


def caption_of(job: Job, baked: Baked, seconds: float) -> str:
    """Return what a plate's caption needs: file, method, light, widths in file units, seconds."""
    parts = [f"{job.output}: {summary(baked.provenance)}"]
    if allowed := baked.provenance.get("budget"):
        parts.append(allowed)
    if baked.look is not None and (text := fitted_text(baked.look)):
        parts.append(text)
    if text := sampled_text(baked.provenance):
        parts.append(text)
    if job.picture:
        parts.append(f"picture {job.picture}")
    return ", ".join([*parts, f"{seconds:.1f} s"])
