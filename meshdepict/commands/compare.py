"""``meshdepict compare``: methods × lights on one sheet, with congruence scores."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from meshdepict.baking.choice_list import AUTO
from meshdepict.commands.parameters import DETAIL, FILES, LOOK, Everywhere, LookWords, takes_words
from meshdepict.commands.values import as_light, options_by_method
from meshdepict.console import notes, progress_bar, say
from meshdepict.errors import MeshdepictError

__all__ = ["compare"]

_KINDS = {"-o": ".png", "--csv": ".csv", "--html": ".html"}


@takes_words(
    without=(
        "method",
        "light",
        "sampling",
        "colormap",
        "colormap2d",
        "blend",
        "tint",
        "transfer",
        "ground",
        "refine",
        "albedo",
        "two_sided",
        "budget",
    ),
    options=False,
)
def compare(
    source: Annotated[Path | None, Parameter(name="INPUT")] = None,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    csv: Annotated[Path | None, Parameter(group=FILES)] = None,
    page: Annotated[Path | None, Parameter(name="--html", group=FILES)] = None,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    size: Annotated[str, Parameter(group=FILES)] = "480x480",
    method: Annotated[list[str] | None, Parameter(name=["--method", "-m"], group=LOOK)] = None,
    light: Annotated[
        list[str] | None,
        Parameter(name="--light", group=LOOK, allow_leading_hyphen=True),
    ] = None,
    options: Annotated[list[str] | None, Parameter(name="--set", group=LOOK)] = None,
    per_pixel: Annotated[bool, Parameter(group=DETAIL, show_default=False)] = False,
    scored: Annotated[
        Literal["declared", "linear", "display"], Parameter(group=DETAIL)
    ] = "declared",
    flow: Annotated[Literal["depth", "slope"], Parameter(group=DETAIL)] = "depth",
    look: LookWords,
    winding: Annotated[Literal["auto", "keep"], Parameter(group=FILES)] = "auto",
    everywhere: Everywhere,
) -> None:
    """Compare methods under many lights on one sheet.

    Scores say how well each picture follows the shape. Without INPUT: the built-in golf ball.

    Parameters
    ----------
    source
        A mesh, or terrain; the built-in golf ball unless given.
    output
        Contact sheet to write, a PNG; <name>-compare.png in the current folder unless given.
    csv
        Also write the scores as a table.
    page
        Also write a page with plot, table, pictures and all settings.
    force
        Replace existing files that meshdepict didn't write.
    size
        Of each picture, in pixels; scores depend on it.
    method
        A method to compare; repeatable. Six unless given.
    light
        A light, as for bake; repeatable. The 21 lights of Local Light Alignment unless given.
    options
        An option of a method as METHOD.name=value. Repeatable.
    per_pixel
        Shade pixels, as the papers do, instead of vertices.
    scored
        Which values are scored: as each method declares, or linear or displayed ones of all alike.
    flow
        What the shape's flow is read from: its depth, as in the paper, or how its normals tilt.
    winding
        auto: turn faces that look inwards before shading; keep: believe the file.
    """
    from meshdepict import samples
    from meshdepict.baking.batch import stem
    from meshdepict.baking.surfaces import as_solid
    from meshdepict.baking.targets import check_target, identities
    from meshdepict.congruence import comparison
    from meshdepict.congruence import report as comparison_report
    from meshdepict.drawing.figure import Figure

    everywhere.obey()
    quiet = everywhere.quiet
    name = stem(source)
    output = output or Path(f"{name}-compare.png")
    if output.is_dir():
        output = output / f"{name}-compare.png"
    for option, path in (("-o", output), ("--csv", csv), ("--html", page)):
        if path is None:
            continue
        if path.suffix.lower() != _KINDS[option]:
            raise MeshdepictError(f"{option} {path}: end the name with {_KINDS[option]}")
        check_target(path, force=force, inputs=identities([source]))
    pixels = Figure(size=size).pixels
    assert pixels is not None  # as a size was given
    given = options_by_method(options or [])
    lights = None if light is None else [as_light(text) for text in light]
    with notes(source, quiet=quiet), progress_bar(name, quiet=quiet) as progress:
        mesh = samples.golf_ball() if source is None else as_solid(source, winding=winding)
        found = comparison.compare(
            mesh, method or None, lights=lights, size=pixels, options=given,
            per_pixel=per_pixel, scored=scored, flow=flow, progress=progress,
            **{"view": AUTO, "up": AUTO, **look.said},
        )  # fmt: skip
        comparison_report.save_sheet(found, output)
        if csv is not None:
            comparison_report.save_table(found, csv)
        if page is not None:
            comparison_report.save_page(found, page, title=name)
    for row, mean in zip(found.methods, found.means, strict=True):
        say(f"{row:<20} {mean:.3f}")
    written = ", ".join(str(path) for path in (output, csv, page) if path is not None)
    lights_text = f"{len(found.lights)} light{'s' * (len(found.lights) != 1)}"
    say(f"{written}: mean congruence, {lights_text}, {found.seconds:.1f} s")
