"""``meshdepict batch``: bake many files by several processes, here or on a cluster."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from meshdepict.commands import parameters
from meshdepict.commands.parameters import (
    EVERYWHERE,
    FILES,
    Everywhere,
    FigureWords,
    LookWords,
    takes_words,
    whole,
)
from meshdepict.console import FAULT
from meshdepict.errors import MeshdepictError

__all__ = ["batch"]


@takes_words(without=("transfer",))
def batch(
    *inputs: Annotated[Path, Parameter(name="FILES")],
    output: Annotated[str | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    picture: Annotated[str | None, Parameter(group=FILES)] = None,
    winding: Annotated[Literal["auto", "keep"], Parameter(group=FILES)] = "auto",
    tiles: Annotated[int | None, Parameter(group=FILES, converter=whole)] = None,
    again: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    scheduler: Annotated[str | None, Parameter(group=EVERYWHERE)] = None,
    workers: Annotated[int | None, Parameter(group=EVERYWHERE, converter=whole)] = None,
    look: LookWords,
    figure: FigureWords,
    everywhere: Everywhere,
) -> int:
    """Bake many files at once, by processes of this machine or a Dask cluster.

    What is done already is left alone: after an interruption the same command goes on. A file that
    fails doesn't stop the others, and one whose process ends is tried again.

    Parameters
    ----------
    inputs
        Meshes or terrain, as for meshdepict bake.
    output
        A folder (end its name with / and it is made), or a file where there is one input;
        <name>-<method>.ply in the current folder unless given.
    picture
        Also render pictures into this folder.
    winding
        auto: turn faces that look inwards before shading; keep: believe the file.
    tiles
        Shade each mesh by tiles of so many vertices at most, 500000 for instance, so that no
        worker has it as a whole. For binary PLY of triangles, which are taken as they are wound,
        and methods of a vertex and its normals.
    again
        Bake again what is done already.
    force
        Replace existing files that meshdepict didn't write.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    scheduler
        Address of a Dask scheduler, tcp://host:8786 for instance, whose workers see the same
        folders; local: one of this machine. Unless given, processes of this machine, without Dask.
    workers
        Processes of this machine; one for each core unless given.
    """
    from meshdepict.distributed.files import FileBatch
    from meshdepict.distributed.workers import Workers

    everywhere.obey()
    if not inputs:
        raise MeshdepictError("which files? meshdepict batch *.ply -o baked/")
    if picture is None:
        for word in figure.said:
            raise MeshdepictError(
                f"--{word.replace('_', '-')} is about a picture: give --picture, too"
            )
    if tiles is not None and picture is not None:
        raise MeshdepictError("a picture shows the whole mesh: leave --picture out, or --tiles")
    team = Workers(scheduler, workers, everywhere.max_memory)
    batch = FileBatch(
        inputs=inputs, look=parameters.said_look(look, recipe), output=output, picture=picture,
        figure=figure.figure(), winding=winding, force=force, quiet=everywhere.quiet,
        workers=team, again=again, tiles=tiles,
    )  # fmt: skip
    return FAULT if batch.run() else 0
