"""``meshdepict bake``: shade meshes and write the colours into files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from meshdepict import threads
from meshdepict.commands import parameters
from meshdepict.commands.parameters import FILES, LOOK
from meshdepict.console import FAULT
from meshdepict.errors import MeshdepictError

__all__ = ["bake"]


def bake(
    *inputs: Annotated[Path, Parameter(name="INPUT")],
    output: Annotated[str | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    picture: Annotated[str | None, Parameter(group=FILES)] = None,
    albedo: Annotated[Literal["keep", "none"], Parameter(group=FILES)] = "none",
    winding: Annotated[Literal["auto", "keep"], Parameter(group=FILES)] = "auto",
    fix_winding: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    save_recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    method: parameters.Method = "exaggerated",
    light: parameters.LightText = "northwest",
    view: parameters.View = "front",
    up: parameters.Up = "y",
    options: parameters.Options = None,
    colormap: parameters.Colormap = None,
    colormap2d: Annotated[str | None, Parameter(name="--colormap2d", group=LOOK)] = None,
    scales: parameters.Scales = None,
    width: parameters.Width = None,
    ratio: parameters.Ratio = None,
    facing: parameters.Facing = 1,
    tolerance: parameters.Tolerance = 1e-4,
    refine: parameters.Refine = None,
    size: parameters.Size = None,
    dpi: parameters.Dpi = None,
    background: parameters.Background = "white",
    scale_bar: parameters.ScaleBar = False,
    unit: parameters.Unit = "",
    pixels_per_unit: parameters.PixelsPerUnit = None,
    quiet: parameters.Quiet = False,
    cores: parameters.Cores = None,
    given: Annotated[frozenset[str], Parameter(parse=False)] = frozenset(),
) -> int:
    """Shade meshes and write the colours into files. Without INPUT: the built-in golf ball.

    Parameters
    ----------
    inputs
        Mesh files: PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not.
    output
        File to write, or a folder; <name>-<method>.ply in the current folder unless given.
    picture
        Also render a PNG: a file, or a folder.
    albedo
        keep: multiply the file's own colours.
    winding
        auto: turn faces that look inwards before shading; keep: believe the file.
    fix_winding
        Write the turned faces, too, with vertex and face properties but nothing else of the file.
    force
        Replace existing files that meshdepict didn't write, the input among them.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    save_recipe
        Write them to a file.
    colormap2d
        Colours for two lights, the other one 90° clockwise: dusk, earth or swiss.
    """
    from meshdepict.baking.batch import Batch, check_settings
    from meshdepict.baking.recipe import load_recipe, merge_recipe
    from meshdepict.baking.recipe import save_recipe as write_recipe
    from meshdepict.drawing.figure import Figure

    threads.limit(cores)
    if picture is None:
        for word in ("size", "dpi", "background", "scale_bar", "unit", "pixels_per_unit"):
            if word in given:
                raise MeshdepictError(
                    f"--{word.replace('_', '-')} is about a picture: give --picture, too"
                )
    if fix_winding and winding == "keep":
        raise MeshdepictError("--fix-winding writes what --winding keep forbids: give one of them")
    figure = Figure(
        size=size, dpi=dpi, background=background, scale_bar=scale_bar, unit=unit,
        pixels_per_unit=pixels_per_unit,
    )  # fmt: skip
    settings: dict[str, Any] = {
        "method": method, "light": parameters.as_light(light), "view": view, "up": up,
        "scales": scales, "width": width, "ratio": ratio, "facing": facing, "tolerance": tolerance,
        "colormap": colormap, "colormap2d": colormap2d, "albedo": albedo,
        "refine": refine,
    }  # fmt: skip
    if recipe is not None:
        said = {name: value for name, value in settings.items() if name in given}
        settings = merge_recipe(load_recipe(recipe), said)
    settings |= parameters.method_options(settings["method"], options or [])
    if save_recipe is not None:
        check_settings(settings)
        write_recipe(save_recipe, settings, force=force)
    batch = Batch(
        inputs=inputs, settings=settings, output=output, picture=picture,
        figure=figure, winding=winding, fix_winding=fix_winding, force=force, quiet=quiet,
    )  # fmt: skip
    return FAULT if batch.run() else 0
