"""Widths in pixels of the view, where a look meets its shape and its picture."""

from __future__ import annotations

import dataclasses
from typing import TypeVar

from meshdepict.baking.choices import Choices
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.drawing.map_picture import cell_pixels, one_cell_a_pixel
from meshdepict.scene.shape import Shape
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.lengths import counts_pixels, resolve_width

__all__ = ["measured"]

Look = TypeVar("Look", bound=Choices)


def measured(
    look: Look, shape: Shape, figure: Figure | None = None, *, turning: bool = False
) -> Look:
    """Return a look whose width, where it counts pixels, is a length of the shape instead.

    Parameters
    ----------
    look : Choices
    shape : Mesh or Volume
    figure : Figure, optional
        The picture that is to be drawn: its pixels count. Unless given those of the look's view,
        1000 of which are its height where it has a name.
    turning : bool
        As for `frame`.
    """
    if not counts_pixels(look.width):
        return look
    look = look.posed(shape)
    eye = look.eye(shape)
    side = 0 if figure is None else cell_pixels(shape, eye, figure)
    if side and isinstance(shape, HeightField):
        eye = one_cell_a_pixel(shape, eye, side)
    elif figure is not None:
        place = frame(eye, shape, figure, turning=turning)
        eye = dataclasses.replace(place.view, height_px=place.drawn[1])
    return look.replace(width=resolve_width(look.width, shape, eye))
