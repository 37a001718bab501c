"""Where an object lies in its picture: fitted, or at a scale; still, or with room for a turn."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshdepict.drawing.figure import Figure, check_pixels
from meshdepict.drawing.letters import LEADING, wrapped
from meshdepict.errors import MeshdepictError
from meshdepict.scene.shape import Shape
from meshdepict.scene.upright import UPS
from meshdepict.scene.vectors import Vector
from meshdepict.scene.view import VIEWS, View

__all__ = ["Framing", "caption_lines", "check_scale", "frame", "is_fitted"]

_MARGIN = 1.05  # as `View.fitted`
_USUAL = (1000, 1000)


@dataclass(frozen=True)
class Framing:
    """Where an object lies in its picture.

    Attributes
    ----------
    view : View
        Of the part above the strip.
    size : (int, int)
        Of the whole picture, in pixels.
    strip : int
        Pixels at the bottom that are kept free for scale bar and caption.
    caption : int
        How many of them are the caption's.
    pixels_per_unit : float or None
        None in perspective, where there is no scale.
    unit : str
        What a scale bar is labelled in: as the figure says, else as the shape's file; or empty.
    """

    view: View
    size: tuple[int, int]
    strip: int = 0
    caption: int = 0
    pixels_per_unit: float | None = None
    unit: str = ""

    @property
    def drawn(self) -> tuple[int, int]:
        """Width and height of the part above the strip."""
        return self.size[0], self.size[1] - self.strip


_BAR_ROOM = 14  # width of a picture with a scale bar, in heights of letters


def frame(view: View, shape: Shape, figure: Figure, *, turning: bool = False) -> Framing:
    """Place a shape in a figure.

    A view given by name is fitted to the picture's proportions, with a margin of 5 %.

    Parameters
    ----------
    view : View
    shape : Mesh
    figure : Figure
    turning : bool
        Leave room for a whole turn round the view's up axis; see `motion.turned`.

    Raises
    ------
    MeshdepictError
        Where the object doesn't fit at its scale, and for a scale in perspective.
    """
    check_scale(view, figure)
    unit = figure.unit or getattr(shape, "length_unit", "")
    if figure.pixels_per_unit is None and not is_fitted(view, shape):
        size, scale = figure.pixels or _USUAL, view.parallel_scale
        words = _caption_room(figure, size)  # as much of the object as without, but smaller
        per_unit = None if scale is None else (size[1] - words) / (2 * scale)
        return Framing(view, size, words, words, per_unit, unit)
    low, high = (_swept if turning else _seen)(view, shape)
    extent = (high - low)[:2]
    per_unit = figure.pixels_per_unit
    if per_unit is None:
        size = figure.pixels or _USUAL
        words = _caption_room(figure, size)
        strip = _strip(figure, size) + words
        room = np.array((size[0], size[1] - strip))
        extent = np.maximum(extent, 1e-9 * (shape.diagonal or 1.0))
        per_unit = float((room / extent).min()) / _MARGIN
    else:
        size = figure.pixels or _grown(extent, figure)
        words = _caption_room(figure, size)
        strip = _strip(figure, size) + words
        _check_room(extent, per_unit, (size[0], size[1] - strip))
    centred = _centred(view, shape, (low + high) / 2, size[1] - strip, per_unit)
    return Framing(centred, size, strip, words, per_unit, unit)


def check_scale(view: object, figure: Figure) -> None:
    """Refuse a scale in perspective, where there is none."""
    asked = "a fixed scale" if figure.pixels_per_unit else "a scale bar"
    perspective = isinstance(view, View) and view.parallel_scale is None
    if perspective and (figure.pixels_per_unit or figure.scale_bar):
        raise MeshdepictError(
            f"{asked} needs a parallel view: in perspective, what is near is larger; give the view "
            "a parallel_scale"
        )


def _seen(view: View, shape: Shape) -> tuple[Vector, Vector]:
    """Return the corners of the box about a shape in the view's frame, from the shape's centre."""
    seen = (shape.outline - shape.centre) @ view.frame.T
    return seen.min(axis=0), seen.max(axis=0)


def _swept(view: View, shape: Shape) -> tuple[Vector, Vector]:
    """Return the same for the space that the shape needs for a turn round the view's up axis."""
    points = shape.outline - shape.centre
    along = points @ view.up
    radius = np.linalg.norm(points - along[:, None] * view.up, axis=1)
    upright = float(view.up @ view.frame[1])  # the axis as the picture shows it
    tilted = math.sqrt(max(1 - upright**2, 0))
    widest = radius.max()
    low = np.array((-widest, (along * upright - radius * tilted).min(), 0))
    high = np.array((widest, (along * upright + radius * tilted).max(), 0))
    return low, high


def _centred(view: View, shape: Shape, middle: Vector, height: int, per_unit: float) -> View:
    """Return the parallel view with the middle of a box in its middle, at a scale."""
    upright = float(view.up @ view.frame[1])
    # Up along the axis rather than the picture: then a turn round the focus is one round the axis.
    middle = middle[0] * view.frame[0] + middle[1] / upright * view.up
    focus = shape.centre + middle
    scale = height / (2 * per_unit)
    distance = 4 * max(scale, shape.diagonal)
    return View(
        focus + distance * view.towards_eye, focus, view.up,
        height_px=height, parallel_scale=scale, name=view.name,
    )  # fmt: skip


def _grown(extent: Vector, figure: Figure) -> tuple[int, int]:
    """Return the size of a picture that an object decides, with room for margin and scale bar."""
    per_unit = figure.pixels_per_unit or 1.0
    width, height = (int(x) for x in np.minimum(np.ceil(extent * per_unit * _MARGIN) + 2, 1e9))
    size = width, height
    for _ in range(3):  # what is written grows with the picture, and the picture with it
        letters = figure.letters(size)
        if figure.scale_bar or figure.caption:  # which have to fit, however small the object
            width = max(width, _BAR_ROOM * letters)
        bar = 3 * letters if figure.scale_bar else 0
        size = width, height + bar + _rows(figure, width, letters)
    check_pixels(size, f" at {per_unit:g} pixels per unit")
    return size


def _check_room(extent: Vector, per_unit: float, room: tuple[int, int]) -> None:
    needed = np.ceil(extent * per_unit)
    if (needed > room).any():
        raise MeshdepictError(
            f"at {per_unit:g} pixels per unit the object takes {needed[0]:.0f}x{needed[1]:.0f} "
            f"pixels, more than the {room[0]}x{room[1]} there are for it: give fewer pixels per "
            "unit, or a larger size or none"
        )


def caption_lines(figure: Figure, width: int, letters: int) -> list[str]:
    """Return the caption in lines that fit into a picture of a width, in letters of a height."""
    return wrapped(figure.caption, width - 2 * letters, letters)


def _rows(figure: Figure, width: int, letters: int) -> int:
    """Return the height that the caption takes, with half a line below."""
    count = len(caption_lines(figure, width, letters))
    return math.ceil((count + 0.5) * LEADING * letters) if count else 0


def _caption_room(figure: Figure, size: tuple[int, int]) -> int:
    """Return the height that the caption takes; at most half of a given size."""
    rows = _rows(figure, size[0], figure.letters(size))
    grows = figure.pixels is None and figure.pixels_per_unit is not None
    if rows > size[1] / 2 and not grows:
        raise MeshdepictError(
            f"the caption takes more than half of a picture of {size[0]}x{size[1]} pixels: shorten "
            "it, or make the picture larger"
        )
    return rows


def _strip(figure: Figure, size: tuple[int, int]) -> int:
    """Return the height that a scale bar takes; at most a third of the picture."""
    return min(3 * figure.letters(size), size[1] // 3) if figure.scale_bar else 0


def is_fitted(view: View, shape: Shape) -> bool:
    """Whether a view was fitted to a shape by name."""
    squares = (View.fitted(view.name, shape, up=up) for up in UPS if view.name in VIEWS)
    return any(
        np.array_equal(view.position, square.position)
        and view.parallel_scale == square.parallel_scale
        for square in squares
    )
