"""A plate: arrangements of views on one page, all at one scale, with their captions and one bar."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from meshdepict.drawing.arrangement import Arrangement
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import caption_lines
from meshdepict.drawing.letters import LEADING, wrapped
from meshdepict.drawing.page import Part
from meshdepict.drawing.picture import caption_words
from meshdepict.drawing.scale_bar import bar_parts
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View

__all__ = ["NoRoomError", "Plan", "Spot", "plan"]

# In heights of letters.
_MARGIN = 3.0  # round the page
_BETWEEN = 2.0  # groups of views
_GAP = 1.5  # views of a group
_BAR = 3.0
_BAR_LEAST = 6.0  # room for the shortest scale bar

_BAR_SHARE = 0.5  # of the longest side of a view: as long as the bar may be

_EDGE = 2  # pixels round a view, so that no outline touches its border
_SMALL = 24  # pixels below which a view shows nothing


@dataclass(frozen=True)
class Spot:
    """Where a view of a group goes: the group's number, and place and size in pixels."""

    group: int
    view: View
    left: int
    top: int
    size: tuple[int, int]


@dataclass(frozen=True)
class Plan:
    """Where everything goes.

    Attributes
    ----------
    pixels_per_unit : float
    spots : tuple of Spot
    parts : tuple
        What is written: captions and scale bar.
    """

    pixels_per_unit: float
    spots: tuple[Spot, ...]
    parts: tuple[Part, ...]


@dataclass(frozen=True)
class _Grid:
    """Groups in so many columns, with the room that there is for each."""

    columns: int
    width: float  # of a column
    lines: list[list[str]]  # captions
    pixels_per_unit: float  # at most


def plan(
    groups: Sequence[Arrangement],
    captions: Sequence[str],
    figure: Figure,
    *,
    columns: Sequence[int],
    unit: str,
    pixels_per_unit: float | None = None,
) -> Plan:
    """Place groups of views on a page, row by row.

    Parameters
    ----------
    groups : sequence of Arrangement
    captions : sequence of str
        What stands below each group.
    figure : Figure
        The page, whose caption stands at its foot.
    columns : sequence of int
        Numbers of columns to choose from; the one that leaves room for the largest scale is taken.
    unit : str
        What the scale bar is labelled in.
    pixels_per_unit : float, optional
        The scale; as large as the page has room for unless given.

    Raises
    ------
    MeshdepictError
        Where the page has no room.
    """
    size = figure.pixels
    assert size is not None  # a plate's page has a size
    letters = figure.letters(size)
    margin = round(_MARGIN * letters)
    foot = caption_lines(figure, size[0] - 2 * (margin - letters), letters)
    foot_height = math.ceil(len(foot) * LEADING * letters)
    bar_height = round(_BAR * letters) if figure.scale_bar else 0
    room = size[0] - 2 * margin, size[1] - 2 * margin - foot_height - bar_height
    grids = [_grid(groups, captions, room, letters, count) for count in dict.fromkeys(columns)]
    grid = max(grids, key=lambda each: each.pixels_per_unit)
    per_unit = pixels_per_unit or grid.pixels_per_unit
    largest = max(max((*g.widths.values(), *g.heights.values())) for g in groups)
    if grid.pixels_per_unit * largest < _SMALL:
        count = len(groups)
        raise MeshdepictError(
            f"a page of {size[0]}x{size[1]} pixels has no room for {count} "
            f"group{'s' * (count != 1)} of views: take fewer, or a larger size"
        )
    if per_unit > grid.pixels_per_unit * (1 + 1e-9):
        raise NoRoomError(grid.pixels_per_unit)
    for group, caption in zip(groups, captions, strict=True):
        side = per_unit * max(*group.widths.values(), *group.heights.values())
        if side < _SMALL:
            raise MeshdepictError(
                f"{caption} would be {side:.2g} pixels large at the one scale of all: draw it on a "
                "page of its own, or take a larger size"
            )
    spots, parts = _placed(groups, grid, per_unit, (margin, margin), figure)
    below = size[1] - margin - foot_height
    if figure.scale_bar:
        longest = max(_BAR_SHARE * largest, _BAR_LEAST * letters / per_unit)
        parts += bar_parts(
            longest, unit, per_unit, left=margin, middle=below - bar_height // 2, letters=letters,
            figure=figure,
        )  # fmt: skip
    parts += caption_words(foot, margin, below, letters, figure)
    return Plan(per_unit, tuple(spots), tuple(parts))


class NoRoomError(MeshdepictError):
    """A scale that is too large for a page, with the largest that is not, in pixels per unit."""

    def __init__(self, largest: float) -> None:
        super().__init__(f"more than {largest:g} pixels per unit leave no room for all views")
        self.largest = largest


def _fixed(group: Arrangement, letters: int) -> tuple[float, float]:
    """Return the pixels of a group that don't grow with the scale: gaps and edges."""
    each = 2 * _EDGE + 1, round(_GAP * letters)  # of a view, and between two
    across, down = len(group.widths), len(group.heights)
    return across * each[0] + (across - 1) * each[1], down * each[0] + (down - 1) * each[1]


def _grid(
    groups: Sequence[Arrangement],
    captions: Sequence[str],
    room: tuple[int, int],
    letters: int,
    columns: int,
) -> _Grid:
    """Return a grid of so many columns, with the largest scale that there is room for."""
    between = _BETWEEN * letters
    width = (room[0] - (columns - 1) * between) / columns
    lines = [wrapped(caption, max(width, 1.0), letters) for caption in captions]
    scale = math.inf
    rows = [range(i, min(i + columns, len(groups))) for i in range(0, len(groups), columns)]
    fixed_height, grown_height = (len(rows) - 1) * between, 0.0
    for row in rows:
        fixed_height += max(
            _fixed(groups[i], letters)[1] + _caption_height(lines[i], letters) for i in row
        )
        grown_height += max(sum(groups[i].heights.values()) for i in row)
        for i in row:
            free = width - _fixed(groups[i], letters)[0]
            scale = min(scale, free / sum(groups[i].widths.values()))
    scale = min(scale, (room[1] - fixed_height) / grown_height)
    return _Grid(columns, width, lines, max(scale, 0.0))


def _caption_height(lines: Sequence[str], letters: int) -> float:
    return (len(lines) + 1) * LEADING * letters if lines else 0.0


def _placed(
    groups: Sequence[Arrangement],
    grid: _Grid,
    per_unit: float,
    corner: tuple[int, int],
    figure: Figure,
) -> tuple[list[Spot], list[Part]]:
    """Return where the views and the captions go."""
    assert figure.pixels is not None
    letters = figure.letters(figure.pixels)
    between, gap = _BETWEEN * letters, round(_GAP * letters)
    spots: list[Spot] = []
    parts: list[Part] = []
    top = float(corner[1])
    for first in range(0, len(groups), grid.columns):
        row = range(first, min(first + grid.columns, len(groups)))
        sizes = {i: _pixels(groups[i], per_unit) for i in row}
        deepest = 0.0
        for i in row:
            widths, heights = sizes[i]
            wide = sum(widths.values()) + (len(widths) - 1) * gap
            middle = corner[0] + (i - first) * (grid.width + between) + grid.width / 2
            lefts = _starts(widths, round(middle - wide / 2), gap)
            tops = _starts(heights, round(top), gap)
            for name, (column, line) in groups[i].cells.items():
                size = widths[column], heights[line]
                view = groups[i].view(name, size[1], per_unit)
                spots.append(Spot(i, view, lefts[column], tops[line], size))
            under = top + sum(heights.values()) + (len(heights) - 1) * gap + letters / 2
            parts += caption_words(grid.lines[i], middle, under, letters, figure, anchor="m")
            deepest = max(deepest, under + _caption_height(grid.lines[i], letters))
        top = deepest + between
    return spots, parts


def _pixels(group: Arrangement, per_unit: float) -> tuple[dict[int, int], dict[int, int]]:
    """Return the widths of a group's columns and the heights of its rows in pixels."""
    widths, heights = (
        {place: math.ceil(length * per_unit) + 2 * _EDGE for place, length in lengths.items()}
        for lengths in (group.widths, group.heights)
    )
    return widths, heights


def _starts(lengths: dict[int, int], start: int, gap: int) -> dict[int, int]:
    """Return where each begins, with gaps between them."""
    found = {}
    for place, length in lengths.items():
        found[place] = start
        start += length + gap
    return found
