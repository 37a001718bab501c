"""Plates: views × lights × methods on one page, at one scale."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdepict.baking.look import Look
from meshdepict.baking.plate_groups import Group, draw_groups
from meshdepict.baking.plate_input import (
    checked_options,
    common_unit,
    main_and_turns,
    notes_about,
    plate_looks,
    shape_name,
    turnable_shape,
)
from meshdepict.drawing.arrangement import arranged
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.page import Page, Picture, paint
from meshdepict.drawing.paper_scale import paper_scale, pixels_at
from meshdepict.drawing.picture_files import encoded, write_page
from meshdepict.drawing.plate_layout import NoRoomError, Plan, plan
from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import Progress
from meshdepict.scene.names import LightsLike, is_several
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["Plate", "plate"]

VIEWS = ("front", "right", "below")

_IN_NOTEBOOKS = (800, 800)  # pixels at most


@dataclass(frozen=True, repr=False)
class Plate:
    """A page of views.

    Attributes
    ----------
    page : Page
    provenance : dict of str
        What was drawn, and how; of several pictures by their numbers.
    pixels_per_unit : float
        The one scale.
    scale : str
        The same on paper, such as "1:2.5"; empty where the unit or the paper isn't known.
    """

    page: Page
    provenance: dict[str, str]
    pixels_per_unit: float
    scale: str

    def save(self, path: str | Path) -> Path:
        """Write the plate as .png, .jpg, .svg or .pdf; in the last two, words and bar are vectors.

        Raises
        ------
        MeshdepictError
            For another suffix, and where the file can't be written.
        """
        return write_page(self.page, path, self.provenance)

    def _repr_png_(self) -> bytes:
        """Return a small picture, which notebooks show."""
        image = self.image
        image.thumbnail(_IN_NOTEBOOKS)
        small = Page(image.size, self.page.ground, (Picture(image, 0, 0),))
        return encoded(small, ".png")

    def __repr__(self) -> str:
        """Return size and number of views."""
        views = sum(isinstance(part, Picture) for part in self.page.parts)
        width, height = self.page.size
        return f"<Plate: {views} views on {width} x {height} pixels>"

    @property
    def image(self) -> Image:
        """The plate as a ``PIL.Image``."""
        return paint(self.page)


def plate(
    shapes: object,
    methods: str | Callable[..., Any] | Sequence[str | Callable[..., Any]] = "exaggerated",
    *,
    lights: LightsLike | None = None,
    views: str | View | Sequence[str | View] = VIEWS,
    size: tuple[int, int] | str = "A4",
    dpi: float | None = None,
    scale: str | None = None,
    pixels_per_unit: float | None = None,
    unit: str = "",
    background: str | None = None,
    scale_bar: bool = True,
    caption: str = "",
    names: Sequence[str] | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    progress: Progress | None = None,
    **chosen: Any,
) -> Plate:
    """Draw views × lights × methods of shapes on one page, as drawings of finds arrange them.

    The main view stands in the middle, its turns by 90° beside, above and below it, each on the
    side that it shows; all at one scale, and in line with each other. Lights are those of each
    view: northwest is the upper left of every picture.

    Parameters
    ----------
    shapes : path, Mesh, HeightField, Volume, or a list of these
    methods : str, function, or a sequence of them
        As for `bake`.
    lights : light or sequence of lights, optional
        As for `bake`; each has pictures of its own.
    views : sequence
        The main view (a name, "auto" or a `View`), then its turns: "right", "back", "left",
        "above", "below"; or the same as a text with commas.
    size, dpi, background, scale_bar, unit, caption
        Of the page; see `drawing.figure.Figure`. The caption stands at the foot; "auto" says which
        shapes and views they are.
    scale : str, optional
        On paper, "1:2" or "2:1", where the unit of the coordinates is known; or `pixels_per_unit`.
        Unless given, as large as the page has room for.
    names : sequence of str, optional
        What captions call the shapes where there are several; as their files unless given.
    options : {method: {option: value}}, optional
        Options of the methods.
    progress : callable, optional
        ``progress(done, total)`` in views.
    **chosen
        Up, scales, width and so on, as `Look` has them, for all.

    Raises
    ------
    MeshdepictError
        As `bake`; for turns that don't exist, several units, and what the page has no room for.
    """
    figure = Figure(
        size=size, dpi=dpi, background=background, scale_bar=scale_bar, unit=unit,
        pixels_per_unit=pixels_per_unit, caption=caption,
    )  # fmt: skip
    pixels = figure.pixels
    if pixels is None:
        raise MeshdepictError("a plate's page needs a size, such as A4 or 210x297mm")
    for one in ("method", "light", "view"):
        if one in chosen:
            raise MeshdepictError(f"a plate has {one}s, one or more: say {one}s= and not {one}=")
    main, turns = main_and_turns(views)
    lamps: list[Any] = list(lights) if is_several(lights) else [lights]
    if not lamps:
        raise MeshdepictError("a plate needs a light: northwest, or another name")
    own = {} if options is None else checked_options(options)
    looks = plate_looks(methods, lamps, own, {**chosen, "view": main})
    given = list(shapes) if isinstance(shapes, (list, tuple)) else [shapes]
    if not given:
        raise MeshdepictError("a plate needs a shape: give a path, a Mesh or a Volume")
    figure = figure.on(
        "paper" if any(look.declared.ground == "paper" for look in looks) else "white"
    )
    called = [shape_name(shape, i) for i, shape in enumerate(given)]
    if names is not None:
        if not isinstance(names, (list, tuple)) or not all(isinstance(n, str) for n in names):
            raise MeshdepictError(f"names={names!r} is no list of texts")
        called = list(names)
    if len(called) != len(given):
        raise MeshdepictError(f"there are {len(given)} shapes and {len(called)} names for them")
    read, poses = [], []
    for shape, name in zip(given, called, strict=True):
        with notes_about(name if len(given) > 1 else ""):
            read.append(turnable_shape(shape, looks[0]))
            poses.append(looks[0].posed(read[-1]))
    if figure.caption == "auto":
        seen = poses[0].view
        sides = ", ".join((seen if isinstance(seen, str) else "own view", *turns))
        figure = replace(figure, caption=f"{', '.join(called)}: {sides}")
    groups = [
        Group(shape, look, eye, arranged(eye, shape, turns), name if len(read) > 1 else "")
        for shape, name, pose in zip(read, called, poses, strict=True)
        for look in [look.replace(up=pose.up, view=pose.view) for look in looks]
        for eye in [look.of_kind(shape.kind).eye(shape)]
    ]
    unit = figure.unit or common_unit(read)
    layout = _planned(groups, figure, _columns(len(read), looks, len(lamps)), unit, scale)
    pictures, facts = draw_groups(groups, layout.spots, figure.ground, progress)
    page = Page(pixels, figure.ground, (*pictures, *layout.parts), figure.dpi)
    paper = paper_scale(figure, unit)
    ratio = paper.text(layout.pixels_per_unit) if paper else ""
    facts["plate"] = ", ".join(
        filter(None, (f"{layout.pixels_per_unit:.6g} pixels per {unit or 'unit'}", ratio))
    )
    return Plate(page, facts, layout.pixels_per_unit, ratio)


def _columns(shapes: int, looks: Sequence[Look], lights: int) -> Sequence[int]:
    """Return into how many columns groups may go: lights beside each other, methods below them."""
    count = len(looks)
    if 1 < lights < count and all(look.declared.lights != "none" for look in looks):
        return [lights]
    if shapes > 1 and count > 1:
        return [count]
    return range(1, shapes * count + 1)


def _planned(
    groups: Sequence[Group],
    figure: Figure,
    columns: Sequence[int],
    unit: str,
    scale: str | None,
) -> Plan:
    """Return where everything goes, at a scale on paper if one is wanted."""
    paper = paper_scale(figure, unit)
    wanted = figure.pixels_per_unit
    if scale is not None:
        if wanted is not None:
            raise MeshdepictError("scale and pixels_per_unit say the same: give one of them")
        wanted = pixels_at(scale, figure, unit)
    place = partial(
        plan, [group.arrangement for group in groups], [group.caption for group in groups], figure,
        columns=columns, unit=unit,
    )  # fmt: skip
    try:
        found = place(pixels_per_unit=wanted)
    except NoRoomError as error:
        asked, fits = f"{wanted:g} pixels per unit", f"{error.largest:.3g} fit"
        if scale is not None and paper is not None:
            asked, fits = scale, f"{paper.fitting(error.largest)} fits"
        raise MeshdepictError(
            f"at {asked} the page has no room for all views: {fits}, or take fewer views or a "
            "larger size"
        ) from None
    if wanted is None and paper is not None:  # one that can be said in two digits
        return place(pixels_per_unit=paper.rounded(found.pixels_per_unit))
    return found
