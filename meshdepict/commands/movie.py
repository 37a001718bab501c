"""``meshdepict movie``: turn the light or the object, and write what is seen as a movie."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from meshdepict.commands import parameters
from meshdepict.commands.parameters import (
    FILES,
    MOTION,
    Everywhere,
    FigureWords,
    LookWords,
    takes_words,
)
from meshdepict.errors import MeshdepictError

__all__ = ["movie"]


@takes_words(
    without=("colormap2d", "blend", "tint", "albedo", "refine", "transfer", "ground", "budget")
)
def movie(
    source: Annotated[Path | None, Parameter(name="INPUT")] = None,
    /,
    *,
    output: Annotated[str, Parameter(name=["--output", "-o"], group=FILES)],
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    turn: Annotated[Literal["object", "light"], Parameter(group=MOTION)] = "object",
    light_fixed: Annotated[Literal["eye", "object"], Parameter(group=MOTION)] = "eye",
    seconds: Annotated[float, Parameter(group=MOTION)] = 6.0,
    fps: Annotated[float, Parameter(group=MOTION)] = 25.0,
    look: LookWords,
    figure: FigureWords,
    everywhere: Everywhere,
) -> None:
    """Film a light or an object that turns once.

    The movie loops. Without INPUT: the built-in golf ball.

    Parameters
    ----------
    source
        Mesh: PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not; or terrain:
        GeoTIFF, .dem, .asc.
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
    from meshdepict import samples
    from meshdepict.baking.batch import stem
    from meshdepict.baking.pixel_widths import measured
    from meshdepict.baking.surfaces import as_solid
    from meshdepict.baking.targets import check_target, identities
    from meshdepict.console import notes, progress_bar, say
    from meshdepict.drawing.movie import check_movie, save_movie
    from meshdepict.viewer.session import Session, refuse_unshown

    start = time.perf_counter()
    everywhere.obey()
    quiet = everywhere.quiet
    wanted = parameters.said_look(look, recipe)
    refuse_unshown(wanted, f"{recipe}: ")
    # With a scale the object decides how large the movie is.
    pages = figure.figure(**({} if figure.pixels_per_unit else {"size": "800x800"}))
    motion: dict[str, Any] = {
        "turn": turn, "light_fixed": light_fixed, "seconds": seconds, "fps": fps, "figure": pages,
    }  # fmt: skip
    count = check_movie(output, **motion)
    check_target(Path(output), force=force, inputs=identities([source]))
    if source is not None and not os.path.exists(source):
        raise MeshdepictError(f"{source}: there is no such file")
    with notes(source, quiet=quiet), progress_bar(stem(source), quiet=quiet) as progress:
        shape = samples.golf_ball() if source is None else as_solid(source)
        wanted = measured(wanted, shape, pages, turning=turn == "object")
        session = Session(shape, wanted.function, progress=progress, **wanted.words())
        save_movie(session, output, progress=progress, **motion)
    taken = time.perf_counter() - start
    say(f"{output}: {wanted.method}, {turn} turning, {count} frames, {taken:.1f} s")
