"""``meshdepict volume``: shade CT, draw it, and write the shaded voxels or a surface."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from meshdepict.commands import parameters
from meshdepict.commands.parameters import (
    FILES,
    LOOK,
    Everywhere,
    FigureWords,
    LookWords,
    takes_words,
)
from meshdepict.commands.values import as_numbers
from meshdepict.console import notes, progress_bar, say
from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import Progress

__all__ = ["volume"]

if TYPE_CHECKING:
    from meshdepict.baking.look import Look
    from meshdepict.drawing.figure import Figure
    from meshdepict.shapes.volume import Volume


@takes_words(
    without=("colormap", "colormap2d", "blend", "tint", "facing", "refine", "albedo", "ground")
)
def volume(
    source: Annotated[Path | None, Parameter(name="CT")] = None,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    picture: Annotated[Path | None, Parameter(group=FILES)] = None,
    before: Annotated[Path | None, Parameter(group=FILES)] = None,
    slices: Annotated[list[str] | None, Parameter(name="--slice", group=FILES)] = None,
    series: Annotated[str | None, Parameter(group=FILES)] = None,
    slope: parameters.Number = None,
    intercept: parameters.Number = None,
    spacing: Annotated[str | None, Parameter(group=FILES)] = None,
    tilt: Annotated[Literal["resample", "refuse"], Parameter(group=FILES)] = "resample",
    clip: Annotated[list[str] | None, Parameter(group=FILES)] = None,
    surface: Annotated[
        float | None,
        Parameter(
            name="--surface", group=LOOK, allow_leading_hyphen=True, converter=parameters.number
        ),
    ] = None,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    look: LookWords,
    figure: FigureWords,
    everywhere: Everywhere,
) -> None:
    """Shade the voxels of a CT and write a picture.

    A transfer function says which are shown. Without CT: the built-in phantom.

    Parameters
    ----------
    source
        A folder of DICOM files or of slices as TIFF, BMP, PNG or JPEG; NIfTI, NRRD, MHA, VTI, a
        TIFF stack, NPY.
    output
        Write the shaded voxels as RGBA (.vti, .nrrd, .mha, .nii), or with --surface a mesh.
    picture
        Render a picture, PNG, JPEG, SVG or PDF; <name>-<method>.png in the current folder where
        nothing else is asked for.
    before
        Also render VTK's own shading, for comparison.
    slices
        Also write a slice as AXIS=SHARE, such as z=50%, beside the picture. Repeatable.
    series
        Which of several DICOM series in a folder: its number or id.
    slope
        HU = slope · number + intercept, for files of raw numbers.
    intercept
        See slope.
    spacing
        Of voxels in x,y,z, for files that don't say: 0.5,0.5,1.
    tilt
        What to do with slices of a tilted gantry: resample them to a straight grid, or refuse.
    clip
        Keep a part of the grid, AXIS=FROM:TO, such as y=50%:100%. Repeatable.
    surface
        Shade the surface at this value as a mesh, instead of voxels.
    force
        Replace existing files that meshdepict didn't write.
    """
    from meshdepict.baking.budget import within_budget
    from meshdepict.io.volumes import volume_stem

    everywhere.obey()
    quiet = everywhere.quiet
    start, spent = time.perf_counter(), time.process_time()
    name = "ct-phantom" if source is None else volume_stem(source)
    page = figure.figure()
    wanted = parameters.said_look(look)
    method = wanted.method
    box = dict(_span(text) for text in clip or [])
    if output is None and picture is None:
        picture = Path(f"{name}-{method}.png")
    beside = picture or before or Path(f"{name}-{method}.png")
    cuts = {
        beside.with_name(f"{beside.stem}-{axis}{share:.0%}.png".replace("%", "")): (axis, share)
        for axis, share in map(_place, slices or [])
    }
    if surface is not None and (before or cuts):
        raise MeshdepictError("--before and --slice show voxels, --surface a mesh: leave one out")
    _check_targets(
        source, output, (picture, before, *cuts), figure=page, mesh=surface is not None, force=force
    )
    with notes(source, quiet=quiet), progress_bar(name, quiet=quiet) as progress:
        grid = _read(source, series, slope, intercept, spacing, tilt).cropped(**box)
        wanted, allowed = within_budget(
            wanted, grid, spent=spent + time.perf_counter() - start,
            writes=output is not None, pictured=picture is not None,
        )  # fmt: skip
        if surface is not None:
            about = _shade_surface(grid, surface, wanted, progress, output, picture, page)
        else:
            about = _shade_voxels(grid, wanted, progress, output, picture, before, cuts, page)
    written = ", ".join(str(path) for path in filter(None, (output, picture, before, *cuts)))
    seconds = time.perf_counter() - start
    lamp = vars(look)["light"] or wanted.lit_by
    told = "" if allowed is None else f"{allowed}, "
    say(f"{written}: {method}, light {lamp}, {about}, {told}{seconds:.1f} s")


def _shade_surface(
    grid: Volume,
    value: float,
    look: Look,
    progress: Progress | None,
    output: Path | None,
    picture: Path | None,
    figure: Figure,
) -> str:
    """Bake the isosurface, write what is asked for and say what it was."""
    from meshdepict.baking.pixel_widths import measured
    from meshdepict.baking.provenance import fitted_text
    from meshdepict.baking.surfaces import bake_surface
    from meshdepict.drawing.picture import save_picture
    from meshdepict.shapes.isosurface import isosurface

    look = look.posed(grid).replace(transfer=None)
    look = look.replace(up=look.axis(grid.kind))
    surface = isosurface(grid, value)
    look = measured(look, surface, None if picture is None else figure)
    done = bake_surface(surface, look, progress=progress)
    if output is not None:
        done.save(output)
    if picture is not None:
        save_picture(done, picture, figure)
    tones = [fitted_text(done.look)] if done.look is not None and done.look.fitted else []
    return ", ".join([*tones, f"{len(surface.faces):,} triangles at {value:g} {grid.unit}"])


def _shade_voxels(
    grid: Volume,
    look: Look,
    progress: Progress | None,
    output: Path | None,
    picture: Path | None,
    before: Path | None,
    cuts: dict[Path, tuple[str, float]],
    figure: Figure,
) -> str:
    """Bake the voxels, write what is asked for and say how many they were."""
    from meshdepict.baking.pixel_widths import measured
    from meshdepict.baking.provenance import fitted_text
    from meshdepict.baking.volumes import bake_grid
    from meshdepict.drawing.picture_files import write_picture
    from meshdepict.drawing.slices import draw_slice
    from meshdepict.drawing.volume_picture import save_volume_picture

    look = measured(look, grid, None if picture is None else figure)
    baked = bake_grid(grid, look, progress=progress)
    if output is not None:
        baked.save(output)
    if picture is not None:
        save_volume_picture(baked, picture, figure)
    if before is not None:
        save_volume_picture(baked, before, figure, plain=True)
    for path, (axis, share) in cuts.items():
        write_picture(draw_slice(baked, axis, share), path, baked.provenance)
    tones = [fitted_text(baked.look)] if baked.look is not None and baked.look.fitted else []
    return ", ".join([*tones, f"{baked.shaded_share:.1%} of {grid.n_samples:,} voxels shaded"])


def _check_targets(
    source: Path | None,
    output: Path | None,
    pictures: tuple[Path | None, ...],
    *,
    figure: Figure,
    mesh: bool,
    force: bool,
) -> None:
    """Refuse what can't be written, before anything is read."""
    from meshdepict.baking.targets import check_target, identities
    from meshdepict.drawing.picture_files import check_picture
    from meshdepict.io.source import WRITABLE, suffix_of
    from meshdepict.io.volumes import WRITABLE_VOLUMES

    if output is not None:
        wanted = tuple(WRITABLE if mesh else WRITABLE_VOLUMES)
        if not (suffix_of(output) in wanted or output.name.lower().endswith(wanted)):
            raise MeshdepictError(f"-o {output}: end the name with {', '.join(wanted)}")
        check_target(output, force=force, inputs=identities([source]))
    for path in filter(None, pictures):
        check_picture(path, figure)
        check_target(path, force=force, inputs=identities([source]))


def _read(
    source: Path | None,
    series: str | None,
    slope: float | None,
    intercept: float | None,
    spacing: str | None,
    tilt: str,
) -> Volume:
    from meshdepict.io.volumes import read_volume
    from meshdepict.samples.phantom import ct_phantom

    if source is None:
        return ct_phantom((128, 128, 128))
    number = int(series) if series is not None and series.isdecimal() else series
    lengths = None
    if spacing is not None:
        lengths = as_numbers(spacing, "--spacing", 3)
    return read_volume(
        source, series=number, slope=slope, intercept=intercept, spacing=lengths, tilt=tilt
    )


def _share(text: str, whole: str) -> float:
    try:
        share = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        share = -1.0
    if not 0 <= share <= 1:
        raise MeshdepictError(f"{whole}: {text!r} is not a share of the axis, such as 40% or 0.4")
    return share


def _place(text: str) -> tuple[str, float]:
    axis, equals, share = text.partition("=")
    if not equals or axis not in ("x", "y", "z"):
        raise MeshdepictError(f"--slice wants AXIS=SHARE such as z=50%, not {text!r}")
    return axis, _share(share, f"--slice {text}")


def _span(text: str) -> tuple[str, tuple[float, float]]:
    axis, equals, span = text.partition("=")
    first, colon, last = span.partition(":")
    if not equals or not colon or axis not in ("x", "y", "z"):
        raise MeshdepictError(f"--clip wants AXIS=FROM:TO such as y=50%:100%, not {text!r}")
    whole = f"--clip {text}"
    return axis, (_share(first or "0", whole), _share(last or "1", whole))
