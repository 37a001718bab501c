"""Movies of a turn: the light circles once, or the eye goes once round the object."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdepict.drawing import encoding
from meshdepict.drawing.canvas import canvas
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import Framing, frame
from meshdepict.drawing.motion import circling, turned, turned_light
from meshdepict.drawing.picture import finished
from meshdepict.errors import MeshdepictError
from meshdepict.scene.names import Lighting
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from meshdepict.drawing.painted import Turnable

__all__ = ["check_movie", "save_movie"]

_FRAMES = 10_000  # at most: nobody waits for more
_SAMPLES = 2  # along a pixel's side: half the time of a picture's three, and edges move anyway
_USUAL = Figure(size=(800, 800))


def save_movie(
    session: Turnable,
    path: str | Path,
    *,
    turn: str = "object",
    light_fixed: str = "eye",
    seconds: float = 6.0,
    fps: float = 25.0,
    figure: Figure | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Path:
    """Write a movie that loops, and put it in place once it is complete.

    Parameters
    ----------
    session : Turnable
        What is shown, as it begins; it is left as it was.
    path : path
        .mp4 (H.264, which every player knows) or .gif.
    turn : {"object", "light"}
        The eye goes round the object, about the view's up axis; or the light circles clockwise
        about the line of sight.
    light_fixed : {"eye", "object"}
        Where the eye goes round: whether the light goes with it, as a lamp beside a turntable, or
        stays with the object.
    seconds : float
        For the whole turn.
    fps : float
        Frames per second; a GIF's are the nearest that it can have.
    figure : Figure, optional
        800 x 800 pixels on white unless given.
    progress : callable, optional
        ``progress(done, total)`` in frames.

    Raises
    ------
    MeshdepictError
        As `check_movie`, `frame` and `motion.circling`, and where the file can't be written.
    """
    from meshdepict.files.atomic import atomic_write

    path, figure = Path(path), figure or _USUAL
    count = check_movie(
        path, turn=turn, light_fixed=light_fixed, seconds=seconds, fps=fps, figure=figure
    )
    view, light = session.view, session.light
    first = session.baked()
    figure = figure.on(first.ground).captioned(first.provenance, session.shape.length_unit)
    moves = _circle if turn == "light" else _round
    framing = frame(view, session.shape, figure, turning=turn == "object")
    try:
        lines = [*first.comments, f"meshdepict turn: {turn} in {count} frames"]
        with canvas(first, framing.drawn, samples=_SAMPLES) as drawing:

            def draw(index: int) -> Any:
                eye = moves(session, light, framing, light_fixed, 360 * index / count)
                return finished(drawing.draw(eye, session.colors), framing, figure)

            def frames() -> Iterator[Any]:
                for index in range(count):
                    yield draw(index)
                    if progress:
                        progress(index + 1, count)

            moves(session, light, framing, light_fixed, 0.0)  # what it refuses, before any file
            with atomic_write(path) as stream:
                if path.suffix.lower() == ".gif":
                    samples = [draw(round(i * count / 8) % count) for i in range(8)]
                    encoding.write_gif(stream, frames(), samples, fps=fps, lines=lines)
                else:
                    encoding.write_mp4(stream.name, frames(), fps=fps, lines=lines)
    finally:
        session.look(view)
        session.shine(light)
    return path


def check_movie(
    path: str | Path,
    *,
    turn: str = "object",
    light_fixed: str = "eye",
    seconds: float = 6.0,
    fps: float = 25.0,
    figure: Figure | None = None,
) -> int:
    """Refuse what can't become a movie, before any work is done; return the number of frames.

    Raises
    ------
    MeshdepictError
        For another suffix, turn, light, length or speed, for a transparent background, and where
        the encoder of .mp4 is missing.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".mp4", ".gif"):
        raise MeshdepictError(f"{path}: movies are written as .mp4 or .gif; end the name so")
    for name, value, known in (
        ("turn", turn, ("object", "light")),
        ("light_fixed", light_fixed, ("eye", "object")),
    ):
        if value not in known:
            raise MeshdepictError(f"{name}={value!r} is neither {known[0]!r} nor {known[1]!r}")
    for name, number in (("seconds", seconds), ("fps", fps)):
        if not (math.isfinite(number) and number > 0):
            raise MeshdepictError(f"{name}={number!r} is not a positive number")
    if suffix == ".gif":
        fps = encoding.gif_speed(fps)
    count = round(min(seconds * fps, 1e9))
    if not 2 <= count <= _FRAMES:
        raise MeshdepictError(
            f"{seconds:g} s of {fps:g} frames per second are {count} frames: 2 to {_FRAMES} make "
            "a movie"
        )
    if figure is not None and figure.ground is None:
        raise MeshdepictError("movies have no transparency: give another background")
    if suffix == ".mp4":
        encoding.require_encoder()
    return count


def _circle(session: Turnable, light: Lighting, framing: Framing, _: str, angle: float) -> View:
    session.shine(circling(light, framing.view, angle))
    return framing.view


def _round(session: Turnable, light: Lighting, framing: Framing, fixed: str, angle: float) -> View:
    eye = turned(framing.view, angle)
    session.look(eye)
    if fixed == "eye":
        session.shine(turned_light(light, framing.view, angle))
    return eye
