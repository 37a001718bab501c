"""What a plate is asked for: views, looks, shapes, each checked before any work."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from meshdepict.baking.choice_list import MESH
from meshdepict.baking.look import Look
from meshdepict.baking.surfaces import as_solid, with_choices
from meshdepict.baking.volumes import as_volume, is_volume
from meshdepict.drawing.arrangement import turn_names
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shading.method import declaration
from meshdepict.shading.registry import find_method
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.volume import Volume

__all__ = [
    "checked_options", "common_unit", "main_and_turns", "notes_about", "plate_looks",
    "shape_name", "turnable_shape",
]  # fmt: skip

_ANY_EYE = View((0, 0, 1), (0, 0, 0), (0, 1, 0), parallel_scale=1)


def main_and_turns(views: str | View | Sequence[str | View]) -> tuple[str | View, list[str]]:
    """Return the main view and its turns."""
    if isinstance(views, str):
        words: list[Any] = [word.strip() for word in views.split(",") if word.strip()]
    else:
        words = [views] if isinstance(views, View) else []
        if isinstance(views, (list, tuple)):
            words = list(views)
    if not words:
        raise MeshdepictError("a plate needs a view: front, or another name, and turns of it")
    return words[0], turn_names(words[1:])


def plate_looks(
    methods: str | Callable[..., Any] | Sequence[str | Callable[..., Any]],
    lights: Sequence[Any],
    options: Mapping[str, Mapping[str, Any]],
    chosen: Mapping[str, Any],
) -> list[Look]:
    """Return the looks, light by light of each method that has any."""
    several = isinstance(methods, (list, tuple))
    wanted: list[Any] = list(methods) if several else [methods]  # type: ignore[arg-type]
    if not wanted:
        raise MeshdepictError("a plate needs a method: exaggerated, or another name")
    if chosen.get("refine") is not None:
        raise MeshdepictError("refine makes other meshes: leave it out of a plate")
    if chosen.get("budget") is not None:
        raise MeshdepictError("budget is for bakes, and a plate has many: choose an accuracy")
    looks = []
    for method in wanted:
        function = find_method(method)
        own = options.get(function.__name__, {})
        lit = declaration(function).lights != "none"  # else all lights are one
        looks += [
            Look(function, **chosen, **own, light=light) for light in lights[: None if lit else 1]
        ]
    for look in looks:
        look.lighting(_ANY_EYE, MESH)  # refuses too many, before shapes are read
    known = {look.method for look in looks}
    for name in options:
        if name not in known:
            raise MeshdepictError(f"options are given for {name}, which the plate doesn't show")
    return looks


def checked_options(options: object) -> Mapping[str, Mapping[str, Any]]:
    """Return options by method, checked as far as their form goes."""
    if not isinstance(options, Mapping) or not all(
        isinstance(own, Mapping) for own in options.values()
    ):
        raise MeshdepictError(f"options={options!r} are not {{method: {{option: value}}}}")
    return options


def turnable_shape(shape: object, look: Look) -> Mesh | HeightField | Volume:
    """Return a shape that can be turned, with the sides or the heights that a look chose."""
    if isinstance(shape, (ScaleSpace, GBuffer)):
        raise MeshdepictError(
            f"a {type(shape).__name__} can't be turned: give a path, a Mesh or a Volume"
        )
    solid = as_volume(shape) if is_volume(shape) else as_solid(shape)
    look.of_kind(solid.kind)  # refuses what is about other kinds
    return solid if isinstance(solid, Volume) else with_choices(solid, look)


def shape_name(shape: object, place: int) -> str:
    """Return what captions call a shape: as its file, else by its number."""
    if isinstance(shape, (str, os.PathLike)):
        return Path(shape).name.partition(".")[0]
    return str(place + 1)


@contextmanager
def notes_about(name: str) -> Iterator[None]:
    """Put a shape's name in front of what is said about it; none where there is one shape."""
    if not name:
        yield
        return
    heard: list[warnings.WarningMessage] = []
    try:
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            yield
    finally:
        for note in heard:
            ours = issubclass(note.category, MeshdepictWarning)
            text = f"{name}: {note.message}" if ours else str(note.message)
            warnings.warn(text, note.category, stacklevel=3)


def common_unit(shapes: Sequence[Mesh | HeightField | Volume]) -> str:
    """Return the unit of all shapes' coordinates; of those that don't say, what the others say."""
    units = dict.fromkeys(shape.length_unit for shape in shapes if shape.length_unit)
    if len(units) > 1:
        raise MeshdepictError(
            f"the shapes are measured in {' and '.join(units)}, and a plate has one scale: bring "
            "them to one unit"
        )
    return next(iter(units), "")
