"""Views as drawings of finds arrange them: the main one, and its turns by 90° beside and below it.

Each turned view stands on the side that it shows: what is seen from the right stands to the right
(third-angle projection). All have one scale, and lie so that a level line, or an upright one,
through a point of the object meets the same point in the next view.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.scene.shape import Shape
from meshdepict.scene.view import View

__all__ = ["MAIN", "TURNS", "Arrangement", "arranged", "turn_names"]

Floats = NDArray[np.float64]

MAIN = "main"

# Rows of the turned frame (right, up, to the eye) in the main one's, and where the view stands:
# columns to the right, rows down.
_TURNS: dict[str, tuple[tuple[tuple[int, int, int], ...], tuple[int, int]]] = {
    MAIN: (((1, 0, 0), (0, 1, 0), (0, 0, 1)), (0, 0)),
    "right": (((0, 0, -1), (0, 1, 0), (1, 0, 0)), (1, 0)),
    "back": (((-1, 0, 0), (0, 1, 0), (0, 0, -1)), (2, 0)),
    "left": (((0, 0, 1), (0, 1, 0), (-1, 0, 0)), (-1, 0)),
    "above": (((1, 0, 0), (0, 0, -1), (0, 1, 0)), (0, -1)),
    "below": (((1, 0, 0), (0, 0, 1), (0, -1, 0)), (0, 1)),
}
TURNS = tuple(name for name in _TURNS if name != MAIN)
"""What can stand about a main view."""

_ALIKE = {"top": "above", "bottom": "below"}  # what the turns are called of a front


@dataclass(frozen=True)
class Arrangement:
    """Views of a shape in columns and rows, in the shape's units.

    Attributes
    ----------
    cells : dict
        Of each view, by name, its column and row; the main view's are 0 and 0.
    frames : dict
        Of each view its frame (3, 3): rows right, up, to the eye.
    middles : dict
        Of each view the middle (3,) of the box about the shape, in the world.
    widths, heights : dict
        Of each column and each row, from the left and from the top.
    depth : float
        How far the eye has to be away, at least.
    """

    cells: Mapping[str, tuple[int, int]]
    frames: Mapping[str, Floats]
    middles: Mapping[str, Floats]
    widths: Mapping[int, float]
    heights: Mapping[int, float]
    depth: float

    def view(self, name: str, height_px: int, pixels_per_unit: float) -> View:
        """Return a view whose picture has a height, with the middle of the shape in its middle."""
        frame, focus = self.frames[name], self.middles[name]
        return View(
            focus + self.depth * frame[2], focus, frame[1], height_px=height_px,
            parallel_scale=height_px / (2 * pixels_per_unit), name=name,
        )  # fmt: skip


def turn_names(names: Sequence[str]) -> list[str]:
    """Return the turns that words stand for, each once.

    Raises
    ------
    MeshdepictError
        For a word that is none.
    """
    known = [_ALIKE.get(name, name) if isinstance(name, str) else "" for name in names]
    for name, word in zip(known, names, strict=True):
        if name not in TURNS:
            raise MeshdepictError(
                f"{word!r} is no turn of the main view{nearest(str(word), TURNS)} (there are "
                f"{', '.join(TURNS)})"
            )
    return list(dict.fromkeys(known))


def arranged(view: View, shape: Shape, turns: Sequence[str]) -> Arrangement:
    """Arrange a view of a shape and turns of it.

    Raises
    ------
    MeshdepictError
        For a view in perspective: what is near is larger there, and nothing is in line.
    """
    if view.parallel_scale is None:
        raise MeshdepictError(
            "views beside each other need a parallel view: in perspective, what is near is larger; "
            "give the view a parallel_scale"
        )
    seen = (shape.outline - shape.centre) @ view.frame.T
    ends = np.array((seen.min(axis=0), seen.max(axis=0)))
    cells, frames, middles = {}, {}, {}
    widths: dict[int, float] = {}
    heights: dict[int, float] = {}
    least = 1e-9 * (shape.diagonal or 1.0)
    for name in (MAIN, *turns):
        rows, cell = _TURNS[name]
        turn = np.array(rows, np.float64)
        low, high = np.sort(ends @ turn.T, axis=0)
        cells[name] = cell
        frames[name] = turn @ view.frame
        middles[name] = shape.centre + (low / 2 + high / 2) @ frames[name]
        widths[cell[0]], heights[cell[1]] = np.maximum(high - low, least)[:2].tolist()
    return Arrangement(
        cells, frames, middles,
        dict(sorted(widths.items())), dict(sorted(heights.items())), 4 * (shape.diagonal or 1.0),
    )  # fmt: skip
