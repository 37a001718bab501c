"""``meshdepict movie``: turn the light or the object, and write what is seen as a movie."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from meshdepict import threads
from meshdepict.commands import parameters
from meshdepict.commands.parameters import FILES, MOTION
from meshdepict.errors import MeshdepictError

__all__ = ["movie"]


def movie(
    source: Annotated[Path, Parameter(name="INPUT")],
    /,
    *,
    output: Annotated[str, Parameter(name=["--output", "-o"], group=FILES)],
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    turn: Annotated[Literal["object", "light"], Parameter(group=MOTION)] = "object",
    light_fixed: Annotated[Literal["eye", "object"], Parameter(group=MOTION)] = "eye",
    seconds: Annotated[float, Parameter(group=MOTION)] = 6.0,
    fps: Annotated[float, Parameter(group=MOTION)] = 25.0,
    method: parameters.Method = "exaggerated",
    light: parameters.LightText = "northwest",
    view: parameters.View = "front",
    up: parameters.Up = "y",
    options: parameters.Options = None,
    colormap: parameters.Colormap = None,
    scales: parameters.Scales = None,
    width: parameters.Width = None,
    ratio: parameters.Ratio = None,
    facing: parameters.Facing = 1,
    tolerance: parameters.Tolerance = 1e-4,
    size: parameters.Size = "800x800",
    dpi: parameters.Dpi = None,
    background: parameters.Background = "white",
    scale_bar: parameters.ScaleBar = False,
    unit: parameters.Unit = "",
    pixels_per_unit: parameters.PixelsPerUnit = None,
    quiet: parameters.Quiet = False,
    cores: parameters.Cores = None,
    given: Annotated[frozenset[str], Parameter(parse=False)] = frozenset(),
) -> None:
    """Turn the light or the object once, and write what is seen as a movie that loops.

    Parameters
    ----------
    source
        Mesh file: PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not.
    output
        File to write: .mp4 or .gif.
    force
        Replace an existing file that meshdepict didn't write.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    turn
        object: the eye goes round it; light: it circles clockwise about the line of sight.
    light_fixed
        Where the object turns: the light stays with the eye, or with the object.
    seconds
        For the whole turn.
    fps
        Frames per second.
    """
    from meshdepict.baking.targets import check_target
    from meshdepict.console import notes, progress_bar
    from meshdepict.drawing.figure import Figure
    from meshdepict.drawing.movie import check_movie, save_movie
    from meshdepict.viewer.session import Session

    start = time.perf_counter()
    threads.limit(cores)
    settings: dict[str, Any] = {
        "method": method, "light": parameters.as_light(light), "view": view, "up": up,
        "scales": scales, "width": width, "ratio": ratio, "facing": facing, "tolerance": tolerance,
        "colormap": colormap,
    }  # fmt: skip
    if recipe is not None:
        settings = parameters.session_settings(recipe, settings, given)
    settings |= parameters.method_options(settings["method"], options or [])
    if pixels_per_unit is not None and "size" not in given:
        size = None  # the object decides
    figure = Figure(
        size=size, dpi=dpi, background=background, scale_bar=scale_bar, unit=unit,
        pixels_per_unit=pixels_per_unit,
    )  # fmt: skip
    motion: dict[str, Any] = {
        "turn": turn, "light_fixed": light_fixed, "seconds": seconds, "fps": fps, "figure": figure,
    }  # fmt: skip
    count = check_movie(output, **motion)
    check_target(Path(output), force=force, inputs={os.path.realpath(source)})
    if not os.path.exists(source):
        raise MeshdepictError(f"{source}: there is no such file")
    with notes(source, quiet=quiet), progress_bar(source.name, quiet=quiet) as progress:
        session = Session(source, progress=progress, **settings)
        save_movie(session, output, progress=progress, **motion)
    taken = time.perf_counter() - start
    print(  # noqa: T201
        f"{output}: {settings['method']}, {turn} turning, {count} frames, {taken:.1f} s"
    )
