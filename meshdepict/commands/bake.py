"""``meshdepict bake``: shade meshes and write the colours into files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from meshdepict.commands import parameters
from meshdepict.commands.parameters import FILES, Everywhere, FigureWords, LookWords, takes_words
from meshdepict.console import FAULT
from meshdepict.errors import MeshdepictError

__all__ = ["bake"]


@takes_words(without=("transfer",))
def bake(
    *inputs: Annotated[Path, Parameter(name="INPUT")],
    output: Annotated[str | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    picture: Annotated[str | None, Parameter(group=FILES)] = None,
    winding: Annotated[Literal["auto", "keep"], Parameter(group=FILES)] = "auto",
    fix_winding: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    triangles: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    quantize: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    together: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    save_recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    look: LookWords,
    figure: FigureWords,
    everywhere: Everywhere,
) -> int:
    """Shade meshes and terrain, and write the colours into files.

    Without INPUT: the built-in golf ball.

    Parameters
    ----------
    inputs
        Meshes: PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not; or terrain:
        GeoTIFF, .dem, .asc.
    output
        File to write, or a folder; <name>-<method>.ply in the current folder unless given.
    picture
        Also render a picture: a file (.png, .jpg, .svg, .pdf), or a folder, for PNG.
    winding
        auto: turn faces that look inwards before shading; keep: believe the file.
    fix_winding
        Write the turned faces, too, with vertex and face properties but nothing else of the file.
    triangles
        Write polygons and triangle strips as the triangles that are shaded.
    quantize
        Write positions of .glb and .gltf in 16 bits (KHR_mesh_quantization), for the web.
    together
        All meshes are one scene, each where its file has it: they hide light from each other and
        send it on. The picture shows all of them.
    force
        Replace existing files that meshdepict didn't write, the input among them.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    save_recipe
        Write them to a file, as they were said: up and view that nobody names are each mesh's own.
    """
    from meshdepict.baking.batch import Batch, check_look

    everywhere.obey()
    if picture is None:
        for word in figure.said:
            raise MeshdepictError(
                f"--{word.replace('_', '-')} is about a picture: give --picture, too"
            )
    if fix_winding and winding == "keep":
        raise MeshdepictError("--fix-winding writes what --winding keep forbids: give one of them")
    pictures = figure.figure()
    wanted = parameters.said_look(look, recipe)
    if save_recipe is not None:
        check_look(wanted)
        wanted.save(save_recipe, force=force)
    if together and len(inputs) < 2:
        raise MeshdepictError("--together is about several meshes: give at least two, or leave it")
    kind = Batch
    if together:
        from meshdepict.baking.together_batch import TogetherBatch

        kind = TogetherBatch
    batch = kind(
        inputs=inputs, look=wanted, output=output, picture=picture, figure=pictures,
        winding=winding, fix_winding=fix_winding, triangles=triangles, quantize=quantize,
        force=force, quiet=everywhere.quiet,
    )  # fmt: skip
    return FAULT if batch.run() else 0
