"""``meshdepict plate``: views × lights × methods on one page, as drawings of finds have them."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from meshdepict.commands.parameters import (
    FIGURE,
    FILES,
    LOOK,
    Everywhere,
    FigureWords,
    LookWords,
    takes_words,
)
from meshdepict.commands.values import as_light, options_by_method
from meshdepict.console import notes, progress_bar, say

__all__ = ["plate"]


@takes_words(without=("method", "light", "view", "refine", "ground", "budget"), options=False)
def plate(
    *inputs: Annotated[Path, Parameter(name="FILE")],
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    method: Annotated[list[str] | None, Parameter(name=["--method", "-m"], group=LOOK)] = None,
    light: Annotated[
        list[str] | None, Parameter(name="--light", group=LOOK, allow_leading_hyphen=True)
    ] = None,
    options: Annotated[list[str] | None, Parameter(name="--set", group=LOOK)] = None,
    views: Annotated[str, Parameter(group=FIGURE)] = "auto,right,below",
    scale: Annotated[str | None, Parameter(group=FIGURE)] = None,
    look: LookWords,
    figure: FigureWords,
    everywhere: Everywhere,
) -> None:
    """Draw views, lights and methods on one page.

    The main view stands in the middle, its turns by 90° beside, above and below it, each on the
    side that it shows, at one scale. Without FILE: the built-in golf ball.

    Parameters
    ----------
    inputs
        Meshes, terrain or CT.
    output
        Page to write, .png, .jpg, .svg or .pdf; <name>-plate.png in the current folder unless
        given.
    force
        Replace an existing file that meshdepict didn't write.
    method
        A method; repeatable. exaggerated unless given.
    light
        A light of every view, as for bake; repeatable.
    options
        An option of a method as name=value, with several methods METHOD.name=value. Repeatable.
    views
        The main view, as bake's --view, then its turns: right, back, left, above, below.
    scale
        On paper, 1:2 or 2:1, where the unit is known; unless given, what the page has room for.
    """
    from meshdepict import samples
    from meshdepict.baking import plates
    from meshdepict.baking.batch import stem
    from meshdepict.baking.targets import check_target, identities
    from meshdepict.drawing.picture_files import check_picture

    everywhere.obey()
    start = time.perf_counter()
    names = [stem(path).partition(".")[0] for path in inputs] or [stem(None)]
    page = figure.figure(size=figure.size or "A4", scale_bar=True)
    output = output or Path(f"{names[0]}-plate.png")
    if output.is_dir():
        output = output / f"{names[0]}-plate.png"
    check_picture(output, page)
    check_target(output, force=force, inputs=identities(inputs))
    methods = method or ["exaggerated"]
    lights: list[Any] | None = [as_light(text) for text in light] if light else None
    own = options or []
    if len(methods) == 1:
        own = [f"{methods[0]}.{text}" if _is_plain(text) else text for text in own]
    quiet = everywhere.quiet
    about = inputs[0] if len(inputs) == 1 else None
    with notes(about, quiet=quiet), progress_bar(names[0], quiet=quiet) as progress:
        made = plates.plate(
            [*inputs] or [samples.golf_ball()], methods, lights=lights, views=views, scale=scale,
            names=names, options=options_by_method(own), progress=progress,
            **{"size": "A4", **figure.said, "scale_bar": True}, **{"up": "auto", **look.said},
        )  # fmt: skip
        made.save(output)
    seconds = time.perf_counter() - start
    lit = [f"light {', '.join(light)}"] if light else []
    parts = [", ".join(methods), *lit, made.provenance["plate"]]
    say(f"{output}: {', '.join(parts)}, {seconds:.1f} s")


def _is_plain(text: str) -> bool:
    """Whether an option is said without its method."""
    return "." not in text.partition("=")[0]
